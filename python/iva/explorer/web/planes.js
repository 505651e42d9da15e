// The phase plane, and where the energy is and has gone.

import { View, aroundZero, extent } from "./plot.js";
import { energiesOf, sampleAt } from "./motion.js";
import { make, shown, withUnit } from "./format.js";

/** What the phase plane shows: words, the two columns, symbols, and the colour of the line. */
const STRUCTURE = ["Structure", "displacement", "velocity", "x", "ẋ", "structure"];
const GAP = ["Gap", "gap_displacement", "gap_velocity", "y", "w", "absorber"];

export function phaseView(redraw) {
  /** The place of the absorber whose gap is shown; −1 for the structure. */
  let plane = -1;
  const choice = make("select", {
    "aria-label": "Phase plane of",
    onchange: () => {
      plane = Number(choice.value);
      redraw();
    },
  });
  const chosen = ({ kind, absorbers, path }) => (plane < 0 || kind === "none" ? [...STRUCTURE, path]
    : [...GAP, (absorbers[plane] ?? absorbers[0]).path]);

  function draw(plot, data) {
    const labels = [STRUCTURE[0], ...data.absorbers.map(({ label }) => `Gap${label}`)];
    if (choice.dataset.labels !== labels.join()) {
      choice.dataset.labels = labels.join();
      choice.replaceChildren(...labels.map((label, index) => make("option", { value: String(index - 1) }, label)));
      choice.value = String(plane);
    }
    const [, first, second, x, v, colour, path] = chosen(data);
    const [length, speed] = [data.drawn("Length"), data.drawn("Velocity")];
    const [low, high] = extent(path[first]);
    const [slow, fast] = extent(path[second]);
    plot.axes({
      x: aroundZero(length.factor * Math.max(-low, high)), y: aroundZero(speed.factor * Math.max(-slow, fast)),
      xLabel: `${x} (${length.unit})`, yLabel: `${v} (${speed.unit})`,
    });
    plot.inside((c) => {
      c.globalAlpha = 0.75;
      const ys = path[second];
      c.beginPath();
      for (let index = 0; index < ys.length; index += 1) {
        c.lineTo(plot.x(path[first][index] * length.factor), plot.y(ys[index] * speed.factor));
      }
      c.strokeStyle = plot.colours[colour];
      c.lineWidth = 0.9;
      c.lineJoin = "bevel";
      c.stroke();
    });
  }

  function move(plot, data, instant) {
    const [, first, second, , , , path] = chosen(data);
    const index = sampleAt(path.time, instant);
    const [length, speed] = [data.drawn("Length"), data.drawn("Velocity")];
    plot.dot(path[first][index] * length.factor, path[second][index] * speed.factor, 4.5, plot.colours.accent);
  }

  return new View({
    name: "phase",
    title: "Phase plane",
    tools: [choice],
    draw,
    move,
    columns: (data) => {
      const [, first, second, , , , path] = chosen(data);
      return { time: path.time, [first]: path[first], [second]: path[second] };
    },
    describe: (data) => {
      const [label, first, second, , , , path] = chosen(data);
      const [length, speed] = [data.drawn("Length"), data.drawn("Velocity")];
      const end = path.time.length - 1;
      return `Phase plane, ${label.toLowerCase()}; at the end `
        + `${withUnit(path[first][end] * length.factor, length.unit)} and `
        + `${withUnit(path[second][end] * speed.factor, speed.unit)}`;
    },
  });
}

function drawEnergies(plot, data) {
  const { run, path, drawn, forced, kind, modal, absorbers } = data;
  const { structure, absorber, lost } = energiesOf(data);
  const { colours, context: c } = plot;
  const start = run.summary.energy_initial;
  // With work done from outside, what is missing at the top is no loss of the damper.
  const closed = !forced && !(Math.abs(run.summary.energy_work) > 0);
  const both = structure.map((value, index) => value + (absorber ? absorber[index] : 0));
  const scale = closed && start > 0 ? 1 / start : 1;
  plot.axes({
    x: [path.time[0], path.time[path.time.length - 1]],
    y: [0, closed && start > 0 ? 1 : (1.05 * extent(both)[1] || 1)],
    xLabel: `time t (${drawn("Time").unit})`, yLabel: scale === 1 ? `energy (${drawn("Energy").unit})` : "E/E(0)",
    zero: false,
  });
  const area = (lower, upper, colour) => {
    c.beginPath();
    for (let index = 0; index < path.time.length; index += 1) {
      c.lineTo(plot.x(path.time[index]), plot.y(upper(index) * scale));
    }
    for (let index = path.time.length - 1; index >= 0; index -= 1) {
      c.lineTo(plot.x(path.time[index]), plot.y(lower(index) * scale));
    }
    c.fillStyle = colour;
    c.fill();
  };
  plot.inside(() => {
    if (closed) {
      area((index) => start - lost[index], () => start, colours.plus);
      area((index) => both[index], (index) => start - lost[index], colours.damper);
    }
    area((index) => structure[index], (index) => both[index], colours.absorber);
    area(() => 0, (index) => structure[index], colours.spring);
  });
  const { width, box } = plot;
  const all = kind === "none" ? ["structure"] : modal ? ["all"] : ["structure", absorbers.length > 1 ? "absorbers" : "absorber"];
  const takes = ["damper", run.summary.energy_pivot && (absorbers.some((one) => one.kind === "piva") ? "pivot" : "dashpot"), run.summary.energy_friction && "friction"];
  const names = closed ? [...all, takes.filter(Boolean).join(", "), ...(kind === "none" ? [] : ["impacts"])] : all;
  const swatch = { structure: colours.spring, all: colours.spring, absorber: colours.absorber, absorbers: colours.absorber, impacts: colours.plus };
  let x = box.right - 6;
  for (const name of names.reverse()) {
    c.font = "11px system-ui, sans-serif";
    const wide = c.measureText(name).width;
    c.fillStyle = colours.panel;
    c.globalAlpha = 0.8;
    c.fillRect(x - wide - 17, box.top + 3, wide + 19, 15);
    c.globalAlpha = 1;
    plot.text(name, x, box.top + 11, colours.text, "right");
    c.fillStyle = swatch[name] ?? colours.damper;
    c.fillRect(x - wide - 13, box.top + 6, 9, 9);
    x -= wide + 22;
    if (x < width * 0.2) break;
  }
}

export function energyView() {
  return new View({
    name: "energy",
    title: "Energy",
    draw: drawEnergies,
    move: (plot, data, instant) => {
      plot.context.strokeStyle = plot.colours.accent;
      plot.context.lineWidth = 1;
      plot.stroke([[plot.x(instant), plot.box.top], [plot.x(instant), plot.box.bottom]]);
    },
    columns: (data) => {
      const { structure, absorber, lost } = energiesOf(data);
      return {
        time: data.path.time, structure, ...(absorber ? { absorber } : {}), lost_in_impacts: lost,
      };
    },
    describe: ({ run: { summary }, drawn }) =>
      `Energy over time: ${withUnit(summary.energy_initial, drawn("Energy").unit)} at the start, `
      + `${shown(summary.energy_impacts)} lost in impacts, ${shown(summary.energy_viscous)} in the damper, `
      + `${shown(summary.energy_final)} left`,
  });
}
