// A map of one measure over two parameters, coarse first, with the scene as a point on it.

import { clamp, make, rounded, shown, unitText, withUnit } from "./format.js";
import { measureWords } from "./measures.js";
import { View, ticks } from "./plot.js";
import { rangeOf, toBase, wordsOf } from "./slots.js";
import { limited } from "./state.js";
import { Background } from "./worker.js";

const COLUMNS = 120;
const ROWS = 80;
const STRIDES = [8, 4, 2, 1];
const BAR = 96;
const EVERY_MS = 100;
/** Viridis at nine places (CC0, Smith and van der Walt). */
const VIRIDIS = [
  [68, 1, 84], [71, 44, 122], [59, 81, 139], [44, 113, 142], [33, 144, 141], [39, 173, 129], [92, 200, 99],
  [170, 220, 50], [253, 231, 37],
];

function shade(share) {
  const at = clamp(share, 0, 1) * (VIRIDIS.length - 1);
  const index = Math.min(VIRIDIS.length - 2, Math.floor(at));
  return VIRIDIS[index].map((low, channel) => low + (at - index) * (VIRIDIS[index + 1][channel] - low));
}

/** Nodes of an axis, by equal steps or equal factors. */
function nodes([low, high, byFactors], count) {
  return Float64Array.from({ length: count }, (_, index) => {
    const share = index / (count - 1);
    return byFactors ? low * (high / low) ** share : low + share * (high - low);
  });
}

function shareOf([low, high, byFactors], value) {
  return byFactors ? Math.log(value / low) / Math.log(high / low) : (value - low) / (high - low);
}

function valueAt([low, high, byFactors], share) {
  return byFactors ? low * (high / low) ** share : low + share * (high - low);
}

/** The value below which 95 % of the finite ones are: a few runs that settle late must not decide the colours. */
function limits(values) {
  const finite = values.filter(Number.isFinite).sort((a, b) => a - b);
  if (!finite.length) return null;
  const at = (share) => finite[Math.min(finite.length - 1, Math.floor(share * finite.length))];
  return { low: at(0.01), high: at(0.95) };
}

export class ScanMap {
  constructor(state, options, engine) {
    this.state = state;
    this.engine = engine;
    this.worker = new Background(options, engine);
    // What was chosen; where a scene does not have it, another stands in until it has.
    this.wished = { x: "absorber.clearance", y: "absorber.mass" };
    this.slots = { ...this.wished };
    this.measure = "settling_time_5";
    this.values = new Float64Array(COLUMNS * ROWS).fill(NaN);
    this.known = new Uint8Array(COLUMNS * ROWS);
    /** Where a value is that of its own node, not of a coarser one beside it. */
    this.exact = new Uint8Array(COLUMNS * ROWS);
    this.image = make("canvas", { width: COLUMNS, height: ROWS });
    const pick = (axis, label) => make("select", {
      "aria-label": label, onchange: (event) => { this.wished[axis] = event.target.value; this.restart(); },
    });
    this.picks = { x: pick("x", "Map, across"), y: pick("y", "Map, up") };
    this.pickMeasure = make("select", {
      "aria-label": "Map, measure", onchange: () => { this.measure = this.pickMeasure.value; this.restart(); },
    });
    this.point = make("div", { class: "handle point", role: "slider", "aria-label": "Scene on the map: drag, or arrow keys" });
    this.point.tabIndex = 0;
    this.told = make("span", { class: "told", role: "status" });
    this.view = new View({
      name: "map",
      title: "Map",
      tools: [this.pickMeasure, make("span", {}, " over "), this.picks.x, make("span", {}, " and "), this.picks.y],
      draw: (plot) => this.paint(plot),
      columns: () => this.columns(),
      describe: () => `Map of ${measureWords(this.measure)} over ${this.words("x")} and ${this.words("y")}`,
    });
    this.view.pad.append(this.point);
    this.view.legend.textContent = "drag the point";
    this.view.element.append(this.told);
    this.listen();
  }

  words(axis) {
    return this.label(this.slots[axis]).toLowerCase();
  }

  /** What a slot is called, in a list with the number of its absorber. */
  label(key) {
    const field = this.state.form(key);
    return wordsOf(field)[0] + (field.number === undefined ? "" : `, ${field.part === "force" ? "force" : "absorber"} ${field.number}`);
  }

  listen() {
    const { pad } = this.view;
    const set = (event) => {
      const box = pad.getBoundingClientRect();
      const { plot } = this.view;
      if (!plot?.box || !this.ranges) return;
      const across = clamp((event.clientX - box.left - plot.box.left) / (plot.box.right - plot.box.left), 0, 1);
      const up = clamp((plot.box.bottom - event.clientY + box.top) / (plot.box.bottom - plot.box.top), 0, 1);
      this.moveTo(valueAt(this.ranges.x, across), valueAt(this.ranges.y, up));
    };
    pad.addEventListener("pointerdown", (event) => {
      if (event.button !== 0) return;
      pad.setPointerCapture(event.pointerId);
      this.point.focus({ preventScroll: true });
      set(event);
    });
    pad.addEventListener("pointermove", (event) => { if (pad.hasPointerCapture(event.pointerId)) set(event); });
    this.point.addEventListener("keydown", (event) => {
      const [dx, dy] = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key] ?? [0, 0];
      if (!dx && !dy) return;
      event.preventDefault();
      const at = (axis, step, count) => {
        const share = shareOf(this.ranges[axis], this.here(axis)) + step / count;
        return step ? valueAt(this.ranges[axis], clamp(share, 0, 1)) : this.here(axis);
      };
      this.moveTo(at("x", dx, COLUMNS - 1), at("y", dy, ROWS - 1));
    });
  }

  moveTo(x, y) {
    const { state, paths } = this;
    state.edit({ ...state.inSlot(paths.x, rounded(x, 3)), ...state.inSlot(paths.y, rounded(y, 3)) }, "map");
  }

  here(axis) {
    const field = this.state.fields.get(this.paths[axis]);
    return this.state.values[field.path] ?? field.default ?? NaN;
  }

  /** Parameters that can be an axis, and those that are. */
  choose() {
    const { state } = this;
    const offered = JSON.stringify([state.choices, state.units, Object.keys(state.values), this.wished, this.measure]);
    if (offered === this.offered) return;
    this.offered = offered;
    const slots = state.slots.filter((slot) => {
      const field = state.form(slot.key);
      return field && (state.values[field.path] !== undefined || field.default !== null)
        && !(state.fixed.structure && field.part === "primary")
        && !["run.max_impacts", "run.max_work", "run.tolerance", "run.discard", "start.time"].includes(slot.key)
        && !(slot.part === "force" && state.values[field.path] === undefined);
    });
    const keys = slots.map((slot) => slot.key);
    const fallback = [
      "absorber.clearance", "absorber.mass", "absorber.0.clearance", "absorber.0.mass", "primary.damping", "start.displacement", "start.velocity",
    ];
    const either = (wanted, other) => (keys.includes(wanted) && wanted !== other ? wanted
      : fallback.find((key) => keys.includes(key) && key !== other));
    this.slots.x = either(this.wished.x, null);
    this.slots.y = either(this.wished.y, this.slots.x);
    for (const axis of ["x", "y"]) {
      options(this.picks[axis], slots.map((slot) => [slot.key, this.label(slot.key)]), this.slots[axis]);
    }
    const summary = this.data.run.summary;
    const measures = this.engine.measures.filter(({ name }) => typeof summary[name] !== "string"
      && (this.data.forced ? !/settling|damping_ratio|residual_amplitude/.test(name)
        : !/^(amplitude_|reduction|transmissib|impacts_per_cycle)/.test(name)));
    if (!measures.some(({ name }) => name === this.measure)) {
      this.measure = this.data.forced ? "amplitude_max" : "settling_time_5";
    }
    options(this.pickMeasure, measures.map(({ name }) => [name, measureWords(name)]), this.measure);
    this.paths = { x: state.form(this.slots.x).path, y: state.form(this.slots.y).path };
  }

  /** Takes a scene; the map is made anew if more of it has changed than where the point is. */
  scene(data, colours) {
    this.data = data;
    this.colours = colours;
    this.choose();
    const values = { ...data.scene.values };
    for (const axis of ["x", "y"]) delete values[this.paths[axis]];
    const key = JSON.stringify([values, data.scene.choices, data.scene.fixed, this.paths, this.measure]);
    if (key === this.key) return;
    this.key = key;
    this.known.fill(0);
    this.exact.fill(0);
    this.changed = true;
    const anchored = JSON.stringify([this.paths, data.units, data.kind, data.setting.reference]);
    const outside = ["x", "y"].some((axis) => this.ranges && this.here(axis) > this.ranges[axis][1]);
    if (this.anchored !== anchored || outside) {
      this.anchored = anchored;
      this.ranges = { x: this.rangeOf("x"), y: this.rangeOf("y") };
    }
    clearTimeout(this.timer);
    this.worker.cancel();
    this.timer = setTimeout(() => this.begin(), 120);
  }

  /** A range with the scene in it. */
  rangeOf(axis) {
    const [low, high, byFactors] = this.usualRange(axis);
    return [low, Math.max(high, rounded(1.2 * (this.here(axis) || 0), 2)), byFactors];
  }

  usualRange(axis) {
    const field = this.state.fields.get(this.paths[axis]);
    const [low, high, byFactors] = rangeOf(field, this.here(axis) || undefined);
    const positive = field.allowed.includes("greater than 0");
    // Equal steps show more of a gap than equal factors do.
    if (field.group === "clearance") {
      const { setting } = this.state;
      const one = setting.reference / toBase(field.path, 1, setting);
      return Number.isFinite(one) && one > 0 ? [rounded(0.05 * one, 2), rounded(1.6 * one, 2), false] : [low, high, true];
    }
    if (field.path === "absorber.mass_ratio") return [0.02, 0.3, false];
    return positive && low <= 0 ? [high / 200, high, false] : [low, high, byFactors];
  }

  restart() {
    this.key = "";
    this.scene(this.data, this.colours);
    this.draw(this.data, this.colours);
  }

  begin() {
    this.waits = !this.view.visible;
    if (this.waits) return;
    const xs = nodes(this.ranges.x, COLUMNS);
    const ys = nodes(this.ranges.y, ROWS);
    const jobs = [];
    this.known.fill(0);
    this.changed = true;
    STRIDES.forEach((stride, level) => {
      for (let row = 0; row < ROWS; row += stride) {
        const first = level === 0 || row % (2 * stride) !== 0 ? 0 : stride;
        const step = first ? 2 * stride : stride;
        const columns = [];
        for (let column = first; column < COLUMNS; column += step) columns.push(column);
        jobs.push({ row, columns, stride });
      }
    });
    const rows = jobs.map(({ row, columns }) => ({
      xPath: this.paths.x, xs: Float64Array.from(columns, (column) => xs[column]), yPath: this.paths.y, ys: Float64Array.of(ys[row]),
    }));
    this.told.textContent = "computing";
    this.worker.start({
      scene: limited(this.data.scene), rows, measure: this.measure,
      onRow: (index, values) => {
        const { row, columns, stride } = jobs[index];
        this.changed = true;
        columns.forEach((column, at) => this.fill(row, column, stride, values[at]));
        this.drawLater();
      },
      onEnd: (fault) => { this.told.textContent = fault ?? ""; this.draw(this.data, this.colours); },
    });
  }

  /** While it fills, the map is painted some times a second: painting takes from what computes. */
  drawLater() {
    if (this.asked) return;
    this.asked = true;
    setTimeout(() => requestAnimationFrame(() => {
      this.asked = false;
      this.painted = performance.now();
      this.draw(this.data, this.colours);
    }), clamp(EVERY_MS - (performance.now() - (this.painted ?? 0)), 0, EVERY_MS));
  }

  /** A node fills what no finer one has filled: the block around it of the size of its stride. */
  fill(row, column, stride, value) {
    for (let y = row; y < Math.min(ROWS, row + stride); y += 1) {
      for (let x = column; x < Math.min(COLUMNS, column + stride); x += 1) {
        this.values[y * COLUMNS + x] = value;
        this.known[y * COLUMNS + x] = 1;
      }
    }
    this.exact[row * COLUMNS + column] = 1;
  }

  /** Paints the map if anything of it has changed but the place of the point. */
  draw(data, colours) {
    this.colours = colours;
    if (this.waits && this.view.visible) this.begin();
    const shown = JSON.stringify([this.key, data.units, this.ranges]);
    const { plot } = this.view;
    if (!this.changed && plot?.box && plot.colours === colours && this.shown === shown) this.placePoint(plot);
    else this.view.show(data, colours);
    this.shown = shown;
  }

  paint(plot) {
    const { colours, context: c } = plot;
    if (!this.ranges) return;
    const label = (axis) => {
      const field = this.state.fields.get(this.paths[axis]);
      const [words, symbol] = wordsOf(field);
      const unit = unitText(field.units[this.data.units]);
      if (field.number !== undefined) return `${this.label(this.slots[axis])}${unit ? ` (${unit})` : ""}`;
      return `${words} ${symbol}${unit ? ` (${unit})` : ""}`;
    };
    // An axis by factors is drawn over the logarithm.
    const log = { x: this.ranges.x[2], y: this.ranges.y[2] };
    const ends = (axis) => [0, 1].map((end) => (log[axis] ? Math.log10(this.ranges[axis][end]) : this.ranges[axis][end]));
    plot.axes({ x: ends("x"), y: ends("y"), xLabel: label("x"), yLabel: label("y"), right: BAR, zero: false, log });
    const better = this.engine.measures.find(({ name }) => name === this.measure)?.better;
    const { box } = plot;
    this.stripes(c, box, colours);
    if (this.changed) this.colour(better);
    c.imageSmoothingEnabled = false;
    c.drawImage(this.image, box.left, box.top, box.right - box.left, box.bottom - box.top);
    if (this.limits) this.bar(plot, this.limits, better);
    else if (this.known.every(Boolean)) plot.text("no value at any point", box.left + 8, box.top + 12, colours.text);
    this.placePoint(plot);
  }

  /** Gives every cell its colour; done once for the rows that have come since. */
  colour(better) {
    this.changed = false;
    const range = limits(Array.from(this.values).filter((_, index) => this.known[index]));
    this.limits = range;
    const pixels = new ImageData(COLUMNS, ROWS);
    for (let row = 0; range && row < ROWS; row += 1) {
      for (let column = 0; column < COLUMNS; column += 1) {
        const value = this.values[row * COLUMNS + column];
        if (!this.known[row * COLUMNS + column] || !Number.isFinite(value)) continue;
        const share = range.high > range.low ? (value - range.low) / (range.high - range.low) : 0.5;
        const [red, green, blue] = shade(better === "larger" ? 1 - share : share);
        pixels.data.set([red, green, blue, 255], 4 * ((ROWS - 1 - row) * COLUMNS + column));
      }
    }
    this.image.getContext("2d").putImageData(pixels, 0, 0);
  }

  /** What is under cells without a value. */
  stripes(c, box, colours) {
    c.save();
    c.beginPath();
    c.rect(box.left, box.top, box.right - box.left, box.bottom - box.top);
    c.clip();
    c.strokeStyle = colours.line;
    c.lineWidth = 1;
    c.beginPath();
    for (let at = box.left - (box.bottom - box.top); at < box.right; at += 7) {
      c.moveTo(at, box.bottom);
      c.lineTo(at + (box.bottom - box.top), box.top);
    }
    c.stroke();
    c.restore();
  }

  bar(plot, { low, high }, better) {
    const { context: c, colours, box } = plot;
    const left = box.right + 10;
    const bottom = box.bottom - 42;
    for (let y = box.top; y < bottom; y += 1) {
      const share = (bottom - y) / (bottom - box.top);
      c.fillStyle = `rgb(${shade(better === "larger" ? 1 - share : share).map(Math.round).join()})`;
      c.fillRect(left, y, 12, 1.5);
    }
    for (const tick of ticks(low, high, 4)) {
      plot.text(shown(tick, 3), left + 16, bottom - ((tick - low) / (high - low || 1)) * (bottom - box.top), colours.quiet);
    }
    const measure = this.engine.measures.find(({ name }) => name === this.measure);
    const unit = unitText(measure?.units[this.data.units]);
    plot.text(unit, left + 16, bottom + 8, colours.quiet);
    if (better) plot.text("dark: better", left - 4, bottom + 20, colours.quiet);
    plot.text("striped: no value", left - 4, bottom + 33, colours.quiet);
  }

  placePoint(plot) {
    const { box } = plot;
    const share = { x: shareOf(this.ranges.x, this.here("x")), y: shareOf(this.ranges.y, this.here("y")) };
    const { style } = this.point;
    style.left = `${box.left + clamp(share.x, 0, 1) * (box.right - box.left)}px`;
    style.top = `${box.bottom - clamp(share.y, 0, 1) * (box.bottom - box.top)}px`;
    const unit = (axis) => unitText(this.state.fields.get(this.paths[axis]).units[this.data.units]);
    this.point.setAttribute("aria-valuenow", String(this.here("x")));
    this.point.setAttribute("aria-valuetext",
      `${this.words("x")} ${withUnit(this.here("x"), unit("x"))}, ${this.words("y")} ${withUnit(this.here("y"), unit("y"))}`);
  }

  columns() {
    const xs = nodes(this.ranges.x, COLUMNS);
    const ys = nodes(this.ranges.y, ROWS);
    return {
      [this.paths.x]: Array.from(this.values, (_, index) => xs[index % COLUMNS]),
      [this.paths.y]: Array.from(this.values, (_, index) => ys[Math.floor(index / COLUMNS)]),
      [this.measure]: this.values.map((value, index) => (this.exact[index] ? value : NaN)),
    };
  }
}

function options(select, list, value) {
  const key = JSON.stringify(list);
  if (select.dataset.list !== key) {
    select.dataset.list = key;
    select.replaceChildren(...list.map(([name, label]) => make("option", { value: name }, label)));
  }
  select.value = value;
}
