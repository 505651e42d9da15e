// How numbers and units are written, and small helpers for elements of a page.

/** A number for reading: so many significant digits, a real minus sign, nothing that is only zeros. */
export function shown(value, digits = 4) {
  if (value === null || value === undefined || Number.isNaN(value)) return "–";
  if (!Number.isFinite(value)) return value > 0 ? "∞" : "−∞";
  if (value === 0) return "0";
  const size = Math.abs(value);
  let text;
  if (size >= 1e6 || size < 1e-4) {
    const [mantissa, exponent] = value.toExponential(digits - 1).split("e");
    text = `${trimmed(mantissa)}e${Number(exponent)}`;
  } else {
    text = trimmed(value.toFixed(Math.max(0, digits - 1 - Math.floor(Math.log10(size)))));
  }
  return text.replaceAll("-", "−");
}

function trimmed(text) {
  return text.includes(".") ? text.replace(/\.?0+$/, "") : text;
}

/** A unit of the engine, short enough for a label; nothing for plain numbers. */
export function unitText(unit) {
  if (!unit || unit === "1") return "";
  return unit
    .replaceAll("length of displacement", "L")
    .replace(/^(.*) per unit primary mass$/, "M $1")
    .replaceAll("ωn", "ωₙ")
    .replaceAll(" · ", " ");
}

/** "5.2 mm", or "5.2" where there is no unit. */
export function withUnit(value, unit, digits = 4) {
  return unit ? `${shown(value, digits)} ${unit}` : shown(value, digits);
}

/** The nearest number with so many significant digits: what a slider or a dragged wall gives. */
export function rounded(value, digits = 3) {
  return value === 0 ? 0 : Number(value.toPrecision(digits));
}

/** Rounded to a step, as fine as the picture on which it was dragged. */
export function roundedTo(value, resolution) {
  const step = 10 ** Math.floor(Math.log10(resolution));
  const steps = Math.round(value / step);
  // Dividing by 1/step gives the short decimal where multiplying by step does not.
  return step < 1 ? steps / Math.round(1 / step) : steps * step;
}

export function clamp(value, low, high) {
  return Math.min(high, Math.max(low, value));
}

/** An element with properties (`on…` listeners, `aria-…`, `class`, or properties of it) and children. */
export function make(tag, properties = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(properties)) {
    if (value === undefined || value === null) continue;
    if (name.startsWith("on")) element.addEventListener(name.slice(2), value);
    else if (name === "class") element.className = value;
    else if (name.includes("-") || name === "role" || name === "for") element.setAttribute(name, value);
    else element[name] = value;
  }
  element.append(...children.filter((child) => child !== null && child !== undefined));
  return element;
}

let identifiers = 0;

/** An id that no other explorer on the same page has. */
export function freshId() {
  identifiers += 1;
  return `iva-x${identifiers}`;
}
