// What one takes away: the scene as Python and as a study, a view as picture and as numbers.

import { make } from "./format.js";

/** As Python and TOML read it back: the shortest digits that give the same double. */
function literal(value, whole) {
  const text = String(value);
  return whole || /[.e]/.test(text) ? text : `${text}.0`;
}

function partsOf(scene) {
  const parts = { primary: [], absorber: [], force: [], start: [], run: [] };
  for (const [path, value] of Object.entries(scene.values)) {
    const [part, name] = path.split(".");
    parts[part].push([name, literal(value, name === "max_impacts" || name === "max_work")]);
  }
  return parts;
}

function words(scene, form) {
  return Object.entries(scene.choices)
    .filter(([name]) => name !== "kind" && scene.choices.kind === "piva")
    .map(([name, word]) => form(name, `"${word}"`));
}

/** A program that runs the scene and prints it. */
export function asPython(scene) {
  const parts = partsOf(scene);
  const argument = (name, text) => `${name}=${text}`;
  const call = (name, part, more = []) =>
    `iva.${name}(${[...parts[part].map(([field, text]) => argument(field, text)), ...more].join(", ")})`;
  const { kind } = scene.choices;
  const absorber = kind === "none" ? "None"
    : call(kind === "piva" ? "Piva" : "Siva", "absorber", words(scene, argument));
  const blow = parts.force.some(([name]) => ["velocity", "impulse"].includes(name));
  const lines = [
    absorber,
    call("Primary", "primary"),
    `start=${call("Start", "start")}`,
    ...(parts.force.length ? [`force=${call(blow ? "Impulse" : "Harmonic", "force")}`] : []),
    ...parts.run.map(([name, text]) => argument(name, text)),
  ];
  return `import iva\n\nrun = iva.simulate(\n${lines.map((line) => `    ${line},\n`).join("")})\nprint(run)\n`;
}

/** A study file of the scene, for `iva run`. */
export function asStudy(scene) {
  const parts = partsOf(scene);
  const line = (name, text) => `${name} = ${text}`;
  const chosen = [line("kind", `"${scene.choices.kind}"`), ...words(scene, line)];
  const sections = Object.entries(parts).map(([part, fields]) => {
    const lines = [...(part === "absorber" ? chosen : []), ...fields.map(([name, text]) => line(name, text))];
    return lines.length ? `\n[${part}]\n${lines.join("\n")}\n` : "";
  });
  return `version = 1\n${sections.join("")}`;
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
