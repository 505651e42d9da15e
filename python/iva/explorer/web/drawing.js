// The structure on its spring with the absorber in its gap, to scale, and what can be dragged on it.

import { clamp, make, roundedTo, shown, withUnit } from "./format.js";
import { extent, View } from "./plot.js";
import { lights, stateAt } from "./motion.js";

const WINDINGS = 8;

/** Sizes of the drawing, in lengths of the scene: what must have room decides them. */
function sizesOf({ run, clearance, offset, arm, lever, kind, x0 }) {
  const [low, high] = extent(run.trajectory.displacement);
  const moved = Math.max(-low, high, Math.abs(x0));
  // A structure that never moves is drawn beside its gap.
  const largest = moved > 0 ? moved : clearance > 0 ? clearance : 1;
  const d = kind === "none" ? 0.5 * largest : clearance;
  // A gap that is never crossed would leave no room for the motion: it is then cut.
  const shownGap = Math.min(d, 6 * largest + Math.abs(offset));
  const radius = kind === "piva" ? Math.min(0.3 * shownGap, 0.07 * arm) : Math.max(0.22 * shownGap, 0.08 * largest);
  const thick = 0.35 * Math.max(radius, 0.1 * largest);
  const half = shownGap + radius + thick;
  const spring = 1.7 * largest + 0.5 * half;
  return {
    largest, radius, thick, half, inside: shownGap + radius, anchor: -half - spring, arm, lever,
    left: -half - spring - 0.12 * half, right: half + largest + 0.12 * half,
  };
}

/** Pixels of the drawing; `frozen` keeps the scale while something is dragged. */
function scaleOf(plot, data, frozen) {
  const sizes = sizesOf(data);
  if (frozen) return { ...frozen, ...sizes, left: frozen.left, anchor: frozen.anchor };
  const wide = plot.width / (sizes.right - sizes.left);
  const tall = data.kind === "piva" ? (plot.height - 46) / (1.1 * sizes.arm * Math.max(1, sizes.lever)) : Infinity;
  const scale = Math.min(wide, tall);
  const rest = (plot.width - scale * (sizes.right - sizes.left)) / 2;
  const middle = data.kind === "piva" ? 26 : (plot.height - 16) / 2;
  return { ...sizes, scale, middle, zero: rest - scale * sizes.left };
}

function spring(c, from, to, height, swing) {
  const lead = Math.min(14, (to - from) / 6);
  c.beginPath();
  c.moveTo(from, height);
  c.lineTo(from + lead, height);
  for (let turn = 0; turn < 2 * WINDINGS; turn += 1) {
    const at = from + lead + ((turn + 0.5) * (to - from - 2 * lead)) / (2 * WINDINGS);
    c.lineTo(at, height + (turn % 2 ? swing : -swing));
  }
  c.lineTo(to - lead, height);
  c.lineTo(to, height);
  c.stroke();
}

function damper(c, from, to, height, swing) {
  const cup = from + 0.45 * (to - from);
  const rod = Math.min(cup + 24, to - 4);
  c.beginPath();
  c.moveTo(from, height);
  c.lineTo(cup, height);
  c.moveTo(cup + 30, height - swing);
  c.lineTo(cup, height - swing);
  c.lineTo(cup, height + swing);
  c.lineTo(cup + 30, height + swing);
  c.moveTo(rod - 8, height - swing + 2);
  c.lineTo(rod - 8, height + swing - 2);
  c.moveTo(rod - 8, height);
  c.lineTo(to, height);
  c.stroke();
}

function mixed(colours, wall, strength) {
  return `color-mix(in srgb, ${wall > 0 ? colours.plus : colours.minus} ${Math.round(100 * strength)}%, ${colours.dark})`;
}

export class Drawing {
  /** `explorer` is changed by what is dragged; `pause` stops the motion at time zero for that. */
  constructor(explorer, pause) {
    this.explorer = explorer;
    this.pause = pause;
    this.frozen = null;
    this.view = new View({
      name: "drawing",
      title: "Structure and absorber, to scale",
      draw: (plot, data) => { this.place = scaleOf(plot, data, this.frozen); },
      move: (plot, data, instant) => this.paint(plot, data, instant),
      columns: ({ run: { impacts } }) => impacts,
      describe: ({ kind }) => ({
        siva: "A structure on spring and damper, a free mass between its two walls",
        piva: "A structure on spring and damper, a pendulum between its two stops",
        none: "A structure on spring and damper",
      })[kind],
    });
    this.handles = {
      body: this.handle("Release displacement x₀", "body"),
      minus: this.handle("Wall −: clearance", "wall minus"),
      plus: this.handle("Wall +: clearance", "wall plus"),
      absorber: this.handle("Start of the absorber in its gap", "absorber"),
    };
    this.view.pad.append(...Object.values(this.handles));
    this.view.legend.textContent = "drag a wall, the absorber, or the structure";
  }

  handle(label, kind) {
    const element = make("div", {
      class: `handle ${kind}`, role: "slider", tabindex: "0", "aria-label": label, title: `${label}: drag, or arrow keys`,
    });
    element.tabIndex = 0;
    const name = kind.split(" ").pop();
    element.addEventListener("pointerdown", (event) => this.grab(event, element, name));
    element.addEventListener("keydown", (event) => this.key(event, name));
    return element;
  }

  get x() {
    return this.explorer.held("start.displacement");
  }

  /** Where the middle of the structure is drawn: that of its displacement. */
  px(length) {
    return this.place.zero + this.place.scale * length;
  }

  grab(event, element, name) {
    if (event.button !== 0) return;
    event.preventDefault();
    element.setPointerCapture(event.pointerId);
    element.focus({ preventScroll: true });
    const at = this.instant;
    this.frozen = { ...this.place };
    if (name === "body" || name === "absorber") this.pause();
    const { data } = this.view;
    const start = { pointer: event.clientX, ...this.values(data), at };
    const move = (later) => {
      const shift = (later.clientX - start.pointer) / this.frozen.scale;
      this.drag(name, start, shift);
    };
    const end = () => {
      element.removeEventListener("pointermove", move);
      element.removeEventListener("pointerup", end);
      element.removeEventListener("pointercancel", end);
      this.frozen = null;
      this.explorer.last = { what: null, at: 0 };
      this.explorer.tell();
    };
    element.addEventListener("pointermove", move);
    element.addEventListener("pointerup", end);
    element.addEventListener("pointercancel", end);
  }

  values(data) {
    return { x: data.x0, y: data.y0, clearance: data.clearance, offset: data.offset };
  }

  /** Gives the scene what is dragged, by so much from where it was. */
  drag(name, start, shift) {
    const resolution = 2 / this.place.scale;
    const short = (value) => roundedTo(value, resolution);
    const { explorer } = this;
    const si = explorer.units === "si";
    // Forms in mm are shortened in mm, lengths in lengths.
    const round = (key) => (value) => {
      const form = explorer.form(key);
      const unit = form.quantity === "Millimetre" ? 1e3 : form.quantity === "Ratio" ? 1 / this.view.data.reference : 1;
      return roundedTo(value, resolution * unit);
    };
    if (name === "plus" || name === "minus") {
      const least = 0.02 * this.place.largest;
      const d = Math.max(least, start.clearance + (name === "plus" ? shift : -shift));
      explorer.hold("absorber.clearance", d, "drag wall", round("absorber.clearance"));
    } else if (name === "body") {
      explorer.hold("start.displacement", start.x + shift, "drag body", round("start.displacement"));
    } else {
      const reach = start.clearance * (1 - 1e-9);
      const y = clamp(start.y + shift, start.offset - reach, start.offset + reach);
      const limited = clamp(si ? y : short(y), start.offset - reach, start.offset + reach);
      explorer.hold("start.gap_displacement", limited, "drag absorber");
    }
  }

  key(event, name) {
    const step = { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1 }[event.key];
    if (!step) return;
    event.preventDefault();
    const size = 0.02 * (event.shiftKey ? 5 : 1) * (this.view.data.reference || this.place.largest);
    if (name === "body" || name === "absorber") this.pause();
    this.drag(name, this.values(this.view.data), step * size);
  }

  /** Draws an instant, and puts the handles where the parts are. */
  paint(plot, data, instant) {
    if (!this.place) return;
    this.instant = instant;
    const { context: c, colours } = plot;
    const { scale, middle, thick, half, inside, radius, anchor, arm, lever } = this.place;
    const { x, y, angle } = stateAt(data.run.trajectory, instant);
    const light = lights(data.run.impacts, instant, data.period);
    const px = (length) => this.px(length);
    const ground = px(anchor);
    const high = data.kind === "piva" ? 18 : clamp(scale * 1.5 * radius, 24, 0.36 * plot.height);
    c.lineWidth = 1.2;
    c.strokeStyle = colours.dark;
    this.drawGround(c, ground, middle, high, colours);
    const side = px(x - half);
    spring(c, ground, side, middle - 0.4 * high, Math.min(7, 0.3 * high));
    damper(c, ground, side, middle + 0.4 * high, Math.min(7, 0.3 * high));
    const walls = { "-1": px(x - inside - thick), 1: px(x + inside) };
    if (data.kind === "none") {
      c.fillStyle = colours.body;
      c.fillRect(side, middle - high, 2 * half * scale, 2 * high);
    } else if (data.kind === "siva") {
      const bottom = middle + scale * radius;
      const floor = Math.max(5, 0.3 * scale * radius);
      c.fillStyle = colours.body;
      c.fillRect(side, bottom, 2 * half * scale, floor);
      for (const wall of [1, -1]) {
        c.fillStyle = mixed(colours, wall, Math.max(0.25, light[wall]));
        c.fillRect(walls[wall], bottom - 2.2 * scale * radius, Math.max(4, thick * scale), 2.2 * scale * radius);
      }
      c.fillStyle = colours.absorber;
      c.beginPath();
      c.arc(px(x + y - data.offset), middle, scale * radius, 0, 2 * Math.PI);
      c.fill();
    } else {
      this.drawPendulum(c, data, { x, y, angle, light, walls, middle, colours, px });
    }
    this.ruler(plot, data, x, px);
    this.placeHandles(data, { x, y, middle, high, walls, radius: scale * radius, thick: thick * scale, half, px, arm, lever });
  }

  drawGround(c, x, middle, high, colours) {
    c.beginPath();
    c.moveTo(x, middle - high);
    c.lineTo(x, middle + high);
    for (let up = -high; up < high; up += 7) {
      c.moveTo(x, middle + up);
      c.lineTo(x - 7, middle + up + 7);
    }
    c.strokeStyle = colours.dark;
    c.stroke();
  }

  drawPendulum(c, data, { x, y, angle, light, walls, middle, colours, px }) {
    const { scale, thick, radius, arm, lever } = this.place;
    const turned = Number.isNaN(angle) ? Math.asin(clamp(y / arm, -1, 1)) : angle;
    const length = arm * lever;
    c.fillStyle = colours.body;
    const beam = Math.max(6, scale * thick);
    c.fillRect(walls[-1], middle - beam / 2, walls[1] - walls[-1] + Math.max(4, scale * thick), beam);
    if (data.clearance < arm) {
      const depth = scale * arm * Math.sqrt(1 - (data.clearance / arm) ** 2);
      const size = Math.max(2.4 * radius * scale, 0.08 * arm * scale);
      for (const wall of [1, -1]) {
        c.fillStyle = colours.body;
        c.fillRect(walls[wall], middle, Math.max(4, scale * thick), depth);
        c.fillStyle = mixed(colours, wall, Math.max(0.25, light[wall]));
        c.fillRect(walls[wall], middle + depth - size / 2, Math.max(4, scale * thick), size);
      }
    }
    c.strokeStyle = colours.dark;
    c.lineWidth = 2;
    c.beginPath();
    c.moveTo(px(x), middle);
    const longest = Math.max(arm, length) * scale;
    c.lineTo(px(x) + longest * Math.sin(turned), middle + longest * Math.cos(turned));
    c.stroke();
    c.fillStyle = colours.absorber;
    c.beginPath();
    c.arc(px(x) + scale * length * Math.sin(turned), middle + scale * length * Math.cos(turned), Math.max(4, scale * radius), 0, 2 * Math.PI);
    c.fill();
    this.bob = [px(x) + scale * length * Math.sin(turned), middle + scale * length * Math.cos(turned)];
  }

  /** Marks rest and release below, so that one sees from where the structure was let go. */
  ruler(plot, data, x, px) {
    const { colours, context: c } = plot;
    const base = plot.height - 4;
    c.lineWidth = 1;
    c.strokeStyle = colours.quiet;
    for (const [at, label] of [[0, "0"], [data.x0, "x₀"]]) {
      plot.stroke([[px(at), base], [px(at), base - 8]]);
      if (at !== 0 || data.x0 !== 0) plot.text(label, px(at) + 4, base - 5, colours.quiet);
    }
    c.fillStyle = colours.accent;
    c.beginPath();
    c.moveTo(px(x), base - 9);
    c.lineTo(px(x) - 4, base);
    c.lineTo(px(x) + 4, base);
    c.fill();
  }

  placeHandles(data, { x, y, middle, high, walls, radius, thick, half, px }) {
    const put = (name, left, top, width, height, value, text) => {
      const { style } = this.handles[name];
      style.display = data.kind === "none" && name !== "body" ? "none" : "";
      style.left = `${left}px`;
      style.top = `${top}px`;
      style.width = `${width}px`;
      style.height = `${height}px`;
      const element = this.handles[name];
      if (element.dataset.value === text) return;
      element.dataset.value = text;
      element.setAttribute("aria-valuenow", shown(value).replace("−", "-"));
      element.setAttribute("aria-valuetext", text);
    };
    const { factor, unit } = data.drawn("Length");
    const said = (value) => withUnit(value * factor, unit);
    const pendulum = data.kind === "piva";
    const [bobX, bobY] = pendulum ? this.bob : [px(x + y - data.offset), middle];
    const size = Math.max(24, 2 * radius);
    const wide = Math.max(22, thick + 8);
    const down = pendulum && data.clearance < this.place.arm
      ? middle + this.place.scale * this.place.arm * Math.sqrt(1 - (data.clearance / this.place.arm) ** 2) : middle;
    const tall = pendulum ? 48 : Math.max(40, 2.4 * radius);
    put("body", px(x - half), pendulum ? middle - 14 : middle - high, 2 * half * this.place.scale, pendulum ? 28 : 2 * high + 14, data.x0, said(data.x0));
    put("minus", walls[-1] + thick / 2 - wide / 2, down - tall / 2, wide, tall, data.clearance, said(data.clearance));
    put("plus", walls[1] + thick / 2 - wide / 2, down - tall / 2, wide, tall, data.clearance, said(data.clearance));
    put("absorber", bobX - size / 2, bobY - size / 2, size, size, data.y0, said(data.y0));
  }
}
