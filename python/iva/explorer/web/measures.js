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

/** A table of measures; those that no run has are left out. It is made anew only if these change. */
export class MeasureTable {
  constructor(measures) {
    this.measures = measures;
    this.element = make("div", { class: "measures" });
    this.made = "";
    this.open = false;
  }

  show(data) {
    const summaries = [data.run.summary, data.alone?.summary ?? {}];
    const known = this.measures.filter(({ name }) => summaries.some(
      (summary) => summary[name] !== null && summary[name] !== undefined,
    ));
    const key = JSON.stringify([known.map(({ name }) => name), data.units, data.alone !== null]);
    if (this.made !== key) {
      this.made = key;
      this.build(known, data);
    }
    for (const { name, cells } of this.rows) {
      cells.forEach((cell, index) => {
        const value = summaries[index][name];
        const text = index && !data.alone ? "" : typeof value === "string" ? value : shown(value);
        if (cell.textContent !== text) cell.textContent = text;
      });
    }
  }

  build(known, data) {
    this.rows = [];
    const first = FIRST.map((name) => known.find((measure) => measure.name === name)).filter(Boolean);
    const rest = known.filter((measure) => !first.includes(measure));
    const table = (list, caption) => make("table", {}, caption && make("caption", {}, caption),
      make("thead", {}, make("tr", {}, make("td", {}), make("th", { scope: "col" }, "now"),
        make("th", { scope: "col" }, data.alone ? "alone" : ""))),
      make("tbody", {}, ...list.map((measure) => this.row(measure, data.units))));
    const more = make("details", { open: this.open, ontoggle: () => { this.open = more.open; } },
      make("summary", {}, "All numbers"), table(rest, null));
    this.element.replaceChildren(table(first, "Measures"), more);
  }

  row(measure, units) {
    const unit = unitText(measure.units[units]);
    const cells = [make("td"), make("td")];
    this.rows.push({ name: measure.name, cells });
    return make("tr", { title: `${measure.name}: ${measure.help}` },
      make("th", { scope: "row" }, measureWords(measure.name), unit ? make("small", {}, ` ${unit}`) : ""), ...cells);
  }
}
