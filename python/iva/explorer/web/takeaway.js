// What one takes away: the scene as Python and as a study, a view as picture and as numbers.

import { Engine } from "./engine.js";
import { make } from "./format.js";
import { kindsOf } from "./slots.js";

/** As Python and TOML read it back: the shortest digits that give the same double. */
function literal(value, whole) {
  const text = String(value);
  return whole || /[.e]/.test(text) ? text : `${text}.0`;
}

/** A list, a name or a number of an entry; what is named in a table goes with the sign of the language. */
function entry(value, sign) {
  if (Array.isArray(value)) return `[${value.map((one) => entry(one, sign)).join(", ")}]`;
  if (value !== null && typeof value === "object") {
    return `{ ${Object.entries(value).map(([name, one]) => `${JSON.stringify(name)}${sign} ${entry(one, sign)}`).join(", ")} }`;
  }
  return typeof value === "string" ? JSON.stringify(value) : String(value);
}

const WHOLE = ["max_impacts", "max_work", "units"];

/** The fields of a part, in a list of that with this number; a start lists what each absorber has. */
function fieldsIn({ values }, part, number) {
  const prefix = number === undefined ? `${part}.` : `${part}.${number}.`;
  return Object.entries(values).map(([path, value]) => [path, path.slice(prefix.length), value])
    .filter(([path, name]) => path.startsWith(prefix) && !name.includes("."))
    .map(([, name, value]) => [name, literal(value, WHOLE.includes(name))]);
}

/** Absorbers with their words, fields and tables; forces with their fields. */
function partsOf(scene) {
  const kinds = kindsOf(scene.choices);
  const several = (count) => Array.from({ length: count }, (_, number) => (count > 1 ? number : undefined));
  const absorbers = several(kinds.length).map((number) => ({
    kind: kinds[number ?? 0],
    words: Object.entries(scene.choices).filter(([name]) => (number === undefined || name.startsWith(`${number}.`)) && !name.endsWith("kind"))
      .map(([name, word]) => [name.split(".").at(-1), `"${word}"`]),
    fields: fieldsIn(scene, "absorber", number),
    table: scene.fixed.tables?.[number ?? 0],
  }));
  const forces = several(Engine.forces(scene)).map((number) => ({
    record: scene.fixed.records?.[number ?? 0], fields: fieldsIn(scene, "force", number),
  }));
  const begun = {};
  for (const [number] of kinds.entries()) {
    for (const [name, text] of kinds.length > 1 ? fieldsIn(scene, "start", number) : []) {
      begun[name] ??= kinds.map(() => "0.0");
      begun[name][number] = text;
    }
  }
  const ofUnits = Object.entries(scene.fixed.starts ?? {}).map(([name, all]) => [name, all.map((number) => literal(number))]);
  const start = [...fieldsIn(scene, "start"), ...[...Object.entries(begun), ...ofUnits].map(([name, all]) => [name, `[${all.join(", ")}]`])];
  return { absorbers, forces, start, primary: fieldsIn(scene, "primary"), run: fieldsIn(scene, "run") };
}

/** A program that runs the scene and prints it. */
export function asPython(scene) {
  const { absorbers, forces, start, primary, run } = partsOf(scene);
  const call = (name, fields) => `iva.${name}(${fields.map(([field, text]) => `${field}=${text}`).join(", ")})`;
  const among = (all) => (all.length > 1 ? `[${all.join(", ")}]` : all[0]);
  const { structure = null } = scene.fixed;
  const entries = (all) => Object.entries(all).map(([name, value]) => [name, entry(value, ":")]);
  const absorber = ({ kind, words, fields, table }) => (kind === "none" ? "None" : call({ siva: "Siva", piva: "Piva", stop: "Stop" }[kind],
    [...words, ...fields, ...(table ? [["restitution_table", entry(table, ":")]] : [])]));
  const force = ({ record, fields }) => (record
    ? call("Recorded", [["times", entry(record.times)], ["values", entry(record.values)], ["kind", `"${record.kind}"`], ...fields])
    : call(fields.some(([name]) => ["velocity", "impulse"].includes(name)) ? "Impulse" : "Harmonic", fields));
  const lines = [
    among(absorbers.map(absorber)),
    structure ? call("Structure", entries(structure)) : call("Primary", primary),
    `start=${call("Start", start)}`,
    ...(forces.length ? [`force=${among(forces.map(force))}`] : []),
    ...run.map(([name, text]) => `${name}=${text}`),
  ];
  return `import iva\n\nrun = iva.simulate(\n${lines.map((line) => `    ${line},\n`).join("")})\nprint(run)\n`;
}

/** A study file of the scene, for `iva run`; a record is to be put beside it as a file. */
export function asStudy(scene) {
  const { absorbers, forces, start, primary, run } = partsOf(scene);
  const section = (head, fields) => (fields.length ? `\n${head}\n${fields.map(([name, text]) => `${name} = ${text}\n`).join("")}` : "");
  const structure = Object.entries(scene.fixed.structure ?? {}).map(([name, value]) => [name, entry(value, " =")]);
  const head = (name, all) => (all.length > 1 ? `[[${name}]]` : `[${name}]`);
  return [
    "version = 1\n", section("[primary]", primary), section("[structure]", structure),
    ...absorbers.map(({ kind, words, fields, table }) => section(head("absorber", absorbers), [
      ["kind", `"${kind}"`], ...words, ...fields, ...(table ? [["restitution_table", entry(table, "")]] : [])])),
    ...forces.map(({ record, fields }, index) => section(head("force", forces), [
      ...(record ? [["record", `"record_${index}.csv"`], ["kind", `"${record.kind}"`]] : []), ...fields])),
    section("[start]", start), section("[run]", run),
  ].join("");
}

/** Columns of numbers as text, to the last bit. */
export function asCsv(columns) {
  const names = Object.keys(columns);
  const rows = Math.max(0, ...names.map((name) => columns[name].length));
  const lines = [names.join(",")];
  for (let row = 0; row < rows; row += 1) {
    lines.push(names.map((name) => {
      const value = columns[name][row];
      return value === undefined || value === null || Number.isNaN(value) ? "" : String(value);
    }).join(","));
  }
  return `${lines.join("\n")}\n`;
}

/** Hands a file to the person before the page. */
export function save(name, content, type) {
  const blob = content instanceof Blob ? content : new Blob([content], { type });
  const address = URL.createObjectURL(blob);
  const link = make("a", { href: address, download: name });
  document.body.append(link);
  link.click();
  link.remove();
  // The browser reads the blob after this turn.
  setTimeout(() => URL.revokeObjectURL(address), 10_000);
}

/** Shows a text to be copied, and copies it where the browser lets a page do so. */
export function offer(root, title, text, fileName, type) {
  const area = make("textarea", { readOnly: true, value: text, spellcheck: false, "aria-label": title });
  area.rows = Math.min(24, text.split("\n").length + 1);
  const told = make("span", { role: "status", class: "told" });
  const copy = async () => {
    area.select();
    try {
      await navigator.clipboard.writeText(text);
    } catch {
      // Pages from a disk and in frames may not write to the clipboard; the old command often may.
      if (!document.execCommand("copy")) {
        told.textContent = "The browser does not let this page copy: press Ctrl-C.";
        return;
      }
    }
    told.textContent = "Copied.";
  };
  const dialog = make("dialog", { "aria-label": title },
    make("h2", {}, title),
    area,
    make("div", { class: "buttons" },
      make("button", { type: "button", onclick: copy }, "Copy"),
      make("button", { type: "button", onclick: () => save(fileName, text, type) }, "Save as file"),
      make("button", { type: "button", onclick: () => dialog.close() }, "Close"),
      told));
  dialog.addEventListener("close", () => dialog.remove());
  root.append(dialog);
  dialog.showModal();
  copy();
}
