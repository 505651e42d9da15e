// The simulator in WebAssembly (crates/iva-wasm), with the tables of a run as arrays of numbers.

/**
 * A scene is `{choices: {kind: "siva", …}, values: {"absorber.clearance": 0.5, …}}`: the words and numbers of a study file by
 * their paths, in the user's units.
 */
export class Engine {
  /** Loads the simulator from the bytes of its module, compressed by gzip. */
  static async load(bytes) {
    const plain = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
    const module = new Uint8Array(await new Response(plain).arrayBuffer());
    return (await Engine.fast(module)) ?? new Engine(await WebAssembly.compile(module));
  }

  /** The simulator with the browser's own a·b + c, if it has one that rounds once: the same bits in half the time. */
  static async fast(module) {
    try {
      const engine = new Engine(await WebAssembly.compile(Engine.withInstruction(module)), true);
      return engine.exports.iva_rounds_once() ? engine : null;
    } catch {
      return null;
    }
  }

  /**
   * A copy of a module in which the body of its function `fma` is extract_lane 0 (relaxed_madd (splat a) (splat b) (splat c)),
   * filled up with instructions that do nothing.
   */
  static withInstruction(module) {
    const bytes = module.slice();
    let at = 8;
    // Numbers in groups of seven bits, the lowest first.
    const number = () => {
      let value = 0;
      for (let shift = 0; ; shift += 7) {
        const byte = bytes[at];
        at += 1;
        value += (byte & 127) * 2 ** shift;
        if (byte < 128) return value;
      }
    };
    let index = -1;
    while (at < bytes.length) {
      const section = bytes[at];
      at += 1;
      const length = number();
      const end = at + length;
      // The module imports nothing, so functions are counted from its own first one.
      if (section === 2) throw new Error("imports");
      if (section === 7) {
        for (let left = number(); left > 0; left -= 1) {
          const size = number();
          const name = String.fromCharCode(...bytes.subarray(at, at + size));
          at += size + 1;
          const of = number();
          if (name === "fma") index = of;
        }
      } else if (section === 10) {
        number();
        for (let left = index; left >= 0; left -= 1) {
          const size = number();
          if (left === 0) {
            const body = [0, 0x20, 0, 0xfd, 0x14, 0x20, 1, 0xfd, 0x14, 0x20, 2, 0xfd, 0x14, 0xfd, 0x87, 2, 0xfd, 0x21, 0];
            if (size <= body.length) throw new Error("no room");
            bytes.fill(1, at, at + size - 1);
            bytes.set(body, at);
            bytes[at + size - 1] = 0x0b;
          }
          at += size;
        }
      }
      at = end;
    }
    return bytes;
  }

  constructor(module, fast = false) {
    this.module = module;
    this.exports = new WebAssembly.Instance(module, {}).exports;
    /** True if a·b + c is an instruction of the machine. */
    this.fast = fast;
    this.text = "";
    /** `version`, `fields`, `choices` and `measures`, with units and help. */
    this.description = this.call("iva_describe");
    this.fields = this.description.fields;
    this.measures = this.description.measures;
  }

  /** Calls the simulator; one that has stopped (no memory was left) is replaced by a new one. */
  call(name, ...given) {
    try {
      this.exports[name](...given);
      return this.answer();
    } catch (fault) {
      this.exports = new WebAssembly.Instance(this.module, {}).exports;
      const sentence = "this scene is too large for a page; the package may run it";
      return { error: { field: "run", value: "", allowed: String(fault), sentence } };
    }
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
    const { error = null, units = null } = this.call("iva_check");
    return { error, units };
  }

  /**
   * Runs the scene: its tables by name; `summary` has one value for each measure. An error as in {@link set}. With `errors`
   * the summary has the correct digits of impact times, too, which take longer than the run.
   */
  run(samplesPerPeriod = 60, errors = false) {
    this.give(this.text);
    const answer = this.call("iva_run", samplesPerPeriod, Number(errors));
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
    const answer = this.call("iva_map");
    if (answer.error) throw new Error(answer.error.sentence);
    return this.numbers(answer.map);
  }

  /** The same for one value of the second field; where the scene cannot be run there is NaN. */
  row(xPath, xValues, yPath, yValue, measure) {
    try {
      return this.map(xPath, xValues, yPath, [yValue], measure);
    } catch {
      if (xValues.length === 1) return Float64Array.of(NaN);
      return Float64Array.from(xValues, (x) => this.row(xPath, [x], yPath, yValue, measure)[0]);
    }
  }
}

/** The source of the class, from which a worker makes its own. */
Engine.source = Engine.toString();
