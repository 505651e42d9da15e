// The simulator in WebAssembly (crates/iva-wasm), with the tables of a run as arrays of numbers.

/**
 * A scene is `{choices: {kind: "siva", …}, values: {"absorber.clearance": 0.5, …}}`: the words and numbers of a study file by
 * their paths, in the user's units.
 */
export class Engine {
  /** Loads the simulator from the bytes of its module, compressed by gzip. */
  static async load(bytes) {
    const plain = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
    const machine = { fma: await Engine.fma() };
    const { instance } = await WebAssembly.instantiate(await new Response(plain).arrayBuffer(), { machine });
    return new Engine(instance.exports);
  }

  /**
   * The browser's own a·b + c, in a module of one function: extract_lane(relaxed_madd(splat a, splat b, splat c)). The
   * simulator uses it if it rounds once; a browser that has none gives what is never right.
   */
  static async fma() {
    const module = "0061736d0100000001080160037c7c7c017c0302010007070103666d6100000a16011400"
      + "2000fd142001fd142002fd14fd8702fd21000b";
    try {
      const { instance } = await WebAssembly.instantiate(Uint8Array.from(module.match(/../g), (byte) => parseInt(byte, 16)));
      return instance.exports.fma;
    } catch {
      return () => NaN;
    }
  }

  constructor(exports) {
    this.exports = exports;
    this.text = "";
    /** True if products and sums are rounded by the machine: the same bits in less time. */
    this.byMachine = this.exports.iva_use_machine() === 1;
    this.exports.iva_describe();
    /** `version`, `fields`, `choices` and `measures`, with units and help. */
    this.description = this.answer();
    this.fields = this.description.fields;
    this.measures = this.description.measures;
  }

  /** Hands a text to the simulator. */
  give(text) {
    const bytes = new TextEncoder().encode(text);
    const place = this.exports.iva_given(bytes.length);
    new Uint8Array(this.exports.memory.buffer, place, bytes.length).set(bytes);
  }

  /** Reads its last answer. */
  answer() {
    const [place, length] = [this.exports.iva_answer(), this.exports.iva_answer_length()];
    const bytes = new Uint8Array(this.exports.memory.buffer, place, length);
    return JSON.parse(new TextDecoder().decode(bytes));
  }

  /** The numbers at a place in its memory. */
  numbers([place, length]) {
    // An empty column has a place that is not one.
    return length ? new Float64Array(this.exports.memory.buffer, place, length).slice() : new Float64Array(0);
  }

  /** The columns of a table. */
  table(places) {
    return Object.fromEntries(Object.entries(places).map(([name, place]) => [name, this.numbers(place)]));
  }

  /** The lines that describe a scene. */
  static lines({ choices = {}, values = {} }) {
    const kind = Object.entries(choices).sort(([a], [b]) => (a === "kind" ? -1 : b === "kind" ? 1 : 0));
    return [
      ...kind.map(([name, word]) => `choose ${name} ${word}`),
      ...Object.entries(values).map(([path, value]) => `set ${path} ${value}`),
    ].join("\n");
  }

  /** Takes a scene: `{error, units}`, where an error has field, value, what is allowed, and the sentence of all. */
  set(scene) {
    this.text = Engine.lines(scene);
    this.give(this.text);
    this.exports.iva_check();
    const { error = null, units = null } = this.answer();
    return { error, units };
  }

  /**
   * Runs the scene: its tables by name; `summary` has one value for each measure. An error as in {@link set}. With `errors`
   * the summary has the correct digits of impact times, too, which take longer than the run.
   */
  run(samplesPerPeriod = 60, errors = false) {
    this.give(this.text);
    this.exports.iva_run(samplesPerPeriod, Number(errors));
    const answer = this.answer();
    if (answer.error) return { error: answer.error };
    const { summary, units, ...tables } = answer;
    const columns = Object.entries(tables).map(([name, places]) => [name, this.table(places)]);
    return { error: null, units, summary, ...Object.fromEntries(columns) };
  }

  /** A measure of the scene over the values of two fields, row by row, with NaN where it is not defined. */
  map(xPath, xValues, yPath, yValues, measure) {
    const axes = [[yPath, yValues], [xPath, xValues]];
    const lines = axes.map(([path, values]) => `axis ${path} ${Array.from(values).join(" ")}`);
    this.give([this.text, ...lines, `measure ${measure}`].join("\n"));
    this.exports.iva_map();
    const answer = this.answer();
    if (answer.error) throw new Error(answer.error.sentence);
    return this.numbers(answer.map);
  }
}

/** The bytes that a text in base64 holds. */
export function bytesOf(base64) {
  return Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0));
}

/** The source of the class, from which a worker makes its own. */
Engine.source = Engine.toString();
