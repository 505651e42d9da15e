// A row for every quantity: a slider and a number, in a form that one can choose.

import { Engine } from "./engine.js";
import { clamp, freshId, make, rounded, shown, unitText } from "./format.js";
import { formsOf, isUsual, plain, rangeOf, wordsOf } from "./slots.js";
import { inForm } from "./units.js";

const STEPS = 400;
const SECTIONS = {
  absorber: "Absorber", primary: "Structure", start: "Start", force: "Excitation", run: "Run",
};

/** A row of one slot. It stays while the kind and the units do. */
class Row {
  constructor(explorer, slot) {
    this.explorer = explorer;
    this.slot = slot;
    this.id = freshId();
    this.anchor = undefined;
    this.label = make("label", { for: this.id });
    this.slider = make("input", {
      type: "range", min: "0", max: String(STEPS), step: "1",
      oninput: () => this.slide(), onchange: () => { explorer.last = { what: null, at: 0 }; },
    });
    this.number = make("input", {
      type: "text", id: this.id, inputMode: "decimal", autocomplete: "off", spellcheck: false,
      // What is being typed stays while another part of the page changes the scene.
      oninput: () => { this.typing = true; },
      onchange: () => {
        this.typing = false;
        explorer.type(this.field.path, this.number.value);
      },
      onblur: () => { this.typing = false; },
    });
    this.unit = make("span", { class: "unit" });
    this.form = make("select", { class: "form", onchange: () => this.reform() });
    this.told = make("p", { class: "wrong", role: "alert", id: `${this.id}w` });
    this.number.setAttribute("aria-describedby", this.told.id);
    this.element = make("div", { class: "row" }, this.label, this.slider,
      make("span", { class: "entry" }, this.number, this.unit, this.form), this.told);
  }

  slide() {
    const [low, high, byFactors] = this.range();
    const share = Number(this.slider.value) / STEPS;
    const value = byFactors ? low * (high / low) ** share : low + share * (high - low);
    const whole = ["max_impacts", "max_work", "cycles", "discard", "units"].includes(this.field.name);
    const short = whole ? Math.round(value) : rounded(value, Math.abs(value) < 1e-12 ? 1 : 3);
    const near = byFactors ? short : Number(short.toFixed(Math.max(0, 2 - Math.floor(Math.log10(high - low)))));
    this.explorer.edit(this.explorer.inSlot(this.field.path, near), `slide ${this.field.path}`);
  }

  range() {
    const [low, high, byFactors] = rangeOf(this.field, this.anchor);
    const value = this.explorer.values[this.field.path] ?? this.field.default ?? this.anchor;
    // What was typed beyond the ends widens them.
    const least = byFactors && !(value > 0) ? low : Math.min(low, value ?? low);
    return [least, Math.max(high, value ?? high), byFactors];
  }

  /** Gives the same in another form. */
  reform() {
    const { explorer, field } = this;
    const to = this.form.value;
    const value = explorer.values[field.path] ?? field.default;
    const carried = value === undefined || value === null ? NaN
      : inForm(field.path, value, to, explorer.setting);
    const next = Number.isFinite(carried) ? carried : explorer.fields.get(to).default ?? undefined;
    this.anchor = undefined;
    this.chosen = to;
    explorer.edit(explorer.inSlot(to, next), null);
  }

  show() {
    const { explorer, slot } = this;
    const forms = formsOf(slot, explorer.kinds, explorer.units);
    const given = forms.find((field) => explorer.values[field.path] !== undefined);
    this.field = given ?? forms.find((field) => field.path === this.chosen) ?? forms[0];
    const { path } = this.field;
    const value = explorer.values[path];
    const waiting = explorer.pending.get(path);
    const [words, symbol] = wordsOf(this.field);
    const unit = unitText(this.field.units[explorer.units]);
    if (this.worded !== `${path} ${unit}`) {
      this.worded = `${path} ${unit}`;
      this.label.replaceChildren(words, symbol ? make("i", {}, ` ${symbol}`) : "");
      this.label.title = `${path}: ${this.field.help}; ${this.field.allowed}`;
      this.unit.textContent = unit;
      this.number.setAttribute("aria-label", `${words}${unit ? `, ${unit}` : ""}`);
      this.slider.setAttribute("aria-label", words);
      this.showForms(forms);
    }
    if (this.anchor === undefined && value !== undefined) this.anchor = value;
    const held = value ?? this.field.default;
    const text = waiting ? waiting.text : value === undefined ? "" : String(value);
    if (!this.typing && this.number.value !== text) this.number.value = text;
    if (this.form.value !== path) this.form.value = path;
    const sentence = waiting ? waiting.sentence : "";
    if (this.sentence !== sentence) {
      this.sentence = sentence;
      this.number.setAttribute("aria-invalid", waiting ? "true" : "false");
      this.told.textContent = sentence;
    }
    // A slider that fails to move is moved back.
    const drawn = [path, value, held].join();
    if (this.drawn === drawn && !waiting) return;
    this.drawn = drawn;
    this.number.placeholder = held === undefined || held === null ? "not given" : String(held);
    this.slider.setAttribute("aria-valuetext", held === undefined || held === null ? "not given" : `${shown(held)} ${unit}`);
    const [low, high, byFactors] = this.range();
    const at = held === undefined || held === null ? 0.5
      : byFactors ? Math.log(Math.max(held, low) / low) / Math.log(high / low) : (held - low) / (high - low);
    this.slider.value = String(Math.round(STEPS * clamp(at, 0, 1)));
    this.element.classList.toggle("unset", value === undefined);
  }

  showForms(forms) {
    this.form.hidden = forms.length < 2;
    this.form.setAttribute("aria-label", `Form of ${wordsOf(this.field)[0]}`);
    const paths = forms.map((field) => field.path).join();
    if (this.form.dataset.paths !== paths) {
      this.form.dataset.paths = paths;
      this.form.replaceChildren(...forms.map((field) => make("option", { value: field.path, title: field.help },
        `${wordsOf(field)[1] || field.name} ${unitText(field.units[this.explorer.units])}`.trim())));
    }
    this.form.value = this.field.path;
  }
}

/** All rows, in sections; made anew where kind, units or excitation change. */
export class Controls {
  constructor(explorer) {
    this.explorer = explorer;
    this.element = make("div", { class: "fields" });
    this.made = "";
    this.open = new Set();
  }

  show() {
    const { explorer } = this;
    const sorts = Array.from({ length: Math.max(1, Engine.forces(explorer)) }, (_, force) => excitationOf(explorer, force));
    const key = [JSON.stringify(explorer.choices), explorer.units, sorts, isRising(explorer.values)].join();
    if (this.made !== key) this.build(key, sorts);
    for (const row of this.rows) row.show();
  }

  build(key, sorts) {
    this.made = key;
    this.rows = [];
    const { kinds } = this.explorer;
    const several = (part, title, all) => (all.length < 2 ? [[part, title]] : all.map((_, number) => [part, `${title} ${number}`, number]));
    const sections = Object.entries(SECTIONS).flatMap(([part, title]) => (
      part === "absorber" ? several(part, title, kinds) : part === "force" ? several(part, title, sorts) : [[part, title]]));
    this.element.replaceChildren(...sections.map((section) => this.section(section, sorts)).filter(Boolean));
  }

  /** A section of a part; of several absorbers or forces of that with a number. */
  section([part, title, number], sorts) {
    const { explorer } = this;
    const sort = sorts[number ?? 0];
    const slots = explorer.slots.filter((slot) => slot.number === number && explorer.forms(slot).length
      // In a list an absorber has its start with it.
      && (slot.part === part || (part === "absorber" && number !== undefined && slot.part === "start"))
      && (part !== "force" || EXCITATIONS[sort].groups.includes(plain(slot.key)))
      && !(slot.part === "primary" && explorer.fixed.structure)
      && !(slot.key === "primary.mass" && explorer.units !== "si"));
    const rows = slots.map((slot) => new Row(explorer, slot));
    this.rows.push(...rows);
    const free = number === undefined;
    const extra = part === "force" && free && sort !== "record" ? [excitationChoice(explorer, sort)]
      : part === "absorber" && free ? [gravityChoice(explorer)] : [];
    const given = fixedOf(explorer.fixed, part, number ?? 0);
    if (!rows.length && !given && (part !== "force" || !extra.length)) return null;
    // Without dimensions a frequency is not given: to give one makes times seconds.
    const usual = (slot) => isUsual(slot) && !(slot.key === "primary.frequency" && explorer.units === "natural")
      && !(plain(slot.key) === "absorber.inclination" && !isRising(explorer.values));
    // What makes a scene of another kind stands open where it is given.
    const isGiven = (slot) => OPENED.includes(plain(slot.key)) && slot.fields.some(({ path }) => explorer.values[path] !== undefined);
    const stands = ({ slot }) => usual(slot) || isGiven(slot);
    const order = (a, b) => Number(isUsual(b.slot)) - Number(isUsual(a.slot));
    const open = rows.filter(stands).sort(order);
    const others = rows.filter((row) => !open.includes(row));
    const more = make("details", {
      open: this.open.has(title), ontoggle: () => this.open[more.open ? "add" : "delete"](title),
    }, make("summary", {}, `More of ${title.toLowerCase()}`), ...others.map((row) => row.element));
    return make("fieldset", { class: `part part-${part}` }, make("legend", {}, title), ...extra, given,
      ...open.map((row) => row.element), others.length ? more : null);
  }
}

/** What no slider changes, as a list: the entries of a structure with modes, a table of the restitution, a record. */
function fixedOf({ structure, starts, tables, records }, part, number) {
  const record = records?.[number];
  const entries = {
    primary: structure, start: starts, absorber: tables?.[number] && { "speed, restitution": tables[number] },
    force: record && { kind: record.kind, points: `${record.times.length} from ${shown(record.times[0])} to ${shown(record.times.at(-1))}` },
  }[part];
  if (!entries) return null;
  const text = (value) => (Array.isArray(value) ? value.map(text).join(Array.isArray(value[0]) ? "; " : ", ")
    : typeof value === "object" ? Object.entries(value).map(([name, own]) => `${name}: ${text(own)}`).join("; ")
      : typeof value === "number" ? shown(value) : value);
  return make("dl", { class: "fixed" }, ...Object.entries(entries).flatMap(([name, value]) => [
    make("dt", {}, name.replace("_hz", " (Hz)").replaceAll("_", " ")), make("dd", {}, text(value))]));
}

/** Slots that stand open where they are given. */
const OPENED = ["absorber.friction", "absorber.gap_damping", "absorber.spring", "absorber.units", "absorber.clearance_spread"];

/** Sorts of excitation: what they are called, the slots they have, and what they begin with. */
const EXCITATIONS = {
  none: { label: "none: free decay", groups: [] },
  force: {
    label: "harmonic force", groups: ["force.amplitude", "force.frequency", "force.phase"], path: "force.amplitude",
  },
  base: {
    label: "harmonic base motion", groups: ["force.amplitude", "force.frequency", "force.phase"],
    path: "force.base_acceleration",
  },
  impulse: { label: "impulse", groups: ["force.impulse", "force.time"], path: "force.velocity" },
  record: { label: "record", groups: ["force.scale"] },
};

/** The sort of the force of this number. */
export function excitationOf({ values, fixed }, number = 0) {
  if (fixed.records?.[number]) return "record";
  const given = (pattern) => Object.keys(values).some((path) => (
    plain(path) === path ? number === 0 : path.startsWith(`force.${number}.`)) && pattern.test(plain(path)));
  if (given(/^force\.base_/)) return "base";
  if (given(/^force\.(velocity|impulse)$/)) return "impulse";
  return given(/^force\.(amplitude|force)$/) ? "force" : "none";
}

function excitationChoice(explorer, sort) {
  const id = freshId();
  const choice = make("select", { id, onchange: () => excite(explorer, choice.value) },
    ...Object.entries(EXCITATIONS).filter(([value]) => value !== "record").map(([value, { label }]) => make("option", { value, selected: value === sort }, label)));
  return make("div", { class: "choice" }, make("label", { for: id }, "Force, base motion or impulse"), choice);
}

/** Changes the excitation; a steady state takes longer than a decay, so the length changes as well. */
function excite(explorer, sort) {
  const { values } = explorer;
  const changes = {};
  for (const path of Object.keys(values)) {
    if (path.startsWith("force.") || path.startsWith("run.")) changes[path] = undefined;
  }
  const { setting, fixed } = explorer;
  const speed = 0.05 * (setting.reference || (fixed.structure ? 1e-3 : 1)) * setting.natural;
  // A structure with modes is pushed in N, of some 100 kg.
  const [path, mass] = fixed.structure && sort !== "base" ? [{ force: "force.force", impulse: "force.impulse" }[sort], 100] : [EXCITATIONS[sort].path, 1];
  if (sort === "force" || sort === "base") {
    Object.assign(changes, {
      [path]: rounded(mass * speed * setting.natural, 2), "force.relative_frequency": 1, "run.cycles": 100, "run.discard": 50,
    });
  } else {
    changes["run.periods"] = 20;
    if (sort === "impulse") Object.assign(changes, { [path]: rounded(10 * mass * speed, 2), "force.time": rounded(2 / setting.natural, 2) });
  }
  explorer.edit(changes, null);
}

function isRising(values) {
  return (values["absorber.inclination"] ?? values["absorber.inclination_deg"] ?? 0) > 0;
}

function gravityChoice(explorer) {
  if (explorer.choices.kind !== "siva" || explorer.fixed.structure) return null;
  const box = make("input", {
    type: "checkbox", checked: isRising(explorer.values),
    onchange: () => {
      const { setting } = explorer;
      const changes = {
        "absorber.inclination": undefined, "absorber.inclination_deg": undefined, "absorber.gravity": undefined,
        "start.gap_displacement": undefined,
      };
      if (box.checked) {
        changes["absorber.inclination_deg"] = 90;
        // In SI units gravity is known; elsewhere a tenth of the acceleration at the release.
        if (explorer.units !== "si") {
          changes["absorber.gravity"] = rounded(0.1 * (setting.reference || 1) * setting.natural ** 2, 2);
        }
      }
      explorer.edit(changes, null);
    },
  });
  return make("label", { class: "check" }, box, "Gravity along the motion");
}
