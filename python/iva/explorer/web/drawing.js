// The structure on its spring with the absorber in its gap, to scale, and what can be dragged on it.

import { clamp, make, roundedTo, shown, withUnit } from "./format.js";
import { extent, View } from "./plot.js";
import { lights, stateAt } from "./motion.js";

const WINDINGS = 8;

/** Sizes of the drawing, in lengths of the scene: what must have room decides them. */
function sizesOf({ at, path, has, clearance, offset, arm, lever, kind }, { modal, run }) {
  const [low, high] = extent(at.displacement, ...(modal?.points ?? []).map((point) => run.points[point]));
  const moved = Math.max(-low, high);
  // A structure that never moves is drawn beside its gap.
  const largest = moved > 0 ? moved : clearance > 0 ? clearance : 1;
  const d = kind === "none" ? 0.5 * largest : clearance;
  // A gap that is never crossed would leave no room for the motion: it is then cut.
  const shownGap = Math.min(d, 6 * largest + Math.abs(offset));
  const radius = kind === "piva" ? Math.min(0.3 * shownGap, 0.07 * arm) : Math.max(0.22 * shownGap, 0.08 * largest);
  const thick = 0.35 * Math.max(radius, 0.1 * largest);
  // Where a wall is missing the floor is as long as the way of the absorber.
  const way = kind === "siva" && !(has[1] && has[-1]) ? extent(path.gap_displacement).map((end) => Math.abs(end - offset)) : [];
  const half = Math.max(shownGap, ...way) + radius + thick;
  const spring = 1.7 * largest + 0.5 * half;
  if (kind === "stop") {
    // The structure is a box that meets walls which stand on the ground.
    const [box, far] = [0.3 * largest, 0.3 * largest + Math.max(largest, Math.min(clearance, 3 * largest) + Math.abs(offset) + thick)];
    return { largest, radius: box, thick, half: box, inside: box + clearance, anchor: -far - spring, left: -far - spring - 0.1 * box, right: far + 0.3 * box };
  }
  return {
    largest, radius, thick, half, inside: shownGap + radius, anchor: -half - spring, arm, lever,
    left: -half - spring - 0.12 * half, right: half + largest + 0.12 * half,
  };
}

/** Pixels of the drawing; `frozen` keeps the scale while something is dragged. */
function scaleOf(plot, one, data, frozen) {
  const sizes = sizesOf(one, data);
  if (frozen) return { ...frozen, ...sizes, left: frozen.left, anchor: frozen.anchor };
  const wide = plot.width / (sizes.right - sizes.left);
  const tall = one.kind === "piva" ? (plot.height - 46) / (1.1 * sizes.arm * Math.max(1, sizes.lever)) : Infinity;
  // A pendulum that is long beside its gap is drawn shorter than it is: else there would be nothing of the gap to be seen.
  const scale = tall < 0.3 * wide ? wide : Math.min(wide, tall);
  const down = Math.min(scale, tall);
  const rest = (plot.width - scale * (sizes.right - sizes.left)) / 2;
  const middle = one.kind === "piva" ? 26 : (plot.height - 16) / 2;
  return { ...sizes, scale, down, middle, zero: rest - scale * sizes.left };
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
  /** Of the absorber at this place; `explorer` is changed by what is dragged; `pause` stops the motion at time zero for that. */
  constructor(explorer, pause, number) {
    this.explorer = explorer;
    this.number = number;
    this.pause = pause;
    this.frozen = null;
    this.view = new View({
      name: number ? `drawing_${number}` : "drawing",
      title: "Structure and absorber, to scale",
      draw: (plot, data) => {
        const place = scaleOf(plot, this.one, data, this.frozen);
        this.place = place;
        this.view.heading.textContent = `Structure and ${this.one.kind === "stop" ? "stops" : "absorber"}${this.one.label}, ${place.down < place.scale ? "widths " : ""}to scale`;
      },
      move: (plot, data, instant) => this.paint(plot, data, instant),
      columns: () => this.one.impacts,
      describe: () => ({
        siva: "A structure on spring and damper, a free mass between its two walls",
        piva: "A structure on spring and damper, a pendulum between its two stops",
        stop: "A structure on spring and damper, between stops on the ground",
        none: "A structure on spring and damper",
      })[this.one.kind],
    });
    this.handles = {
      body: this.handle("Release displacement x₀", "body"),
      minus: this.handle("Wall −: clearance", "wall minus"),
      plus: this.handle("Wall +: clearance", "wall plus"),
      absorber: this.handle("Start of the absorber in its gap", "absorber"),
    };
    this.view.pad.append(...Object.values(this.handles));
    this.view.pad.classList.add("drawn");
    this.view.legend.textContent = "drag a wall, the absorber, or the structure";
  }

  handle(label, kind) {
    const element = make("div", {
      class: `handle ${kind}`, role: "slider", tabindex: "0", "aria-label": label, title: `${label}: drag, or arrow keys`,
    });
    element.tabIndex = 0;
    const name = kind.split(" ").pop();
    element.addEventListener("pointerdown", (event) => this.grab(event, element, name));
    element.addEventListener("keydown", (event) => this.press(event, name));
    return element;
  }

  /** What there is to be drawn of the absorber. */
  get one() {
    return this.view.data.absorbers[this.number];
  }

  /** The key of a slot of the absorber. */
  key(part, group) {
    return this.explorer.keyOf(this.one.owner, part, group);
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
    const start = { pointer: event.clientX, ...this.values(), at };
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

  values() {
    const { y0: y, clearance, offset } = this.one;
    return { x: this.explorer.held("start.displacement") || 0, y, clearance, offset };
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
      const key = this.key("absorber", "clearance");
      explorer.hold(key, d, `drag ${key}`, round(key));
    } else if (name === "body") {
      explorer.hold("start.displacement", start.x + shift, "drag body", round("start.displacement"));
    } else {
      const reach = start.clearance * (1 - 1e-9);
      const y = clamp(start.y + shift, start.offset - reach, start.offset + reach);
      const limited = clamp(si ? y : short(y), start.offset - reach, start.offset + reach);
      const key = this.key("start", "gap_displacement");
      explorer.hold(key, limited, `drag ${key}`);
    }
  }

  press(event, name) {
    const step = { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1 }[event.key];
    if (!step) return;
    event.preventDefault();
    const size = 0.02 * (event.shiftKey ? 5 : 1) * (this.view.data.reference || this.place.largest);
    if (name === "body" || name === "absorber") this.pause();
    this.drag(name, this.values(), step * size);
  }

  /** Draws an instant, and puts the handles where the parts are. */
  paint(plot, data, instant) {
    if (!this.place) return;
    this.instant = instant;
    const { one } = this;
    const { context: c, colours } = plot;
    const { scale, middle, thick, half, inside, radius, anchor } = this.place;
    const { x, y, angle } = stateAt(one, instant);
    const light = lights(one.impacts, instant, data.period);
    const px = (length) => this.px(length);
    const ground = px(anchor);
    const high = one.kind === "piva" ? 18 : clamp(scale * 1.5 * radius, 24, 0.36 * plot.height);
    c.lineWidth = 1.2;
    c.strokeStyle = colours.dark;
    const side = px(x - half);
    if (data.modal) this.drawShape(plot, data, { instant, x, side, middle });
    else {
      this.drawGround(c, ground, middle, high, colours);
      spring(c, ground, side, middle - 0.4 * high, Math.min(7, 0.3 * high));
      damper(c, ground, side, middle + 0.4 * high, Math.min(7, 0.3 * high));
    }
    // Stops stand on the ground, walls on the structure.
    const from = one.kind === "stop" ? one.offset : x;
    const walls = { "-1": px(from - inside - thick), 1: px(from + inside) };
    if (one.kind === "none" || one.kind === "stop") {
      c.fillStyle = colours.body;
      c.fillRect(side, middle - high, 2 * half * scale, 2 * high);
      for (const wall of [1, -1]) {
        if (!one.has[wall]) continue;
        c.fillStyle = mixed(colours, wall, Math.max(0.25, light[wall]));
        c.fillRect(walls[wall], middle - high, Math.max(4, thick * scale), 2 * high);
      }
    } else if (one.kind === "siva") {
      const bottom = middle + scale * radius;
      const floor = Math.max(5, 0.3 * scale * radius);
      c.fillStyle = colours.body;
      c.fillRect(side, bottom, 2 * half * scale, floor);
      for (const wall of [1, -1]) {
        if (!one.has[wall]) continue;
        c.fillStyle = mixed(colours, wall, Math.max(0.25, light[wall]));
        c.fillRect(walls[wall], bottom - 2.2 * scale * radius, Math.max(4, thick * scale), 2.2 * scale * radius);
      }
      if (one.tied) spring(c, one.has[-1] ? px(x - inside) : side, px(x + y - one.offset - radius), middle, Math.min(7, 0.4 * scale * radius));
      c.fillStyle = colours.absorber;
      c.beginPath();
      c.arc(px(x + y - one.offset), middle, scale * radius, 0, 2 * Math.PI);
      c.fill();
    } else {
      this.drawPendulum(c, one, { x, y, angle, light, walls, middle, colours, px });
    }
    this.ruler(plot, one.at.displacement[0], x, px);
    this.placeHandles(data, { x, y, middle, high, walls, radius: scale * radius, thick: thick * scale, half, px });
  }

  /** The points of a structure with modes above each other, each moved as it moves, with that of the absorber joined to its gap. */
  drawShape(plot, { run, modal, period }, { instant, x, side, middle }) {
    const { context: c, colours } = plot;
    const rest = 0.55 * this.px(this.place.anchor) + 0.45 * this.px(-this.place.half);
    const bottom = plot.height - 26;
    const step = (bottom - 14) / Math.max(1, modal.points.length - (modal.free ? 1 : 0));
    const { time } = run.samples;
    const places = modal.points.map((point, index) => {
      const at = { time, displacement: run.points[point], velocity: run.point_velocities[point] };
      return [rest + this.place.scale * stateAt({ at, path: at }, instant).x, bottom - step * (index + (modal.free ? 0 : 1)), point];
    });
    c.strokeStyle = colours.line;
    plot.stroke([[rest, bottom], [rest, 14]]);
    c.strokeStyle = colours.dark;
    if (!modal.free) {
      c.beginPath();
      for (let along = -14; along < 14; along += 7) {
        c.moveTo(rest + along, bottom);
        c.lineTo(rest + along - 5, bottom + 6);
      }
      plot.context.stroke();
      plot.stroke([[rest - 18, bottom], [rest + 14, bottom]]);
    }
    c.lineWidth = 2;
    plot.stroke([...(modal.free ? [] : [[rest, bottom]]), ...places]);
    c.lineWidth = 1.2;
    for (const [at, height, point] of places) {
      const own = point === this.one.point;
      if (own) plot.stroke([[at, height], [side, middle]]);
      c.fillStyle = own ? colours.structure : colours.dark;
      c.beginPath();
      c.arc(at, height, own ? 4.5 : 3, 0, 2 * Math.PI);
      c.fill();
      plot.text(point, Math.max(4, Math.min(rest, at) - 10), height, colours.quiet, "right");
    }
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

  drawPendulum(c, one, { x, y, angle, light, walls, middle, colours, px }) {
    const { scale, down, thick, radius, arm, lever } = this.place;
    const turned = Number.isNaN(angle) ? Math.asin(clamp(y / arm, -1, 1)) : angle;
    const length = arm * lever;
    c.fillStyle = colours.body;
    const beam = Math.max(6, scale * thick);
    c.fillRect(walls[-1], middle - beam / 2, walls[1] - walls[-1] + Math.max(4, scale * thick), beam);
    if (one.clearance < arm) {
      const depth = down * arm * Math.sqrt(1 - (one.clearance / arm) ** 2);
      const size = Math.min(depth, Math.max(2.4 * radius * scale, 0.08 * arm * scale));
      for (const wall of [1, -1]) {
        if (!one.has[wall]) continue;
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
    const longest = Math.max(arm, length);
    c.lineTo(px(x) + scale * longest * Math.sin(turned), middle + down * longest * Math.cos(turned));
    c.stroke();
    this.bob = [px(x) + scale * length * Math.sin(turned), middle + down * length * Math.cos(turned)];
    c.fillStyle = colours.absorber;
    c.beginPath();
    c.arc(...this.bob, Math.max(4, scale * radius), 0, 2 * Math.PI);
    c.fill();
  }

  /** Marks rest and release below, so that one sees from where the structure was let go. */
  ruler(plot, x0, x, px) {
    const { colours, context: c } = plot;
    const base = plot.height - 4;
    c.lineWidth = 1;
    c.strokeStyle = colours.quiet;
    for (const [at, label] of [[0, "0"], [x0, "x₀"]]) {
      plot.stroke([[px(at), base], [px(at), base - 8]]);
      if (at !== 0 || x0 !== 0) plot.text(label, px(at) + 4, base - 5, colours.quiet);
    }
    c.fillStyle = colours.accent;
    c.beginPath();
    c.moveTo(px(x), base - 9);
    c.lineTo(px(x) - 4, base);
    c.lineTo(px(x) + 4, base);
    c.fill();
  }

  placeHandles(data, { x, y, middle, high, walls, radius, thick, half, px }) {
    const { one } = this;
    // What a structure with modes has at time zero is given for all of its points.
    const has = { body: !data.modal, minus: one.has[-1], plus: one.has[1], absorber: ["siva", "piva"].includes(one.kind) };
    const put = (name, left, top, width, height, value, text) => {
      const { style } = this.handles[name];
      style.display = has[name] ? "" : "none";
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
    const [x0] = one.at.displacement;
    const pendulum = one.kind === "piva";
    const [bobX, bobY] = pendulum ? this.bob : [px(x + y - one.offset), middle];
    const size = Math.max(24, 2 * radius);
    const wide = Math.max(22, thick + 8);
    const down = pendulum && one.clearance < this.place.arm
      ? middle + this.place.down * this.place.arm * Math.sqrt(1 - (one.clearance / this.place.arm) ** 2) : middle;
    const tall = pendulum ? 48 : Math.max(40, 2.4 * radius);
    put("body", px(x - half), pendulum ? middle - 14 : middle - high, 2 * half * this.place.scale, pendulum ? 28 : 2 * high + 14, x0, said(x0));
    put("minus", walls[-1] + thick / 2 - wide / 2, down - tall / 2, wide, tall, one.clearance, said(one.clearance));
    put("plus", walls[1] + thick / 2 - wide / 2, down - tall / 2, wide, tall, one.clearance, said(one.clearance));
    put("absorber", bobX - size / 2, bobY - size / 2, size, size, one.y0, said(one.y0));
  }
}
