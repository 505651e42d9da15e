// The numbers of a run beside those of the structure alone.

import { make, shown, unitText } from "./format.js";

/** Those that are seen at once; the others are under "All numbers". */
const FIRST = [
  "settling_time_10", "settling_time_5", "settling_time_2", "damping_ratio_3", "residual_amplitude",
  "amplitude_max", "reduction", "transmissibility", "impacts", "episodes", "approach_speed_max",
];

export function measureWords(name) {
  const [, percent] = /^settling_time_(\d+)$/.exec(name) ?? [];
  if (percent) return `${percent} % settling time`;
  const [, cycles] = /^damping_ratio_(\d+)$/.exec(name) ?? [];
  if (cycles) return `damping ratio, ${cycles} ${cycles === "1" ? "cycle" : "cycles"}`;
  return { episodes: "stays on a wall", amplitude_max: "largest |x|" }[name] ?? name.replaceAll("_", " ");
}

function row(measure, { run, alone, units }) {
  const value = run.summary[measure.name];
  const unit = unitText(measure.units[units]);
  const said = (number) => (typeof number === "string" ? number : shown(number));
  return make("tr", { title: `${measure.name}: ${measure.help}` },
    make("th", { scope: "row" }, measureWords(measure.name), unit ? make("small", {}, ` ${unit}`) : ""),
    make("td", {}, said(value)), make("td", {}, alone ? said(alone.summary[measure.name]) : ""));
}

/** A table of measures; one that is null everywhere is left out of the first ones. */
export function measureTable(measures, data) {
  const known = (measure) => [data.run.summary, data.alone?.summary ?? {}].some(
    (summary) => summary[measure.name] !== null && summary[measure.name] !== undefined,
  );
  const head = () => make("thead", {}, make("tr", {}, make("td", {}), make("th", { scope: "col" }, "now"),
    make("th", { scope: "col" }, data.alone ? "alone" : "")));
  const body = (list) => make("tbody", {}, ...list.map((measure) => row(measure, data)));
  const first = measures.filter((measure) => FIRST.includes(measure.name) && known(measure));
  const rest = measures.filter((measure) => !first.includes(measure) && known(measure));
  return make("div", {}, make("table", {}, make("caption", {}, "Measures"), head(), body(first)),
    make("details", {}, make("summary", {}, "All numbers"), make("table", {}, head(), body(rest))));
}
