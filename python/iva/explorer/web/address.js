// The scene in the address: after the #, a short key and a number for every value.

import { Engine } from "./engine.js";
import { kindsOf, plain } from "./slots.js";

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
  kind: ["siva", "piva", "stop", "none"],
  angles: ["large", "small"],
  impact_law: ["consistent", "printed"],
  walls: ["both", "plus", "minus"],
};

/** The number before a name, with its point, and the name. */
function split(key) {
  const [, number = "", name] = /^(\d{1,2}\.)?(.*)$/.exec(key);
  return [number, name];
}

/**
 * The part of an address after the #; fields without a short key have their path, and in a list the number of their absorber or
 * force before it. What is fixed is in it but for records, which are too long.
 */
export function toAddress({ choices, values, fixed: { records, ...fixed } }) {
  const parts = Object.entries(choices).map(([name, word]) => `${name}=${word}`);
  for (const [path, value] of Object.entries(values)) {
    const [, number = ""] = /\.(\d+\.)/.exec(path) ?? [];
    parts.push(`${number}${KEYS[plain(path)] ?? plain(path)}=${value}`);
  }
  if (Object.keys(fixed).length) parts.push(`fixed=${encodeURIComponent(JSON.stringify(fixed))}`);
  return parts.join("&");
}

/** The scene of an address, or null if it holds none. The engine judges the values. */
export function fromAddress(text, fields) {
  const paths = new Map(fields.flatMap(({ path }) => [[path, path], [KEYS[path] ?? path, path]]));
  const scene = { choices: {}, values: {}, fixed: {} };
  for (const part of text.replace(/^#/, "").split("&")) {
    const [key, word = ""] = part.split("=");
    const [number, name] = split(key);
    const path = paths.get(name);
    if (Object.hasOwn(CHOICES, name) && CHOICES[name].includes(word)) scene.choices[key] = word;
    else if (path && word && Number.isFinite(Number(word))) scene.values[path.replace(".", `.${number}`)] = Number(word);
    else if (key === "fixed") {
      try {
        scene.fixed = JSON.parse(decodeURIComponent(word));
      } catch {
        // It is no text that this page has written.
      }
    }
  }
  const kinds = [...kindsOf(scene.choices)];
  if (!kinds.length || kinds.includes(undefined)) return null;
  try {
    // What is fixed in it may be anything.
    Engine.lines(scene);
    return scene;
  } catch {
    return null;
  }
}
