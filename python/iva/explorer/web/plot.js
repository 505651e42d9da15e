// Axes on a canvas: scales, ticks, lines. Nothing here knows what is drawn.

import { asCsv, save } from "./takeaway.js";
import { make, shown } from "./format.js";

const FONT = "system-ui, sans-serif";
const MARGIN = { left: 52, right: 10, top: 8, bottom: 34 };

/** Colours of a theme, as the style sheet says them. */
export function coloursOf(root) {
  const style = getComputedStyle(root);
  const names = [
    "back", "panel", "text", "quiet", "line", "structure", "body", "dark", "absorber", "plus", "minus",
    "alone", "spring", "damper", "accent",
  ];
  return Object.fromEntries(names.map((name) => [name, style.getPropertyValue(`--iva-${name}`).trim()]));
}

/** Numbers at which an axis from `low` to `high` has ticks, about so many. */
export function ticks(low, high, about) {
  const raw = (high - low) / Math.max(1, about);
  if (!(raw > 0) || !Number.isFinite(raw)) return [];
  const power = 10 ** Math.floor(Math.log10(raw));
  const step = power * ([1, 2, 5].find((nice) => nice * power >= raw * 0.999) ?? 10);
  const first = Math.ceil(low / step - 1e-9);
  const last = Math.floor(high / step + 1e-9);
  return Array.from({ length: last - first + 1 }, (_, index) => Number(((first + index) * step).toPrecision(12)));
}

/** Places and values of ticks; on an axis over log₁₀ at 1, 2 and 5 times the powers. */
function ticksOf(low, high, about, log) {
  if (!log) return ticks(low, high, about).map((tick) => [tick, tick]);
  const values = [];
  for (let power = Math.floor(low); power <= Math.ceil(high); power += 1) {
    for (const lead of [1, 2, 5]) values.push(Number((lead * 10 ** power).toPrecision(3)));
  }
  return values.map((value) => [Math.log10(value), value]).filter(([at]) => at >= low - 1e-9 && at <= high + 1e-9);
}

/** The least and the largest number of some arrays, NaN apart. */
export function extent(...arrays) {
  let low = Infinity;
  let high = -Infinity;
  for (const array of arrays) {
    for (const value of array) {
      if (value < low) low = value;
      if (value > high) high = value;
    }
  }
  return low <= high ? [low, high] : [0, 1];
}

/** Ends of an axis that has room for ±`size`. */
export function aroundZero(size) {
  const end = (size || 1) * 1.08;
  return [-end, end];
}

/** A canvas with axes; `x` and `y` turn values into pixels. */
export class Plot {
  constructor(context, width, height, colours) {
    Object.assign(this, { context, width, height, colours });
    this.x = (value) => value;
    this.y = (value) => value;
  }

  /** Sets the scales and draws box, ticks and labels. */
  axes({ x, y, xLabel, yLabel, right = 0, equal = false, zero = true, log = {} }) {
    const { context: c, colours } = this;
    const box = {
      left: MARGIN.left, top: MARGIN.top,
      right: this.width - MARGIN.right - right, bottom: this.height - MARGIN.bottom,
    };
    let [x0, x1] = x;
    let [y0, y1] = y;
    if (equal) [x0, x1, y0, y1] = sameScale(box, x0, x1, y0, y1);
    const across = (box.right - box.left) / (x1 - x0);
    const up = (box.bottom - box.top) / (y1 - y0);
    Object.assign(this, {
      box, xRange: [x0, x1], yRange: [y0, y1],
      x: (value) => box.left + (value - x0) * across,
      y: (value) => box.bottom - (value - y0) * up,
      xAt: (pixel) => x0 + (pixel - box.left) / across,
      yAt: (pixel) => y0 + (box.bottom - pixel) / up,
    });
    c.font = `11px ${FONT}`;
    c.lineWidth = 1;
    c.strokeStyle = colours.line;
    c.fillStyle = colours.quiet;
    c.textAlign = "center";
    c.textBaseline = "top";
    for (const [tick, value] of ticksOf(x0, x1, (box.right - box.left) / 70, log.x)) {
      this.stroke([[this.x(tick), box.bottom], [this.x(tick), box.bottom + 4]]);
      c.fillText(shown(value), this.x(tick), box.bottom + 6);
    }
    c.textAlign = "right";
    c.textBaseline = "middle";
    for (const [tick, value] of ticksOf(y0, y1, (box.bottom - box.top) / 30, log.y)) {
      this.stroke([[box.left - 4, this.y(tick)], [box.left, this.y(tick)]]);
      c.fillText(shown(value), box.left - 6, this.y(tick));
    }
    if (zero && y0 < 0 && y1 > 0) this.stroke([[box.left, this.y(0)], [box.right, this.y(0)]]);
    c.strokeRect(box.left, box.top, box.right - box.left, box.bottom - box.top);
    c.textAlign = "center";
    c.textBaseline = "bottom";
    c.fillText(xLabel, (box.left + box.right) / 2, this.height - 1);
    c.save();
    c.translate(11, (box.top + box.bottom) / 2);
    c.rotate(-Math.PI / 2);
    c.textBaseline = "middle";
    c.fillText(yLabel, 0, 0);
    c.restore();
  }

  /** Draws inside the axes only. */
  inside(draw) {
    const { context: c, box } = this;
    c.save();
    c.beginPath();
    c.rect(box.left, box.top, box.right - box.left, box.bottom - box.top);
    c.clip();
    draw(c);
    c.restore();
  }

  stroke(points) {
    this.context.beginPath();
    points.forEach(([x, y], index) => (index ? this.context.lineTo(x, y) : this.context.moveTo(x, y)));
    this.context.stroke();
  }

  /** A line through the values; NaN breaks it. */
  line(xs, ys, colour, width = 1.3, factor = 1, xFactor = 1) {
    const { context: c } = this;
    c.beginPath();
    let pen = false;
    for (let index = 0; index < xs.length; index += 1) {
      const value = ys[index] * factor;
      if (Number.isNaN(value)) pen = false;
      else if (pen) c.lineTo(this.x(xs[index] * xFactor), this.y(value));
      else {
        c.moveTo(this.x(xs[index] * xFactor), this.y(value));
        pen = true;
      }
    }
    c.strokeStyle = colour;
    c.lineWidth = width;
    c.lineJoin = "bevel";
    c.stroke();
  }

  dot(x, y, radius, colour) {
    const { context: c } = this;
    c.beginPath();
    c.arc(this.x(x), this.y(y), radius, 0, 2 * Math.PI);
    c.fillStyle = colour;
    c.fill();
  }

  /** A dashed line over the whole width. */
  level(y, colour, dash = [2, 3]) {
    const { context: c, box } = this;
    c.strokeStyle = colour;
    c.lineWidth = 1;
    c.setLineDash(dash);
    this.stroke([[box.left, this.y(y)], [box.right, this.y(y)]]);
    c.setLineDash([]);
  }

  text(text, x, y, colour, align = "left", baseline = "middle") {
    Object.assign(this.context, { fillStyle: colour, textAlign: align, textBaseline: baseline, font: `11px ${FONT}` });
    this.context.fillText(text, x, y);
  }
}

function sameScale(box, x0, x1, y0, y1) {
  const perPixel = Math.max((x1 - x0) / (box.right - box.left), (y1 - y0) / (box.bottom - box.top));
  const wide = (perPixel * (box.right - box.left)) / 2;
  const high = (perPixel * (box.bottom - box.top)) / 2;
  const [x, y] = [(x0 + x1) / 2, (y0 + y1) / 2];
  return [x - wide, x + wide, y - high, y + high];
}

/** A picture of the page: two canvases, one for what a run gives and one for what moves over it. */
export class View {
  /**
   * `draw(plot, data)` draws a run and `move(plot, data, instant)` what moves; `columns(data)` are
   * the numbers of the picture and `describe(data)` says it in words.
   */
  constructor({ name, title, draw, move = null, columns, describe, tools = [] }) {
    Object.assign(this, { name, title, draw, move, columns, describe });
    // Laid over each other whatever the style sheet says: a canvas that made its place larger would be made larger by it.
    const style = "position: absolute; inset: 0";
    this.base = make("canvas", { role: "img", "aria-label": title, style });
    this.over = make("canvas", { class: "over", "aria-hidden": "true", style });
    this.pad = make("div", { class: "pad", style: "position: relative" }, this.base, this.over);
    const button = (label, help, action) =>
      make("button", { type: "button", class: "small", title: help, "aria-label": help, onclick: action }, label);
    this.heading = make("h2", {}, title);
    this.legend = make("span", { class: "hint" });
    this.element = make("figure", { class: `view view-${name}`, "aria-label": title },
      make("figcaption", {}, this.heading, this.legend, make("span", { class: "tools" }, ...tools,
        button("PNG", `${title}: save as picture`, () => this.savePicture()),
        button("CSV", `${title}: save the numbers`, () => this.saveNumbers()))),
      this.pad);
    this.data = null;
    this.plot = null;
    // To ask the page for it at every frame would make the browser lay out all of it.
    this.size = null;
    new ResizeObserver(() => {
      this.size = null;
      if (!this.data) return;
      this.show(this.data, this.colours);
      if (this.instant !== undefined) this.at(this.instant);
    }).observe(this.pad);
  }

  measure() {
    this.size ??= { width: this.pad.clientWidth, height: this.pad.clientHeight };
  }

  get visible() {
    this.measure();
    return this.size.width > 0 && this.size.height > 0;
  }

  /** Makes both canvases as large as their place, in pixels of the screen. */
  fit() {
    const { width, height } = this.size;
    const density = Math.min(3, globalThis.devicePixelRatio || 1);
    for (const canvas of [this.base, this.over]) {
      if (canvas.width !== Math.round(width * density) || canvas.height !== Math.round(height * density)) {
        canvas.width = Math.round(width * density);
        canvas.height = Math.round(height * density);
      }
      const context = canvas.getContext("2d");
      context.setTransform(density, 0, 0, density, 0, 0);
      context.clearRect(0, 0, width, height);
    }
    return { width, height };
  }

  /** Draws a run. */
  show(data, colours) {
    this.data = data;
    this.colours = colours;
    if (!this.visible) return;
    const { width, height } = this.fit();
    this.plot = new Plot(this.base.getContext("2d"), width, height, colours);
    this.draw(this.plot, data);
    const told = this.describe(data);
    if (told !== this.told) this.base.setAttribute("aria-label", told);
    this.told = told;
  }

  /** Draws what belongs to an instant. */
  at(instant) {
    this.instant = instant;
    if (!this.move || !this.plot || !this.visible) return;
    const { width, height } = this.plot;
    const context = this.over.getContext("2d");
    context.clearRect(0, 0, width, height);
    const moving = Object.create(this.plot, { context: { value: context } });
    this.move(moving, this.data, instant);
  }

  savePicture() {
    const canvas = make("canvas", { width: this.base.width, height: this.base.height });
    const context = canvas.getContext("2d");
    context.fillStyle = this.plot.colours.panel;
    context.fillRect(0, 0, canvas.width, canvas.height);
    context.drawImage(this.base, 0, 0);
    context.drawImage(this.over, 0, 0);
    canvas.toBlob((blob) => save(`${this.name}.png`, blob, "image/png"));
  }

  saveNumbers() {
    save(`${this.name}.csv`, asCsv(this.columns(this.data)), "text/csv");
  }
}
