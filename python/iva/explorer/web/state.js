// The scene that is shown, what was typed but cannot be run, and the way back.

import { clamp } from "./format.js";
import { Engine } from "./engine.js";
import { fieldsOf, fits, formIn, formsOf, fromBase, kindsOf, settingOf, slotsOf, toBase } from "./slots.js";
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
const SAMPLES = 1200;

/** What keeps a page alive: longer runs, and runs with more stretches of motion, are for the package. */
const MOST_PERIODS = 1000;
const MOST_WORK = 20_000;

/** A scene as the page runs it: with an end to its work. */
export function limited({ choices, values, fixed }) {
  const work = Math.min(values["run.max_work"] ?? MOST_WORK, MOST_WORK);
  return { choices, values: { ...values, "run.max_work": work }, fixed };
}

/** Changes within this time to one thing are one step back. */
const ONE_STEP_MS = 800;
const MOST_STEPS = 200;

/** The path of the length of a run. */
export function lengthIn(values) {
  return ["run.periods", "run.duration", "run.cycles"].find((name) => values[name] !== undefined);
}

/** Samples a period for a run of so many periods; of several absorbers each has them. */
function samplesOf(periods, absorbers) {
  return Math.round(clamp(SAMPLES / (periods > 0 ? periods : 20) / Math.max(1, absorbers), 24, 240));
}

export class Explorer {
  /**
   * `values` holds what every kind of absorber was given, so that a way back is no loss; the scene
   * of the engine is what belongs to the kind. `good` is the last scene that could be run.
   */
  constructor(engine, scene) {
    this.engine = engine;
    this.shapes = new Map();
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
    this.fixed = {};
    this.reshape(this);
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
    return { choices: { ...this.choices }, values: { ...this.values }, fixed: this.fixed };
  }

  /** Takes the fields and slots of a scene of so many absorbers and forces. */
  reshape({ choices, values, fixed }) {
    const [absorbers, forces] = [kindsOf(choices).length, Engine.forces({ values, fixed })];
    const key = `${absorbers} ${forces}`;
    if (!this.shapes.has(key)) {
      const fields = fieldsOf(this.engine.fields, absorbers, forces);
      this.shapes.set(key, { fields: new Map(fields.map((field) => [field.path, field])), slots: slotsOf(fields) });
    }
    Object.assign(this, this.shapes.get(key));
  }

  /** The kinds of the absorbers. */
  get kinds() {
    return kindsOf(this.choices);
  }

  /** What conversions depend on. */
  get setting() {
    return settingOf(this.values, this.fixed.structure && this.natural);
  }

  /** The scene of these values, as the engine takes it. */
  sceneOf(choices, values, fixed = this.fixed) {
    const kinds = kindsOf(choices);
    const kept = Object.entries(values).filter(([path]) => {
      const field = this.fields.get(path);
      return field && fits(field, kinds);
    });
    const of = (name) => this.engine.description.choices.find((choice) => choice.name === name.replace(/^\d+\./, ""));
    const words = Object.entries(choices).filter(([name]) => of(name).kinds.includes(kinds[parseInt(name, 10) || 0]));
    const { tables, starts, ...others } = fixed;
    const bare = kinds.length === 1 && kinds[0] === "none";
    return { choices: Object.fromEntries(words), values: Object.fromEntries(kept), fixed: bare ? others : fixed };
  }

  get scene() {
    return this.sceneOf(this.choices, this.values);
  }

  /** Takes values and runs them if the engine can; else returns why not, and leaves all as it was. */
  accept(choices, values, fixed = this.fixed) {
    this.reshape({ choices, values, fixed });
    const error = this.try(choices, values, fixed);
    if (error) this.reshape(this);
    return error;
  }

  try(choices, values, fixed) {
    const { error, units, natural, absorbers } = this.engine.set(limited(this.sceneOf(choices, values, fixed)));
    if (error) return error;
    const path = lengthIn(values);
    const periods = path ? toBase(path, values[path], settingOf(values, natural)) : NaN;
    if (periods > MOST_PERIODS) {
      const sentence = `${path} = ${values[path]}: this page runs at most ${MOST_PERIODS} periods; the package runs more`;
      return { field: path, sentence };
    }
    const samples = samplesOf(periods, absorbers.length);
    const run = this.engine.run(samples);
    if (run.error) return run.error;
    Object.assign(this, { choices, values, fixed, units, natural, absorbers, run, samples });
    return null;
  }

  /** Shows another scene, as a step that can be taken back. */
  load(scene) {
    const before = this.snapshot();
    const error = this.accept({ ...scene.choices }, { ...scene.values }, scene.fixed ?? {});
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
    const belongs = (path) => fits(this.fields.get(path), kindsOf(chosen));
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
    const changes = {};
    for (const field of this.slot(this.fields.get(path).slot).fields) {
      if (this.values[field.path] !== undefined) changes[field.path] = undefined;
    }
    changes[path] = value;
    return changes;
  }

  /** The key of a slot of the absorber of this number in the list. */
  keyOf(number, part, group) {
    return this.kinds.length > 1 ? `${part}.${number}.${group}` : `${part}.${group}`;
  }

  slot(key) {
    return this.slots.find((slot) => slot.key === key);
  }

  /** The field in which a slot is given, or could be. */
  form(key) {
    return formIn(this.slot(key), this.scene, this.units);
  }

  forms(slot) {
    return formsOf(slot, this.kinds, this.units);
  }

  /** The value of a slot in its base quantity (a length, a ratio), 0 where it has a default of 0. */
  held(key) {
    const field = this.form(key);
    if (!field) return NaN;
    const value = this.values[field.path] ?? field.default ?? NaN;
    return toBase(field.path, value, this.setting);
  }

  /** Gives a slot a value in its base quantity, in the form that it has; `round` shortens it. */
  hold(key, base, what, round = (value) => value) {
    const field = this.form(key);
    return this.edit(this.inSlot(field.path, round(fromBase(field.path, base, this.setting))), what);
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
    this.accept(scene.choices, scene.values, scene.fixed);
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
