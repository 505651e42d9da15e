// A slot is one quantity of a scene; the fields of a slot are the alternative ways to give it.

export const TAU = 2 * Math.PI;
const NEEDS_MASS = ["Millimetre", "Mass", "Stiffness", "Force", "Impulse", "Damping"];

/** Words and symbol of the fields; what is not here is called by its name. */
const WORDS = {
  "primary.damping_ratio": ["Damping ratio", "ζ"],
  "primary.damping": ["Damping", "c"],
  "primary.natural_frequency": ["Natural frequency", "ωₙ"],
  "primary.frequency_hz": ["Natural frequency", "fₙ"],
  "primary.stiffness": ["Stiffness", "k"],
  "primary.mass": ["Mass of the structure", "M"],
  "absorber.mass_ratio": ["Mass ratio", "μ"],
  "absorber.mass": ["Mass", "m"],
  "absorber.restitution": ["Restitution", "e"],
  "absorber.restitution_minus": ["Restitution at wall −", "e₋"],
  "absorber.relative_clearance": ["Relative clearance", "γ"],
  "absorber.clearance": ["Clearance", "d"],
  "absorber.clearance_mm": ["Clearance", "d"],
  "absorber.gap": ["Gap, total play", "2d"],
  "absorber.gap_mm": ["Gap, total play", "2d"],
  "absorber.gap_offset": ["Middle of the gap", "y"],
  "absorber.gap_offset_mm": ["Middle of the gap", "y"],
  "absorber.frequency_ratio": ["Frequency ratio", "r"],
  "absorber.length": ["Length", "L"],
  "absorber.inclination": ["Inclination", "α"],
  "absorber.inclination_deg": ["Inclination", "α"],
  "absorber.gravity": ["Gravity", "g"],
  "absorber.inertia_ratio": ["Inertia ratio", "κ"],
  "absorber.contact_distance": ["Pivot to stops", "b"],
  "absorber.pivot_damping_ratio": ["Pivot damping ratio", "ζₚ"],
  "absorber.spring_ratio": ["Spring ratio", "σ"],
  "absorber.friction": ["Friction", "k"],
  "absorber.gap_damping": ["Dashpot in the gap", "c"],
  "absorber.gap_damping_ratio": ["Dashpot in the gap", "ζ"],
  "absorber.spring": ["Spring in the gap", "k"],
  "absorber.units": ["Units", "N"],
  "force.amplitude": ["Force over mass", "F/M"],
  "force.force": ["Force", "F"],
  "force.base_acceleration": ["Base acceleration", "a"],
  "force.frequency": ["Frequency of the force", "Ω"],
  "force.relative_frequency": ["Relative frequency", "Ω/ωₙ"],
  "force.frequency_hz": ["Frequency of the force", "f"],
  "force.phase": ["Phase", "φ"],
  "force.velocity": ["Impulse over mass", "P/M"],
  "force.impulse": ["Impulse", "P"],
  "force.time": ["Instant of the impulse", "t"],
  "force.scale": ["Scale of the record", ""],
  "start.displacement": ["Release displacement", "x₀"],
  "start.displacement_mm": ["Release displacement", "x₀"],
  "start.velocity": ["Velocity", "ẋ₀"],
  "start.gap_displacement": ["Absorber in its gap", "y₀"],
  "start.gap_velocity": ["Gap velocity", "w₀"],
  "start.angle": ["Angle of the pendulum", "θ₀"],
  "start.angular_velocity": ["Angular velocity", "θ̇₀"],
  "run.periods": ["Periods", "n"],
  "run.duration": ["Duration", "T"],
  "run.cycles": ["Cycles of the force", "N"],
  "run.discard": ["Cycles left out", ""],
};

/** A path without the number of its absorber or force: `absorber.1.mass` is a mass. */
export function plain(path) {
  return path.replace(/\.\d+\./, ".");
}

/** The kinds of the absorbers of a scene. */
export function kindsOf(choices) {
  const kinds = [];
  for (const [name, word] of Object.entries(choices)) if (name.endsWith("kind")) kinds[parseInt(name, 10) || 0] = word;
  return kinds;
}

/** The fields of a scene: those of an absorber or of a force once for each of several, with its `number`. */
export function fieldsOf(fields, absorbers, forces) {
  return fields.flatMap((field) => {
    const count = field.of_absorber ? absorbers : field.part === "force" ? forces : 1;
    const slot = (number) => `${field.part}.${number}${field.group}`;
    if (count < 2) return [{ ...field, slot: slot("") }];
    return Array.from({ length: count }, (_, number) => ({
      ...field, number, path: `${field.part}.${number}.${field.name}`, slot: slot(`${number}.`),
    }));
  });
}

/** The slots that stand open; all others are under "More". */
const USUAL = [
  "absorber.mass", "absorber.clearance", "absorber.restitution", "absorber.frequency",
  "absorber.length", "primary.damping", "primary.frequency", "primary.mass",
  "start.displacement", "run.duration", "force.amplitude", "force.frequency", "force.impulse", "force.time", "force.scale", "absorber.inclination",
];

/** Ends of a slider where the size of the quantity is known: low, high, and if it runs by factors. */
const RANGES = {
  "primary.damping_ratio": [0, 0.1, false],
  "absorber.mass_ratio": [0.005, 0.5, true],
  "absorber.restitution": [0, 1, false],
  "absorber.restitution_minus": [0, 1, false],
  "absorber.relative_clearance": [0.05, 3, true],
  "absorber.frequency_ratio": [0.05, 2, true],
  "absorber.inclination": [0, Math.PI / 2, false],
  "absorber.inclination_deg": [0, 90, false],
  "absorber.inertia_ratio": [1, 3, false],
  "absorber.friction": [0, 0.5, false],
  "absorber.gap_damping_ratio": [0, 0.5, false],
  "absorber.units": [1, 8, false],
  "absorber.clearance_spread": [0, 0.9, false],
  "absorber.pivot_damping_ratio": [0, 0.2, false],
  "absorber.spring_ratio": [0, 2, false],
  "force.relative_frequency": [0.5, 1.5, false],
  "force.phase": [-Math.PI, Math.PI, false],
  "start.angle": [-1.5, 1.5, false],
  "run.periods": [1, 100, true],
  "run.cycles": [10, 400, true],
  "run.discard": [0, 200, false],
  "run.max_impacts": [1, 1e7, true],
  "run.max_work": [1, 1e8, true],
};

export function wordsOf(field) {
  const words = WORDS[plain(field.path)];
  if (words) return words;
  const text = field.name.replace(/_(mm|deg|hz)$/, "").replaceAll("_", " ");
  return [text[0].toUpperCase() + text.slice(1), ""];
}

export function isUsual(slot) {
  return USUAL.includes(plain(slot.key));
}

/** The slots of the fields, in the order of the engine; the tier of less accuracy is not for this page. */
export function slotsOf(fields) {
  const slots = new Map();
  for (const field of fields) {
    if (field.path === "run.tolerance") continue;
    const { slot: key, part, number } = field;
    if (!slots.has(key)) slots.set(key, { key, part, number, fields: [] });
    slots.get(key).fields.push(field);
  }
  return [...slots.values()];
}

/** True if a scene with absorbers of these kinds has a field. */
export function fits(field, kinds) {
  const own = field.of_absorber && field.number !== undefined ? [kinds[field.number]] : kinds;
  return own.some((kind) => field.kinds.includes(kind));
}

/** The fields of a slot that this scene can have. */
export function formsOf(slot, kinds, units) {
  return slot.fields.filter(
    (field) => fits(field, kinds) && (units === "si" || !NEEDS_MASS.includes(field.quantity)),
  );
}

/** The given field of a slot, or the first that it could have. */
export function formIn(slot, scene, units) {
  const forms = formsOf(slot, kindsOf(scene.choices), units);
  return forms.find((field) => scene.values[field.path] !== undefined) ?? forms[0] ?? null;
}

/** What conversions between the forms of a slot depend on; `known` is the natural frequency of a structure with modes. */
export function settingOf(values, known) {
  const mass = values["primary.mass"] ?? 1;
  const hertz = values["primary.frequency_hz"];
  const stiffness = values["primary.stiffness"];
  const natural = known ?? values["primary.natural_frequency"]
    ?? (hertz !== undefined ? TAU * hertz : stiffness !== undefined ? Math.sqrt(stiffness / mass) : 1);
  const start = values["start.displacement"] ?? (values["start.displacement_mm"] ?? 0) / 1e3;
  const reference = Math.abs(values["start.reference"] ?? start);
  const ofFirst = (name) => values[`force.${name}`] ?? values[`force.0.${name}`];
  const relative = ofFirst("relative_frequency");
  const force = ofFirst("frequency")
    ?? (relative !== undefined ? relative * natural : TAU * (ofFirst("frequency_hz") ?? NaN));
  return { mass, natural, reference, force, values };
}

/** From the pivot of the pendulum whose angle has this path to its stops. */
function armOf(path, { values }) {
  const of = (name) => values[path.replace("start", "absorber").replace("angle", name)];
  return of("contact_distance") ?? of("length") ?? NaN;
}

/** Factors from a field to the first quantity of its slot: ζ, ωₙ, μ, d, y, rad, f/M, Ω, P/M, x, periods. */
const FACTORS = {
  "primary.damping": (s) => 1 / (2 * s.mass * s.natural),
  "primary.frequency_hz": () => TAU,
  "absorber.mass": (s) => 1 / s.mass,
  "absorber.gap_damping": (s) => 1 / (2 * s.mass * s.natural),
  "absorber.relative_clearance": (s) => s.reference,
  "absorber.clearance_mm": () => 1e-3,
  "absorber.gap": () => 0.5,
  "absorber.gap_mm": () => 0.5e-3,
  "absorber.gap_offset_mm": () => 1e-3,
  "absorber.inclination_deg": () => Math.PI / 180,
  "force.force": (s) => 1 / s.mass,
  "force.relative_frequency": (s) => s.natural,
  "force.frequency_hz": () => TAU,
  "force.impulse": (s) => 1 / s.mass,
  "start.impulse": (s) => 1 / s.mass,
  "start.displacement_mm": () => 1e-3,
  "run.duration": (s) => s.natural / TAU,
  "run.cycles": (s) => s.natural / s.force,
};

/** The field in which a slot is held where no form is preferred. */
export const BASES = {
  "primary.damping": "primary.damping_ratio",
  "primary.frequency": "primary.natural_frequency",
  "absorber.mass": "absorber.mass_ratio",
  "absorber.clearance": "absorber.clearance",
  "absorber.gap_damping": "absorber.gap_damping_ratio",
  "absorber.gap_offset": "absorber.gap_offset",
  "absorber.inclination": "absorber.inclination",
  "force.amplitude": "force.amplitude",
  "force.frequency": "force.frequency",
  "force.impulse": "force.velocity",
  "start.displacement": "start.displacement",
  "start.impulse": "start.impulse_velocity",
  "start.gap_displacement": "start.gap_displacement",
  "run.duration": "run.periods",
};

/** Fields without a factor to the first of their slot. */
const OTHERWISE = [
  "absorber.contact_stiffness", "start.angular_velocity", "absorber.spring",
  "force.base_velocity", "force.base_displacement", "force.base_displacement_mm",
];

/** A value of a field in the quantity of {@link BASES}; NaN where it has no such value. */
export function toBase(path, value, setting) {
  const name = plain(path);
  if (name === "primary.stiffness") return Math.sqrt(value / setting.mass);
  if (name === "start.angle") return armOf(path, setting) * Math.sin(value);
  if (OTHERWISE.includes(name)) return NaN;
  return value * (FACTORS[name]?.(setting) ?? 1);
}

/** The value of a field that is so much in the quantity of {@link BASES}. */
export function fromBase(path, value, setting) {
  const name = plain(path);
  if (name === "primary.stiffness") return setting.mass * value ** 2;
  if (name === "start.angle") return Math.asin(value / armOf(path, setting));
  if (OTHERWISE.includes(name)) return NaN;
  return value / (FACTORS[name]?.(setting) ?? 1);
}

/** Ends of the slider of a field; `anchor` is a value of it that should stand in the middle. */
export function rangeOf(field, anchor) {
  if (RANGES[plain(field.path)]) return RANGES[plain(field.path)];
  const size = Math.abs(anchor ?? 0) || Math.abs(field.default ?? 0) || 1;
  const signed = ["start", "force"].includes(field.part) || field.name.startsWith("gap_offset");
  if (signed && field.group !== "frequency" && field.name !== "time") {
    return [rangeEnd(-2 * size), rangeEnd(2 * size), false];
  }
  if (field.name === "time") return [0, rangeEnd(4 * size), false];
  return [rangeEnd(size / 10), rangeEnd(size * 10), true];
}

function rangeEnd(value) {
  return Number(value.toPrecision(1));
}
