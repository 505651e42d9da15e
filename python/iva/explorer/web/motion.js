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
 * Energies of structure and absorber at the samples, and what impacts have taken until then; `absorber` is null where there
 * is none.
 */
export function energiesOf({ run, scene }) {
  const { trajectory: path, energies } = run;
  const { mass, natural } = settingOf(scene.values);
  const count = path.time.length;
  const structure = new Float64Array(count);
  const absorber = scene.choices.kind === "none" ? null : new Float64Array(count);
  const lost = new Float64Array(count);
  const taken = losses(run);
  let sum = 0;
  let event = 0;
  for (let index = 0; index < count; index += 1) {
    const [time, x, v] = [path.time[index], path.displacement[index], path.velocity[index]];
    structure[index] = 0.5 * mass * (v * v + natural * natural * x * x);
    if (absorber) absorber[index] = energies.total[index] - structure[index];
    // An impact has two samples: before it the loss has not yet happened.
    while (event < taken.length && (taken[event][0] < time
      || (taken[event][0] === time && path.time[index - 1] === time))) {
      sum += taken[event][1];
      event += 1;
    }
    lost[index] = sum;
  }
  return { structure, absorber, lost };
}

/** Instants and energies of all losses in impacts: those that are listed, and the sums of those that are not. */
function losses({ impacts, episodes }) {
  const listed = Array.from(impacts.time, (time, index) => [time, impacts.energy_loss[index]]);
  const summed = Array.from(episodes.stick_time, (end, index) => {
    const start = episodes.start_time[index];
    const within = listed.filter(([time]) => time >= start && time <= end);
    return [end, Math.max(0, within.reduce((rest, [, loss]) => rest - loss, episodes.energy_loss[index]))];
  });
  return [...listed, ...summed].sort(([a], [b]) => a - b);
}
