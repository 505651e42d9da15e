// The page: one scene, its views, and the instant that they share.

import { fromAddress, toAddress } from "./address.js";
import { Controls } from "./controls.js";
import { Drawing } from "./drawing.js";
import { Forced } from "./forced.js";
import { ScanMap } from "./map.js";
import { Engine } from "./engine.js";
import { clamp, make, shown, withUnit } from "./format.js";
import { MeasureTable } from "./measures.js";
import { absorbersOf, isForced, modalOf } from "./motion.js";
import { energyView, phaseView } from "./planes.js";
import { coloursOf } from "./plot.js";
import { DEFAULT_SCENE, Explorer, limited } from "./state.js";
import { asPython, asStudy, offer } from "./takeaway.js";
import { displacementView, gapView } from "./time_views.js";
import { TAU } from "./slots.js";
import { drawnIn } from "./units.js";

const KINDS = { siva: "Free mass", piva: "Pendulum", none: "No absorber" };
/** What is said of a run that ended before its time. */
const EARLY = {
  work_limit: "The run ends early: it has more stretches of motion than this page computes. The package runs it whole.",
  impact_limit: "The run ends early: it has reached its largest number of impacts.",
  not_finite: "The run ends early: a number of it is not finite.",
};
/** A scene that has not changed for so long rests. */
const REST_MS = 300;
/** With fewer correct digits of its impact times a scene is called sensitive. */
const FEW_DIGITS = 8;
const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 5, 10];

/** Values that a scene needs when it becomes a pendulum. */
function pendulumValues(explorer) {
  const { values } = explorer;
  if (values["absorber.length"] !== undefined || values["absorber.frequency_ratio"] !== undefined) return {};
  const length = 3 * Math.max(explorer.held("absorber.clearance") || 0, explorer.setting.reference || 0);
  return { "absorber.length": Number(length.toPrecision(2)) || 1, "absorber.frequency_ratio": 0.4 };
}

class Page {
  constructor(element, options, engine) {
    this.options = options;
    this.engine = engine;
    this.root = make("div", { class: options.brief ? "iva-explorer brief" : "iva-explorer" });
    const pasted = options.address ? fromAddress(location.hash, engine.fields) : null;
    this.state = new Explorer(engine, pasted ?? options.scene ?? DEFAULT_SCENE);
    this.instant = 0;
    this.playing = false;
    this.showAlone = true;
    this.built = this.build();
    element.replaceChildren(this.root);
    this.theme();
    this.listen();
    this.state.onChange(() => this.refresh());
    this.refresh();
    performance.mark("first scene");
    if (this.state.fault) this.say(`The scene that was given cannot be run: ${this.state.fault.sentence}. This is another.`);
    const still = matchMedia("(prefers-reduced-motion: reduce)").matches;
    if (!still && options.play !== false) this.play(true);
  }

  build() {
    const { state } = this;
    /** Of each absorber a drawing and its gap. */
    this.drawings = [];
    this.gaps = [];
    this.pictures = [make("div", { class: "each" }), make("div", { class: "each gaps" })];
    this.displacement = displacementView();
    this.phase = phaseView(() => this.draw());
    this.energy = energyView();
    this.more(1);
    this.controls = new Controls(state);
    this.map = new ScanMap(state, this.options, this.engine);
    this.forced = new Forced(state, this.map.worker, (x) => state.edit(state.inSlot("force.relative_frequency", x), "response"));
    this.table = new MeasureTable(this.engine.measures);
    this.foot = make("p", { class: "foot" });
    this.root.append(this.head(),
      make("div", { class: "columns" },
        make("div", { class: "views" }, this.pictures[0], this.transport(), this.displacement.element,
          this.pictures[1],
          make("div", { class: "planes" }, this.phase.element, this.energy.element, this.map.view.element,
            ...this.forced.views.map((view) => view.element))),
        make("div", { class: "side" }, this.controls.element, this.table.element)),
      this.foot);
    // Time runs along both: a press on them sets the instant.
    for (const view of [this.displacement, this.energy]) this.scrubOn(view);
  }

  /** Makes pictures for so many absorbers; those that are not needed are hidden. */
  more(count) {
    while (this.drawings.length < count) {
      const place = this.drawings.length;
      this.drawings.push(new Drawing(this.state, () => { this.play(false); this.goTo(0); }, place));
      this.gaps.push(gapView(place));
      this.pictures[0].append(this.drawings[place].view.element);
      this.pictures[1].append(this.gaps[place].element);
      this.scrubOn(this.gaps[place]);
    }
    const own = [this.drawings.map(({ view }) => view), this.gaps].map((views) => views.slice(0, count));
    for (const { view } of this.drawings) view.element.hidden = !own[0].includes(view);
    for (const view of this.gaps) view.element.hidden = !own[1].includes(view) || this.state.choices.kind === "none";
    for (const element of this.pictures) element.classList.toggle("several", count > 1);
    this.views = [...own[0], this.displacement, ...(this.state.choices.kind === "none" ? [] : own[1]), this.phase, this.energy];
  }

  head() {
    const { state } = this;
    const button = (label, action, help) => make("button", { type: "button", onclick: action, title: help }, label);
    this.kind = make("div", { class: "kinds", role: "radiogroup", "aria-label": "Kind of absorber" },
      ...Object.entries(KINDS).map(([kind, label]) => {
        const input = make("input", {
          type: "radio", name: `kind-${Math.random()}`, value: kind,
          onchange: () => state.edit(kind === "piva" ? pendulumValues(state) : {}, null, { kind }),
        });
        return make("label", {}, input, label);
      }));
    this.units = make("select", { "aria-label": "Units", onchange: () => this.switchUnits() },
      make("option", { value: "natural" }, "without dimensions"), make("option", { value: "si" }, "SI, mm"),
      make("option", { value: "seconds", hidden: true }, "seconds"));
    this.undo = button("Undo", () => state.undo(), "Ctrl-Z");
    this.redo = button("Redo", () => state.redo(), "Ctrl-Shift-Z");
    const alone = make("input", {
      type: "checkbox", checked: true,
      onchange: () => { this.showAlone = alone.checked; this.refresh(); },
    });
    return make("header", {}, this.kind, this.units, this.undo, this.redo,
      button("Reset", () => state.reset(), "Back to the first scene"),
      make("span", { class: "take" },
        button("Copy as Python", () => offer(this.root, "The scene as Python", asPython(state.scene), "scene.py", "text/x-python")),
        button("Copy as study", () => offer(this.root, "The scene as a study", asStudy(state.scene), "scene.toml", "application/toml"))),
      make("label", { class: "check" }, alone, "structure alone"),
      button("Dark / light", () => this.theme(true), "Switch between dark and light"), this.statusLine());
  }

  statusLine() {
    this.alert = make("p", { class: "wrong", role: "alert" });
    return this.alert;
  }

  transport() {
    this.playButton = make("button", { type: "button", class: "play", onclick: () => this.play(!this.playing) }, "Play");
    this.scrubber = make("input", {
      type: "range", min: "0", max: "1", step: "any", "aria-label": "Instant",
      oninput: () => { this.play(false); this.goTo(Number(this.scrubber.value)); },
    });
    this.speed = make("select", { "aria-label": "Speed, periods a second" },
      ...SPEEDS.map((value) => make("option", { value: String(value), selected: value === 1 }, `${value} periods/s`)));
    this.reading = make("output", { class: "reading" });
    return make("div", { class: "transport" }, this.playButton, this.scrubber, this.speed, this.reading);
  }

  scrubOn(view) {
    const { pad } = view;
    pad.classList.add("scrub");
    const set = (event) => {
      const box = pad.getBoundingClientRect();
      if (view.plot?.xAt) this.goTo(view.plot.xAt(event.clientX - box.left));
    };
    pad.addEventListener("pointerdown", (event) => {
      if (event.button !== 0) return;
      pad.setPointerCapture(event.pointerId);
      this.play(false);
      set(event);
    });
    pad.addEventListener("pointermove", (event) => { if (pad.hasPointerCapture(event.pointerId)) set(event); });
  }

  switchUnits() {
    const error = this.state.switchUnits(this.units.value);
    if (error) this.say(error.sentence);
    this.controls.made = "";
    this.refresh();
  }

  /** Dark or light: as the system has it, until somebody chooses. */
  theme(turn = false) {
    const dark = matchMedia("(prefers-color-scheme: dark)").matches;
    const now = this.root.dataset.theme ?? (dark ? "dark" : "light");
    if (turn) this.root.dataset.theme = now === "dark" ? "light" : "dark";
    this.colours = coloursOf(this.root);
    document.documentElement.style.colorScheme = this.options.address ? this.root.dataset.theme ?? "" : "";
    if (this.options.address) document.body.style.background = this.colours.back;
    if (this.data) this.draw();
  }

  listen() {
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.theme());
    (this.options.address ? document : this.root).addEventListener("keydown", (event) => {
      const typing = event.target.matches("input[type=text], textarea");
      if ((event.ctrlKey || event.metaKey) && event.key.toLowerCase() === "z" && !typing) {
        event.preventDefault();
        if (event.shiftKey) this.state.redo();
        else this.state.undo();
      }
    });
    if (!this.options.address) return;
    addEventListener("hashchange", () => {
      const scene = fromAddress(location.hash, this.engine.fields);
      if (!scene || location.hash === `#${toAddress(this.state.scene)}`) return;
      const error = this.state.load(scene);
      if (error) this.say(`The scene in the address cannot be run: ${error.sentence}`);
    });
  }

  say(text) {
    this.alert.textContent = text;
  }

  /** What is drawn of a scene: its run and what the views need to know of it. */
  compute() {
    const { state } = this;
    const { scene, units, samples, setting, absorbers: { length: count } } = state;
    const period = TAU / setting.natural;
    const run = { ...state.run, trajectory: { ...state.run.trajectory, energy: state.run.energies.total } };
    const absorbers = absorbersOf(state, run);
    const [{ path }] = absorbers;
    const [x0] = path.displacement;
    return {
      run, path, scene, setting, units, period, samples, x0, count, kind: scene.choices.kind,
      absorbers, modal: modalOf(state), alone: this.alone(samples),
      reference: Math.abs(x0) || run.envelope.amplitude?.[0] || Math.abs(run.envelope.displacement[0]) || 0,
      forced: isForced(scene), showAlone: this.showAlone, drawn: (quantity) => drawnIn(quantity, units),
    };
  }

  /** The same structure without absorber; it is run again only if something of it changes. */
  alone(samples) {
    const { engine, state } = this;
    if (state.kinds[0] === "none" || !this.showAlone) return null;
    const scene = state.sceneOf({ kind: "none" }, state.values);
    const key = JSON.stringify([scene, samples]);
    if (this.aloneKey !== key) {
      this.aloneKey = key;
      const { error } = engine.set(limited(scene));
      const run = error ? { error } : engine.run(samples);
      this.aloneRun = run.error ? null : { ...run.trajectory, summary: run.summary };
    }
    return this.aloneRun;
  }

  refresh() {
    const { state } = this;
    this.data = this.compute();
    this.more(this.data.absorbers.length);
    const times = this.data.run.trajectory.time;
    [this.begin, this.end] = [times[0], times[times.length - 1]];
    this.scrubber.min = String(this.begin);
    this.scrubber.max = String(this.end);
    this.instant = clamp(this.instant, this.begin, this.end);
    for (const input of this.kind.querySelectorAll("input")) input.checked = input.value === state.choices.kind;
    this.units.value = state.units;
    this.undo.disabled = !state.past.length;
    this.redo.disabled = !state.future.length;
    this.root.classList.toggle("pendulum", state.kinds.includes("piva"));
    this.root.classList.toggle("modal", this.data.modal !== null);
    this.kind.hidden = state.kinds.length > 1;
    this.units.disabled = Object.keys(state.fixed).length > 0;
    for (const [place, { label, kind }] of this.data.absorbers.entries()) {
      this.gaps[place].heading.textContent = kind === "stop" ? `Point${label} between stops y(t)` : `Absorber${label} in its gap y(t)`;
    }
    this.displacement.heading.textContent = `Structure x(t)${this.data.modal ? ` at ${this.data.modal.seen}` : ""}`;
    this.say([...state.pending.values()].length ? "A value cannot be run: the pictures show the last scene that can."
      : state.refused?.sentence ?? EARLY[this.data.run.summary.outcome] ?? (this.data.count > this.data.absorbers.length
        ? `There are ${this.data.count} absorbers, of which the first ${this.data.absorbers.length} are drawn.` : ""));
    this.controls.show();
    this.forced.show(this.data, this.colours);
    this.map.scene(this.data, this.colours);
    this.table.show(this.data);
    this.digitsLater();
    this.draw();
    this.options.onScene?.(state.scene);
    if (this.options.address && !state.fixed.records) this.addressLater();
  }

  /** Shows another scene, as a step that can be taken back. */
  show(scene) {
    const error = this.state.load(scene);
    if (error) this.say(`The scene that was given cannot be run: ${error.sentence}`);
    return error;
  }

  /** Correct digits take longer than the run: they are estimated once the scene rests. */
  digitsLater() {
    clearTimeout(this.digitsTimer);
    this.footnote(null);
    this.digitsTimer = setTimeout(() => {
      this.engine.set(limited(this.state.scene));
      this.footnote(this.engine.run(1, true).summary?.digits ?? null);
    }, REST_MS);
  }

  footnote(digits) {
    const { run: { summary, trajectory }, samples, units } = this.data;
    const parts = [
      `iva ${this.options.version ?? ""}`.trim(), `outcome ${summary.outcome}`,
      summary.tier ? `tier ${summary.tier}` : null, `${trajectory.time.length} rows, ${samples} samples a period`,
      digits === null ? null : `impact times to ${shown(digits, 2)} digits${digits < FEW_DIGITS ? ": a sensitive scene" : ""}`,
      { si: "SI units, lengths drawn in mm", seconds: "time in s, lengths in units L of your choice", natural: "ωₙ = 1, lengths in units L of your choice" }[units],
    ];
    this.foot.textContent = parts.filter(Boolean).join(" · ");
  }

  draw() {
    // All sizes are asked for before the first canvas gets one: else the page is laid out anew for each.
    const all = [...this.views, this.map.view, ...this.forced.views];
    for (const view of all) view.measure();
    for (const view of this.views) view.show(this.data, this.colours);
    this.map.draw(this.data, this.colours);
    this.forced.draw(this.data, this.colours);
    this.goTo(this.instant);
  }

  goTo(instant) {
    this.instant = clamp(instant, this.begin, this.end);
    this.scrubber.value = String(this.instant);
    const time = withUnit(this.instant, this.data.drawn("Time").unit);
    this.scrubber.setAttribute("aria-valuetext", time);
    this.reading.textContent = `t = ${time}`;
    for (const view of this.views) view.at(this.instant);
  }

  play(on) {
    if (on === this.playing) return;
    this.playing = on;
    this.playButton.textContent = on ? "Pause" : "Play";
    if (!on) return;
    if (this.instant >= this.end) this.instant = this.begin;
    let last = performance.now();
    const frame = (now) => {
      if (!this.playing || !this.root.isConnected) return;
      this.goTo(this.instant + ((now - last) / 1e3) * Number(this.speed.value) * this.data.period);
      last = now;
      if (this.instant >= this.end) this.play(false);
      else requestAnimationFrame(frame);
    };
    requestAnimationFrame(frame);
  }

  /** Browsers let a page set its address only so often. */
  addressLater() {
    clearTimeout(this.addressTimer);
    this.addressTimer = setTimeout(() => {
      try {
        history.replaceState(null, "", `#${toAddress(this.state.scene)}`);
      } catch {
        // A page in a frame without an address of its own keeps its state for itself.
      }
    }, 250);
  }
}

/** Puts an explorer into an element; `ready` is its page once the engine has been loaded. */
export function mount(element, options) {
  const ready = Promise.resolve(Engine.load(options.wasm)).then((engine) => {
    const page = new Page(element, options, engine);
    return page;
  });
  ready.catch((error) => {
    element.textContent = `The explorer could not start: ${error.message}`;
    throw error;
  });
  return {
    ready,
    scene: () => ready.then((page) => page.state.scene),
    destroy: () => ready.then((page) => {
      page.play(false);
      page.map.worker.stop();
      element.replaceChildren();
    }),
  };
}
