// Reading a run: states between samples, runs of events, energies of the parts.

import { settingOf } from "./slots.js";

/** Index of the last sample at or before an instant. */
export function sampleAt(times, instant) {
  let low = 0;
  let high = times.length - 1;
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (times[middle] <= instant) low = middle;
    else high = middle - 1;
  }
  return low;
}

/** A cubic through two samples and their slopes; for the moving drawing, numbers shown are samples. */
function between(times, values, slopes, index, instant) {
  const step = times[index + 1] - times[index];
  if (index + 1 >= times.length || !(step > 0)) return values[index];
  const s = (instant - times[index]) / step;
  const [a, b] = [values[index], values[index + 1]];
  const [p, q] = [slopes[index] * step, slopes[index + 1] * step];
  return a + s * (p + s * (3 * (b - a) - 2 * p - q + s * (2 * (a - b) + p + q)));
}

/** Where structure and absorber are at an instant. */
export function stateAt(trajectory, instant) {
  const index = sampleAt(trajectory.time, instant);
  const read = (values, slopes) =>
    (values ? between(trajectory.time, values, slopes, index, instant) : NaN);
  return {
    index,
    x: read(trajectory.displacement, trajectory.velocity),
    y: read(trajectory.gap_displacement, trajectory.gap_velocity),
    angle: trajectory.angle ? read(trajectory.angle, trajectory.angular_velocity) : NaN,
    wall: trajectory.wall ? trajectory.wall[index] : 0,
  };
}

/** How bright a wall is at an instant: full at an impact, dark a quarter period later. */
export function lights(impacts, instant, period) {
  const light = { 1: 0, "-1": 0 };
  if (!impacts.time.length) return light;
  for (let index = sampleAt(impacts.time, instant); index >= 0; index -= 1) {
    const age = (instant - impacts.time[index]) / (0.25 * period);
    if (age > 1) break;
    if (age >= 0) light[impacts.wall[index]] = Math.max(light[impacts.wall[index]], 1 - age);
  }
  return light;
}

/** Whether a force lasts, so that nothing decays by itself. */
export function isForced(scene) {
  return ["force.amplitude", "force.force", "force.base_acceleration"].some(
    (path) => scene.values[path] !== undefined,
  );
}

/**
 * Energies of structure and absorber at the samples, and what impacts have taken until then;
 * `absorber` is null where there is none. `lowest` is where the lower stop is.
 */
export function energiesOf({ run, scene, lowest }) {
  const { trajectory: path, impacts } = run;
  const { mass, natural } = settingOf(scene.values);
  const ratio = ratioOf(scene, mass);
  const count = path.time.length;
  const structure = new Float64Array(count);
  const absorber = ratio === null ? null : new Float64Array(count);
  const lost = new Float64Array(count);
  const above = overMass(run, scene, natural, lowest);
  let taken = 0;
  let event = 0;
  for (let index = 0; index < count; index += 1) {
    const [x, v] = [path.displacement[index], path.velocity[index]];
    structure[index] = 0.5 * mass * (v * v + natural * natural * x * x);
    if (absorber) absorber[index] = ratio * mass * above(index, v);
    // An impact has two samples: before it the loss has not yet happened.
    while (event < impacts.time.length && (impacts.time[event] < path.time[index]
      || (impacts.time[event] === path.time[index] && path.time[index - 1] === path.time[index]))) {
      taken += impacts.energy_loss[event];
      event += 1;
    }
    lost[index] = taken;
  }
  return { structure, absorber, lost };
}

function ratioOf(scene, mass) {
  if (scene.choices.kind === "none") return null;
  return scene.values["absorber.mass_ratio"] ?? scene.values["absorber.mass"] / mass;
}

/** Energy of the absorber over its mass, from a sample and the velocity of the structure. */
function overMass(run, scene, natural, lowest) {
  const { trajectory: path, summary } = run;
  const value = (name, otherwise) => scene.values[`absorber.${name}`] ?? otherwise;
  const gravity = summary.gravity ?? 0;
  if (scene.choices.kind === "siva") {
    const rise = value("inclination", (value("inclination_deg", 0) * Math.PI) / 180);
    return (index, v) => {
      const y = path.gap_displacement[index];
      return 0.5 * (v + path.gap_velocity[index]) ** 2 + gravity * Math.sin(rise) * (y - lowest);
    };
  }
  const inertia = value("inertia_ratio", 1);
  const arm = value("contact_distance", NaN);
  const spring = (value("spring_ratio", 0) * natural) ** 2;
  const turning = value("frequency_ratio", NaN) * natural;
  const length = value("length", Number.isNaN(turning) || !gravity ? 1 : gravity / (inertia * turning ** 2));
  const lever = Number.isNaN(arm) ? 1 : length / arm;
  const small = scene.choices.angles === "small";
  const own = Number.isNaN(turning) ? Math.sqrt(gravity / (inertia * length)) : turning;
  return (index, v) => {
    if (small) {
      const [q, r] = [lever * path.gap_displacement[index], lever * path.gap_velocity[index]];
      return 0.5 * ((v + r) ** 2 + (inertia - 1) * r * r + inertia * (own ** 2 + spring) * q * q);
    }
    const angle = path.angle[index];
    const [along, across] = [Math.cos(angle), Math.sin(angle)];
    const speed = length * path.angular_velocity[index];
    return 0.5 * ((v + along * speed) ** 2 + (across * speed) ** 2 + (inertia - 1) * speed ** 2)
      + gravity * length * (1 - along) + 0.5 * inertia * spring * (length * angle) ** 2;
  };
}
