// Reading a run: states between samples, runs of events, energies of the parts.

import { kindsOf, plain } from "./slots.js";

/** Pictures of absorbers that a page has at most. */
const MOST_SHOWN = 8;

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

/** The rows of a table that are of one absorber of several. */
export function rowsOf(table, number, count) {
  if (!table || count < 2) return table;
  const kept = [];
  for (let row = 0; row < table.absorber.length; row += 1) if (table.absorber[row] === number) kept.push(row);
  const of = (values) => {
    const own = new Float64Array(kept.length);
    for (let index = 0; index < own.length; index += 1) own[index] = values[kept[index]];
    return own;
  };
  return Object.fromEntries(Object.entries(table).map(([name, values]) => [name, of(values)]));
}

/** The motion of a point of a structure with modes; that which the run sees of one without. */
export function pointOf({ run }, point, path) {
  const displacement = run.points[point];
  return displacement ? { time: run.samples.time, displacement, velocity: run.point_velocities[point] } : path;
}

/** What is seen of a structure with modes: the point of its curves, and its points from the lowest to the highest; null of one without. */
export function modalOf({ fixed: { structure }, absorbers }) {
  if (!structure) return null;
  const { points, seen_at: at, seen_mode: mode, natural_mode: natural = 1 } = structure;
  const named = Array.isArray(points) ? points : typeof points === "string" ? [points] : Object.keys(points);
  const seen = at ?? absorbers[0]?.point ?? named[0];
  // A point that moves more in the natural mode is drawn higher; coordinates of matrices as they are listed.
  const size = (point) => Math.abs(points[point][natural - 1]);
  return {
    seen: mode ? `${seen}, mode ${mode}` : seen,
    points: Array.isArray(points) || typeof points === "string" ? named : named.sort((a, b) => size(a) - size(b)),
    free: (structure.frequencies ?? structure.frequencies_hz ?? []).includes(0),
  };
}

/** What there is to be drawn of each absorber; of a structure alone one that is none. */
export function absorbersOf(state, run) {
  const { choices, values } = state.scene;
  const kinds = kindsOf(choices);
  if (kinds[0] === "none") {
    return [{ kind: "none", label: "", clearance: NaN, offset: 0, y0: NaN, path: run.trajectory, at: run.trajectory, has: {}, impacts: run.impacts, episodes: run.episodes }];
  }
  const count = state.absorbers.length;
  return state.absorbers.slice(0, MOST_SHOWN).map(({ owner, point, walls }, place) => {
    const kind = kinds[owner];
    const value = (name) => values[state.keyOf(owner, "absorber", name)];
    const path = rowsOf(run.trajectory, place, count);
    // A wall that is not there leaves the length as it is given.
    const both = walls.every((wall) => wall !== null);
    const clearance = both ? (walls[1] - walls[0]) / 2 : state.held(state.keyOf(owner, "absorber", "clearance"));
    const length = value("length");
    const arm = value("contact_distance") ?? length ?? 4 * clearance;
    return {
      kind, owner, point, clearance, arm, path, at: pointOf({ run }, point, path), y0: path.gap_displacement[0],
      offset: both ? (walls[1] + walls[0]) / 2 : walls[1] === null ? walls[0] + clearance : walls[1] - clearance,
      has: { 1: walls[1] !== null, "-1": walls[0] !== null },
      lever: length === undefined ? 1 : length / arm,
      tied: ["spring", "spring_ratio", "gap_damping", "gap_damping_ratio"].some((name) => kind === "siva" && value(name) > 0),
      impacts: rowsOf(run.impacts, place, count), episodes: rowsOf(run.episodes, place, count),
      label: count > 1 ? ` ${place}${point ? ` at ${point}` : ""}` : point ? ` at ${point}` : "",
    };
  });
}

/** Where structure and absorber are at an instant. */
export function stateAt({ path, at }, instant) {
  const read = (table, name, slope) => {
    const values = table[name];
    return values ? between(table.time, values, table[slope], sampleAt(table.time, instant), instant) : NaN;
  };
  return {
    x: read(at, "displacement", "velocity"),
    y: read(path, "gap_displacement", "gap_velocity"),
    angle: read(path, "angle", "angular_velocity"),
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
export function isForced({ values, fixed }) {
  return fixed.records !== undefined
    || Object.keys(values).some((path) => /^force\.(amplitude|force|base_)/.test(plain(path)));
}

/**
 * Energies of structure and absorbers at the samples, and what impacts have taken until then; `absorber` is null where there
 * is none, and where the structure has several modes, whose energy then has all in it.
 */
export function energiesOf({ run, path, kind, modal, setting: { mass, natural } }) {
  const count = path.time.length;
  const structure = new Float64Array(count);
  const absorber = kind === "none" || modal ? null : new Float64Array(count);
  const lost = new Float64Array(count);
  const taken = losses(run);
  let sum = 0;
  let event = 0;
  for (let index = 0; index < count; index += 1) {
    const [time, x, v] = [path.time[index], path.displacement[index], path.velocity[index]];
    structure[index] = modal ? path.energy[index] : 0.5 * mass * (v * v + natural * natural * x * x);
    if (absorber) absorber[index] = path.energy[index] - structure[index];
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
