// Between a scene without dimensions and the same scene in SI units, with lengths in millimetres.

import { rounded } from "./format.js";
import { BASES, fromBase, plain, settingOf, toBase } from "./slots.js";

/** The rig that a scene without dimensions becomes: 3 kg on 12 kN/m, and 4 mm for a length of 1. */
const RIG = { mass: 3, stiffness: 12_000, length: 0.004 };

/** Powers of length and of ωₙ in a quantity of the fields in {@link BASES}. */
const POWERS = {
  Length: [1, 0],
  Velocity: [1, 1],
  Acceleration: [1, 2],
  Time: [0, -1],
  AngularFrequency: [0, 1],
  AngularVelocity: [0, 1],
};

/** What a value of this quantity is multiplied by, if lengths are and frequencies are. */
function factorOf(quantity, length, frequency) {
  const [lengths, frequencies] = POWERS[quantity] ?? [0, 0];
  return length ** lengths * frequency ** frequencies;
}

/** Where views draw a quantity of the engine in another unit: lengths of SI scenes in mm. */
export function drawnIn(quantity, units) {
  const si = units === "si";
  const names = {
    Length: si ? "mm" : "L",
    Velocity: si ? "mm/s" : units === "natural" ? "L ωₙ" : "L/s",
    Time: units === "natural" ? "1/ωₙ" : "s",
    Energy: si ? "J" : units === "natural" ? "M (L ωₙ)²" : "M (L/s)²",
  };
  return { factor: si && (quantity === "Length" || quantity === "Velocity") ? 1e3 : 1, unit: names[quantity] };
}

/** The values of a scene with other dimensions; `fields` by path. */
export function converted(values, fields, length, frequency) {
  const setting = settingOf(values);
  const result = {};
  for (const [path, value] of Object.entries(values)) {
    const field = fields.get(path);
    if (path === "primary.mass" || (field.part === "primary" && field.group === "frequency")) continue;
    const own = ["Ratio", "Count", "Angle", "Degree"].includes(field.quantity) || plain(path) === "force.base_acceleration";
    const base = own ? plain(path) : BASES[`${field.part}.${field.group}`] ?? plain(path);
    const held = own ? value : toBase(path, value, setting);
    const to = path.replace(/[^.]+$/, base.split(".")[1]);
    if (Number.isNaN(held)) throw new RangeError(`${path} cannot be given in the other units; clear it first`);
    const target = fields.get(to);
    result[to] = rounded(held * factorOf(target.quantity, length, frequency), 12);
  }
  return result;
}

/** The scene on a rig of kilograms, newtons per metre and millimetres. */
export function toSi(values, fields) {
  const setting = settingOf(values);
  const frequency = Math.sqrt(RIG.stiffness / RIG.mass);
  const result = converted(values, fields, RIG.length, frequency / setting.natural);
  for (const name of Object.keys(result)) {
    if (!["start.displacement", "absorber.clearance", "absorber.gap_offset"].includes(plain(name))) continue;
    result[`${name}_mm`] = rounded(1e3 * result[name], 12);
    delete result[name];
  }
  return { "primary.mass": RIG.mass, "primary.stiffness": RIG.stiffness, ...result };
}

/** The scene without dimensions: ωₙ = 1, and the release displacement as the unit of length. */
export function toNatural(values, fields) {
  const setting = settingOf(values);
  const given = values["start.displacement"] ?? (values["start.displacement_mm"] ?? 0) / 1e3;
  const start = Math.abs(given) || RIG.length;
  return converted(values, fields, 1 / start, 1 / setting.natural);
}

/** One value in another form of the same slot, short where it can be. */
export function inForm(from, value, to, setting) {
  const held = toBase(from, value, setting);
  return rounded(fromBase(to, held, setting), 12);
}
