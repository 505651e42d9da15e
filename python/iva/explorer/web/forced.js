// Under a harmonic force: the section at its strobes, and the largest |x| over its frequency.

import { make } from "./format.js";
import { extent, View } from "./plot.js";
import { Engine } from "./engine.js";
import { rowsOf } from "./motion.js";
import { lengthIn, limited } from "./state.js";

const POINTS = 101;

/** Ends with some room. */
function room([low, high]) {
  const more = 0.08 * (high - low || Math.abs(high) || 1);
  return [low - more, high + more];
}

export class Forced {
  /** `go(relative frequency)` gives the scene a frequency that was pressed on the response. */
  constructor(state, worker, go) {
    Object.assign(this, { state, go });
    this.worker = worker.another();
    this.xs = Float64Array.from({ length: POINTS }, (_, index) => 0.5 + index / (POINTS - 1));
    this.curves = { now: new Float64Array(POINTS).fill(NaN), alone: new Float64Array(POINTS).fill(NaN) };
    this.section = new View({
      name: "strobes",
      title: "Stroboscopic section",
      draw: (plot, data) => this.drawSection(plot, data),
      columns: ({ run }) => run.stroboscope,
      describe: ({ run }) => `${run.stroboscope.time.length} states of the structure, one a cycle of the force`,
    });
    this.told = make("span", { class: "told", role: "status" });
    this.response = new View({
      name: "response",
      title: "Frequency response",
      draw: (plot, data) => this.drawResponse(plot, data),
      columns: () => ({ relative_frequency: this.xs, amplitude_max: this.curves.now, without_absorber: this.curves.alone }),
      describe: () => "Largest displacement over the frequency of the force, with absorber and without",
    });
    this.response.element.append(this.told);
    this.views = [this.section, this.response];
    this.response.pad.classList.add("scrub");
    const set = (event) => {
      const { left } = this.response.pad.getBoundingClientRect();
      const at = this.response.plot?.xAt?.(event.clientX - left);
      if (at >= this.xs[0] && at <= this.xs[POINTS - 1]) this.go(Number(at.toFixed(3)));
    };
    this.response.pad.addEventListener("pointerdown", (event) => {
      if (event.button !== 0) return;
      this.response.pad.setPointerCapture(event.pointerId);
      set(event);
    });
    this.response.pad.addEventListener("pointermove", (event) => { if (this.response.pad.hasPointerCapture(event.pointerId)) set(event); });
  }

  /** Takes a scene; the response is made anew if more than the frequency has changed. */
  show(data) {
    const on = data.forced && data.run.stroboscope !== undefined && Engine.forces(data.scene) === 1 && !data.scene.fixed.records;
    for (const view of this.views) view.element.hidden = !on;
    if (!on) {
      this.key = "";
      return;
    }
    this.data = data;
    const { values } = data.scene;
    const others = Object.entries(values).filter(
      ([path]) => !["force.frequency", "force.frequency_hz", "force.relative_frequency"].includes(path),
    );
    const key = JSON.stringify([others, data.scene.choices, data.scene.fixed]);
    if (key === this.key) return;
    this.key = key;
    clearTimeout(this.timer);
    this.timer = setTimeout(() => this.begin(), 200);
  }

  /** Every eighth frequency first, the others after it; with absorber, then without. */
  begin() {
    const { state, data } = this;
    // Rows have two axes: the length of the run is one that stays as it is.
    const held = lengthIn(state.values);
    const order = [8, 4, 2, 1].flatMap((stride, level) => [...this.xs.keys()].filter(
      (index) => index % stride === 0 && (level === 0 || index % (2 * stride) !== 0),
    ));
    const rows = order.map((index) => ({
      xPath: "force.relative_frequency", xs: Float64Array.of(this.xs[index]),
      yPath: held, ys: Float64Array.of(state.values[held]),
    }));
    const job = (curve, scene, next) => {
      this.curves[curve].fill(NaN);
      this.worker.start({
        scene: limited(scene), rows, measure: "amplitude_max",
        onRow: (index, [value]) => {
          this.curves[curve][order[index]] = value;
          if (!this.asked) {
            this.asked = true;
            requestAnimationFrame(() => { this.asked = false; this.response.show(this.data, this.colours); });
          }
        },
        onEnd: (fault) => {
          this.told.textContent = fault ?? "";
          this.response.show(this.data, this.colours);
          next?.();
        },
      });
    };
    this.told.textContent = "computing";
    this.curves.alone.fill(NaN);
    const bare = state.sceneOf({ kind: "none" }, state.values);
    job("now", data.scene, data.kind === "none" ? null : () => job("alone", bare, null));
  }

  draw(data, colours) {
    this.colours = colours;
    for (const view of this.views) view.show(data, colours);
  }

  drawSection(plot, { run, drawn, absorbers }) {
    const strobes = rowsOf(run.stroboscope, 0, absorbers.length);
    const [length, speed] = [drawn("Length"), drawn("Velocity")];
    const scaled = (values, factor) => extent(values).map((end) => end * factor);
    plot.axes({
      x: room(scaled(strobes.displacement, length.factor)), y: room(scaled(strobes.velocity, speed.factor)),
      xLabel: `x at Ωt + φ = 2πk (${length.unit})`, yLabel: `ẋ (${speed.unit})`, zero: false,
    });
    for (let index = 0; index < strobes.time.length; index += 1) {
      plot.dot(strobes.displacement[index] * length.factor, strobes.velocity[index] * speed.factor, 2, plot.colours.structure);
    }
  }

  drawResponse(plot, { drawn, setting }) {
    const { factor, unit } = drawn("Length");
    const [, high] = extent(this.curves.now, this.curves.alone.filter((_, index) => index % 8 === 0));
    plot.axes({
      x: [this.xs[0], this.xs[POINTS - 1]], y: [0, 1.05 * high * factor],
      xLabel: "relative frequency Ω/ωₙ", yLabel: `max |x| (${unit})`, zero: false,
    });
    plot.inside((c) => {
      for (const [curve, colour, width] of [["alone", plot.colours.alone, 1], ["now", plot.colours.structure, 1.6]]) {
        // While it fills, known points are joined over those that are not.
        const known = [...this.xs.keys()].filter((index) => !Number.isNaN(this.curves[curve][index]));
        plot.line(known.map((index) => this.xs[index]), known.map((index) => this.curves[curve][index]), colour, width, factor);
      }
      c.strokeStyle = plot.colours.accent;
      c.lineWidth = 1;
      const at = plot.x(setting.force / setting.natural);
      plot.stroke([[at, plot.box.top], [at, plot.box.bottom]]);
    });
  }
}
