// The scene in the address: after the #, a short key and a number for every value.

const KEYS = {
  "primary.damping_ratio": "z", "primary.damping": "c", "primary.natural_frequency": "w",
  "primary.frequency_hz": "fn", "primary.stiffness": "k", "primary.mass": "M",
  "absorber.mass_ratio": "mu", "absorber.mass": "m", "absorber.restitution": "e",
  "absorber.restitution_minus": "em", "absorber.relative_clearance": "g", "absorber.clearance": "d",
  "absorber.clearance_mm": "dmm", "absorber.gap": "gap", "absorber.gap_mm": "gapmm",
  "absorber.gap_offset": "o", "absorber.gap_offset_mm": "omm", "absorber.frequency_ratio": "r",
  "absorber.length": "l", "absorber.inclination": "i", "absorber.inclination_deg": "ideg",
  "absorber.gravity": "gr", "force.amplitude": "fa", "force.force": "ff",
  "force.base_acceleration": "fb", "force.frequency": "W", "force.relative_frequency": "R",
  "force.frequency_hz": "fh", "force.phase": "ph", "start.displacement": "x",
  "start.displacement_mm": "xmm", "start.velocity": "v", "start.gap_displacement": "y",
  "start.gap_velocity": "u", "run.periods": "n", "run.duration": "T", "run.cycles": "nc",
  "run.discard": "nd",
};

/** What choices there may be; anything else in an address is ignored. */
const CHOICES = {
  kind: ["siva", "piva", "none"],
  angles: ["large", "small"],
  impact_law: ["consistent", "printed"],
};

/** The part of an address after the #; fields without a short key have their path. */
export function toAddress(scene) {
  const parts = Object.entries(scene.choices).map(([name, word]) => `${name}=${word}`);
  for (const [path, value] of Object.entries(scene.values)) parts.push(`${KEYS[path] ?? path}=${value}`);
  return parts.join("&");
}

/** The scene of an address, or null if it holds none. The engine judges the values. */
export function fromAddress(text, fields) {
  const paths = new Map([...fields.keys()].map((path) => [path, path]));
  for (const [path, key] of Object.entries(KEYS)) if (fields.has(path)) paths.set(key, path);
  const scene = { choices: { kind: "siva" }, values: {} };
  let found = false;
  for (const part of text.replace(/^#/, "").split("&")) {
    const [key, word] = part.split("=");
    if (Object.hasOwn(CHOICES, key) && CHOICES[key].includes(word)) {
      scene.choices[key] = word;
      found ||= key === "kind";
    } else if (paths.has(key) && word && Number.isFinite(Number(word))) {
      scene.values[paths.get(key)] = Number(word);
    }
  }
  return found ? scene : null;
}
