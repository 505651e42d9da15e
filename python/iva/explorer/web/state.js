// The scene that is shown, what was typed but cannot be run, and the way back.

import { clamp } from "./format.js";
import { formIn, formsOf, fromBase, settingOf, slotsOf, toBase } from "./slots.js";
import { toNatural, toSi } from "./units.js";

export const DEFAULT_SCENE = {
  choices: { kind: "siva" },
  values: {
    "primary.damping_ratio": 0.005,
    "absorber.mass_ratio": 0.1,
    "absorber.clearance": 0.5,
    "absorber.restitution": 0.6,
    "start.displacement": 1,
    "run.periods": 20,
  },
};

/** Samples that a run has on the page; long runs have fewer a period. */
const SAMPLES = 1800;

/** What keeps a page alive: longer runs, and runs with more stretches of motion, are for the package. */
const MOST_PERIODS = 1000;
const MOST_WORK = 20_000;

/** A scene as the page runs it: with an end to its work. */
export function limited({ choices, values }) {
  const work = Math.min(values["run.max_work"] ?? MOST_WORK, MOST_WORK);
  return { choices, values: { ...values, "run.max_work": work } };
}

/** Changes within this time to one thing are one step back. */
const ONE_STEP_MS = 800;
const MOST_STEPS = 200;

/** The path of the length of a run, and the length in periods. */
function lengthOf(values) {
  const path = ["run.periods", "run.duration", "run.cycles"].find((name) => values[name] !== undefined);
  return [path, path ? toBase(path, values[path], settingOf(values)) : NaN];
}

/** Samples a period for a run of so many periods. */
function samplesOf(periods) {
  return Math.round(clamp(SAMPLES / (periods > 0 ? periods : 20), 24, 240));
}

export class Explorer {
  /**
   * `values` holds what every kind of absorber was given, so that a way back is no loss; the scene
   * of the engine is what belongs to the kind. `good` is the last scene that could be run.
   */
  constructor(engine, scene) {
    this.engine = engine;
    this.fields = new Map(engine.fields.map((field) => [field.path, field]));
    this.slots = slotsOf(engine.fields);
    this.listeners = [];
    this.past = [];
    this.future = [];
    this.last = { what: null, at: 0 };
    this.pending = new Map();
    /** Why the last change was not made; null if it was. */
    this.refused = null;
    this.units = "natural";
    this.choices = { ...DEFAULT_SCENE.choices };
    this.values = { ...DEFAULT_SCENE.values };
    this.fault = this.load(scene) ?? null;
    if (this.fault) this.load(DEFAULT_SCENE);
    this.first = this.snapshot();
    this.past = [];
  }

  onChange(listener) {
    this.listeners.push(listener);
  }

  tell() {
    for (const listener of this.listeners) listener();
  }

  snapshot() {
    return { choices: { ...this.choices }, values: { ...this.values } };
  }

  /** The scene of these values, as the engine takes it. */
  sceneOf(choices, values) {
    const kept = Object.entries(values).filter(([path]) => {
      const field = this.fields.get(path);
      return field && field.kinds.includes(choices.kind);
    });
    const words = choices.kind === "piva" ? choices : { kind: choices.kind };
    return { choices: { ...words }, values: Object.fromEntries(kept) };
  }

  get scene() {
    return this.sceneOf(this.choices, this.values);
  }

  /** Takes values and runs them if the engine can; else returns why not, and leaves all as it was. */
  accept(choices, values) {
    const { error, units } = this.engine.set(limited(this.sceneOf(choices, values)));
    if (error) return error;
    const [path, periods] = lengthOf(values);
    if (periods > MOST_PERIODS) {
      const sentence = `${path} = ${values[path]}: this page runs at most ${MOST_PERIODS} periods; the package runs more`;
      return { field: path, sentence };
    }
    const samples = samplesOf(periods);
    const run = this.engine.run(samples);
    if (run.error) return run.error;
    Object.assign(this, { choices, values, units, run, samples });
    return null;
  }

  /** Shows another scene, as a step that can be taken back. */
  load(scene) {
    const before = this.snapshot();
    const error = this.accept({ ...scene.choices }, { ...scene.values });
    if (error) return error;
    this.pending.clear();
    this.refused = null;
    this.remember(before, null);
    this.tell();
    return null;
  }

  remember(before, what) {
    const now = Date.now();
    const same = what !== null && this.last.what === what && now - this.last.at < ONE_STEP_MS;
    this.last = { what, at: now };
    if (same) return;
    this.past.push(before);
    if (this.past.length > MOST_STEPS) this.past.shift();
    this.future = [];
  }

  /**
   * Changes values, `undefined` to take one away; `what` names the thing that is changed, for undo.
   * With what was typed before and could not be run it is tried again: two values can become
   * possible together.
   */
  edit(changes, what, choices = {}) {
    const waiting = {};
    const before = this.snapshot();
    const chosen = { ...this.choices, ...choices };
    const belongs = (path) => this.fields.get(path).kinds.includes(chosen.kind);
    for (const [path, { value }] of this.pending) if (!(path in changes) && belongs(path)) waiting[path] = value;
    let error = null;
    if (Object.keys(waiting).length) {
      error = this.accept(chosen, this.changed({ ...waiting, ...changes }));
      if (!error) this.pending.clear();
    }
    if (error || !Object.keys(waiting).length) {
      error = this.accept(chosen, this.changed(changes));
    }
    if (!error) {
      for (const path of Object.keys(changes)) this.pending.delete(path);
      this.remember(before, what);
    }
    this.refused = error;
    this.tell();
    return error;
  }

  /** What was typed into a field; if it cannot be run, the text is kept and the sentence shown. */
  type(path, text) {
    const value = text.trim() === "" ? undefined : Number(text.trim().replaceAll("−", "-"));
    if (Number.isNaN(value)) {
      this.pending.set(path, { text, value: this.values[path], sentence: `${text} is not a number` });
      this.tell();
      return;
    }
    const error = this.edit(this.inSlot(path, value), `type ${path}`);
    if (error) {
      this.pending.set(path, { text, value, sentence: error.sentence });
      this.tell();
    }
  }

  changed(changes) {
    const values = { ...this.values, ...changes };
    for (const path of Object.keys(values)) if (values[path] === undefined) delete values[path];
    return values;
  }

  /** A change of one field that takes away the other forms of its slot. */
  inSlot(path, value) {
    const { part, group } = this.fields.get(path);
    const changes = {};
    for (const field of this.slot(`${part}.${group}`).fields) {
      if (this.values[field.path] !== undefined) changes[field.path] = undefined;
    }
    changes[path] = value;
    return changes;
  }

  slot(key) {
    return this.slots.find((slot) => slot.key === key);
  }

  /** The field in which a slot is given, or could be. */
  form(key) {
    return formIn(this.slot(key), this.scene, this.units);
  }

  forms(slot) {
    return formsOf(slot, this.choices.kind, this.units);
  }

  /** The value of a slot in its base quantity (a length, a ratio), 0 where it has a default of 0. */
  held(key) {
    const field = this.form(key);
    if (!field) return NaN;
    const value = this.values[field.path] ?? field.default ?? NaN;
    return toBase(field.path, value, settingOf(this.values));
  }

  /** Gives a slot a value in its base quantity, in the form that it has; `round` shortens it. */
  hold(key, base, what, round = (value) => value) {
    const field = this.form(key);
    return this.edit(this.inSlot(field.path, round(fromBase(field.path, base, settingOf(this.values)))), what);
  }

  undo() {
    this.step(this.past, this.future);
  }

  redo() {
    this.step(this.future, this.past);
  }

  step(from, to) {
    const scene = from.pop();
    if (!scene) return;
    to.push(this.snapshot());
    this.accept(scene.choices, scene.values);
    this.pending.clear();
    this.refused = null;
    this.last = { what: null, at: 0 };
    this.tell();
  }

  reset() {
    this.load(this.first);
  }

  /** Gives all values in SI units with lengths in mm, or without dimensions. */
  switchUnits(units) {
    const before = this.snapshot();
    let error = null;
    try {
      const values = units === "si" ? toSi(this.values, this.fields) : toNatural(this.values, this.fields);
      error = this.accept(this.choices, values);
    } catch (fault) {
      error = { field: "units", sentence: fault.message };
    }
    if (!error) {
      this.pending.clear();
      this.remember(before, null);
    }
    this.refused = error;
    this.tell();
    return error;
  }
}
