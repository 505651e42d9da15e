// x(t) with envelope and impacts, and y(t) between the walls.

import { View, aroundZero, extent } from "./plot.js";
import { pointOf, sampleAt, stateAt } from "./motion.js";
import { shown, withUnit } from "./format.js";

function timeAxis({ path: { time: times } }) {
  return [times[0], times[times.length - 1]];
}

/** A vertical line at the instant. */
function cursor(plot, instant, factor = 1) {
  const { context: c, box, colours } = plot;
  c.strokeStyle = colours.accent;
  c.lineWidth = 1;
  plot.stroke([[plot.x(instant * factor), box.top], [plot.x(instant * factor), box.bottom]]);
}

/** Ticks for impacts: wall + above, wall − below. */
function impactTicks(plot, impacts) {
  const { context: c, box, colours } = plot;
  c.lineWidth = 1.4;
  for (const [wall, from, to] of [[1, box.top, box.top + 7], [-1, box.bottom, box.bottom - 7]]) {
    c.strokeStyle = wall > 0 ? colours.plus : colours.minus;
    c.beginPath();
    for (let index = 0; index < impacts.time.length; index += 1) {
      if (impacts.wall[index] !== wall) continue;
      const x = plot.x(impacts.time[index]);
      c.moveTo(x, from);
      c.lineTo(x, to);
    }
    c.stroke();
  }
}

const SETTLED = [["settling_time_10", 0.1, "10 %"], ["settling_time_5", 0.05, ""], ["settling_time_2", 0.02, ""]];

function drawDisplacement(plot, data) {
  const { run, path, drawn, alone, forced, showAlone } = data;
  const { factor, unit } = drawn("Length");
  const { colours } = plot;
  const others = otherPoints(data);
  const [low, high] = extent(path.displacement, ...others.map(([, { displacement }]) => displacement), ...(alone && showAlone ? [alone.displacement] : []));
  plot.axes({
    x: timeAxis(data), y: aroundZero(factor * Math.max(-low, high)),
    xLabel: `time t (${drawn("Time").unit})`, yLabel: `x (${unit})`,
  });
  plot.inside(() => {
    if (alone && showAlone) plot.line(alone.time, alone.displacement, colours.alone, 1, factor);
    if (!forced) settlingLines(plot, data, factor);
    const peaks = run.envelope;
    if (peaks.time.length > 1 && !forced) {
      const sizes = peaks.displacement.map(Math.abs);
      plot.line(peaks.time, sizes, colours.quiet, 0.8, factor);
      plot.line(peaks.time, sizes, colours.quiet, 0.8, -factor);
    }
    others.forEach(([point, { time, displacement }], index) => {
      const colour = [colours.absorber, colours.damper, colours.spring][index % 3];
      plot.line(time, displacement, colour, 1, factor);
      plot.text(point, plot.box.right - 3, plot.box.bottom - 14 - 13 * index, colour, "right");
    });
    plot.line(path.time, path.displacement, colours.structure, 1.5, factor);
    if (!forced) {
      for (const [name, level] of SETTLED) {
        const time = run.summary[name];
        if (time === null || time === undefined) continue;
        const x = path.displacement[sampleAt(path.time, time)];
        plot.dot(time, Math.sign(x || 1) * level * data.reference * factor, 3.5, colours.structure);
      }
    }
    impactTicks(plot, run.impacts);
  });
}

/** The points of absorbers on a structure with modes that are not the one which the run sees. */
function otherPoints(data) {
  const points = new Set(data.absorbers.map(({ point }) => point).filter((point) => point && point !== data.modal?.seen));
  return [...points].map((point) => [point, pointOf(data, point, data.path)]);
}

function settlingLines(plot, { reference }, factor) {
  const { colours, box } = plot;
  for (const [, level, label] of SETTLED.slice(0, 1)) {
    for (const side of [1, -1]) plot.level(side * level * reference * factor, colours.quiet);
    plot.text(`±${label}`, box.right - 3, plot.y(level * reference * factor) - 7, colours.quiet, "right");
  }
}

function moveDisplacement(plot, { path, drawn }, instant) {
  const { factor } = drawn("Length");
  cursor(plot, instant);
  plot.dot(instant, factor * stateAt({ path, at: path }, instant).x, 4, plot.colours.accent);
}

export function displacementView() {
  return new View({
    name: "displacement",
    title: "Structure x(t)",
    draw: drawDisplacement,
    move: moveDisplacement,
    columns: ({ path }) => ({
      time: path.time, displacement: path.displacement, velocity: path.velocity,
      ...(path.acceleration ? { acceleration: path.acceleration } : {}),
    }),
    describe: ({ run, path, drawn }) => {
      const { factor, unit } = drawn("Length");
      const [low, high] = extent(path.displacement);
      const settles = run.summary.settling_time_5;
      const told = settles === null || settles === undefined ? ""
        : `, below 5 percent from ${withUnit(settles, drawn("Time").unit)} on`;
      return `Displacement of the structure over time, from ${shown(low * factor)} to `
        + `${withUnit(high * factor, unit)}, ${run.summary.impacts} impacts${told}`;
    },
  });
}

function drawGap(plot, data, { path, impacts, episodes, clearance, offset, has }) {
  const { factor, unit } = data.drawn("Length");
  const { colours, context: c } = plot;
  const [low, high] = extent(path.gap_displacement);
  const reach = clearance < 3 * Math.max(high - offset, offset - low) ? clearance : 0;
  const top = (has[1] ? Math.max(high, offset + reach) : high) * factor;
  const bottom = (has[-1] ? Math.min(low, offset - reach) : low) * factor;
  const room = 0.08 * (top - bottom || 1);
  plot.axes({
    x: timeAxis(data), y: [bottom - room, top + room],
    xLabel: `time t (${data.drawn("Time").unit})`, yLabel: `y (${unit})`,
  });
  plot.inside(() => {
    for (const wall of [1, -1]) {
      if (!has[wall]) continue;
      c.fillStyle = wall > 0 ? colours.plus : colours.minus;
      const at = plot.y((offset + wall * clearance) * factor);
      // Behind a wall is nothing to be seen of the absorber.
      c.globalAlpha = 0.14;
      c.fillRect(plot.box.left, at, plot.box.right - plot.box.left, -wall * 1000);
      c.globalAlpha = 1;
      c.fillRect(plot.box.left, at - 0.75, plot.box.right - plot.box.left, 1.5);
    }
    plot.line(path.time, path.gap_displacement, colours.absorber, 1.4, factor);
    c.lineWidth = 3.5;
    for (let index = 0; index < episodes.wall.length; index += 1) {
      const until = episodes.release_time[index];
      const to = Number.isFinite(until) && until !== null ? until : path.time[path.time.length - 1];
      const at = plot.y((offset + episodes.wall[index] * clearance) * factor);
      c.strokeStyle = colours.absorber;
      plot.stroke([[plot.x(episodes.stick_time[index]), at], [plot.x(to), at]]);
    }
    for (let index = 0; index < impacts.time.length; index += 1) {
      const wall = impacts.wall[index];
      const colour = wall > 0 ? colours.plus : colours.minus;
      plot.dot(impacts.time[index], (offset + wall * clearance) * factor, 2.6, colour);
    }
  });
}

/** The gap of the absorber at this place. */
export function gapView(place) {
  const of = (data) => data.absorbers[place];
  return new View({
    name: place ? `gap_${place}` : "gap",
    title: "Absorber in its gap y(t)",
    draw: (plot, data) => drawGap(plot, data, of(data)),
    move: (plot, data, instant) => {
      cursor(plot, instant);
      plot.dot(instant, data.drawn("Length").factor * stateAt(of(data), instant).y, 4, plot.colours.absorber);
    },
    columns: (data) => {
      const { path } = of(data);
      return { time: path.time, gap_displacement: path.gap_displacement, gap_velocity: path.gap_velocity, wall: path.wall };
    },
    describe: (data) => {
      const { clearance, offset, impacts, episodes } = of(data);
      const { factor, unit } = data.drawn("Length");
      const above = impacts.wall.filter((wall) => wall > 0).length;
      return `Gap displacement over time between walls at ${shown((offset - clearance) * factor)} and `
        + `${withUnit((offset + clearance) * factor, unit)}; ${above} impacts on wall plus, `
        + `${impacts.wall.length - above} on wall minus, ${episodes.wall.length} stays on a wall`;
    },
  });
}
