// The simulator in WebAssembly (crates/iva-wasm), with the tables of a run as arrays of numbers.

/**
 * A scene is `{choices: {kind: "siva", …}, values: {"absorber.clearance": 0.5, …}, fixed: {…}}`: the words and numbers of a study
 * file by their paths, in the user's units. In a list of absorbers a choice has its number, `"1.kind"`. What is fixed is a
 * `structure` with several modes by its entries, `starts` with a number for each unit, `tables` of the restitution and `records` by the numbers of their absorbers and
 * forces.
 */
export class Engine {
  /** Loads the simulator from the bytes of its module. */
  static async load(module) {
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
  static lines({ choices = {}, values = {}, fixed = {} }) {
    // The kind of an absorber comes before its other choices.
    const named = Object.entries(choices).map(([name, word]) => [parseInt(name, 10) || 0, name.replace(/^\d+\./, ""), word]);
    named.sort(([a, name], [b, other]) => a - b || (other === "kind") - (name === "kind"));
    const lines = named.map(([, name, word]) => `choose ${name} ${word}`);
    for (const [name, entry] of Object.entries(fixed.structure ?? {})) lines.push(...Engine.entry(name, entry));
    for (let force = 0; force < Engine.forces({ values, fixed }); force += 1) {
      const { kind, times, values: strengths } = fixed.records?.[force] ?? {};
      lines.push(kind ? `record ${kind} ${times.map((time, index) => `${time} ${strengths[index]}`).join(" ")}` : "force");
    }
    for (const [absorber, points] of Object.entries(fixed.tables ?? {})) lines.push(`table ${absorber} ${points.flat().join(" ")}`);
    lines.push(...Object.entries(values).map(([path, value]) => `set ${path} ${value}`));
    lines.push(...Object.entries(fixed.starts ?? {}).map(([name, numbers]) => `starts ${name} ${numbers.join(" ")}`));
    return lines.join("\n");
  }

  /** Number of forces of a scene. */
  static forces({ values, fixed = {} }) {
    const numbers = Object.keys(values).map((path) => /^force\.(?:(\d+)\.)?/.exec(path)).filter(Boolean);
    return 1 + Math.max(-1, ...numbers.map(([, number]) => Number(number ?? 0)), ...Object.keys(fixed.records ?? {}).map(Number));
  }

  /** The lines of an entry of a structure. */
  static entry(name, value) {
    const line = (form, ...words) => ["entry", name, form, ...words].join(" ");
    if (typeof value === "string") return [line("name", encodeURIComponent(value))];
    if (typeof value === "number") return [line("mode", value)];
    if (!Array.isArray(value)) return Object.entries(value).map(([point, shape]) => line("named", encodeURIComponent(point), ...shape));
    if (Array.isArray(value[0])) return value.map((row) => line("row", ...row));
    if (typeof value[0] === "string") return [line("names", ...value.map(encodeURIComponent))];
    return [line("numbers", ...value)];
  }

  /**
   * Takes a scene: `{error, units, natural, absorbers}`, where an error has field, value, what is allowed, and the sentence of
   * all; `natural` is the natural frequency, and an absorber has its number in the list, its point, and the walls of its gap.
   */
  set(scene) {
    this.text = Engine.lines(scene);
    this.give(this.text);
    return { error: null, ...this.call("iva_check") };
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
