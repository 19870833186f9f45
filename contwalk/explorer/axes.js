// A plane with two axes, drawn as SVG: numbers on the axes, dragging, zooming.
const SVG = "http://www.w3.org/2000/svg";

function element(name, attributes = {}, parent = null) {
  const made = document.createElementNS(SVG, name);
  for (const key in attributes) made.setAttribute(key, attributes[key]);
  if (parent) parent.append(made);
  return made;
}

function html(name, text = "", kind = "") {
  const made = document.createElement(name);
  if (text) made.textContent = text;
  if (kind) made.className = kind;
  return made;
}

function ticks(low, high, most) {
  const rough = (high - low) / Math.max(most, 1), power = 10 ** Math.floor(Math.log10(rough));
  const step = power * [1, 2, 5, 10].find(each => each * power >= rough * (1 - 1e-9));
  const found = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k++) found.push(k * step);
  const digits = Math.max(0, -Math.floor(Math.log10(step) + 1e-9)), large = Math.max(Math.abs(low), Math.abs(high));
  const plain = digits <= 5 && large < 1e6;
  const needed = Math.max(1, Math.ceil(Math.log10(large / step) + 0.5));
  return found.map(value => {
    const zero = Math.abs(value) < 1e-9 * step;
    return [value, zero ? "0" : (plain ? value.toFixed(digits) : value.toExponential(Math.min(needed, 6))).replace("-", "−")];
  });
}

class Axes {
  constructor(svg, redraw) {
    this.svg = svg;
    this.redraw = redraw;
    this.view = { x: [0, 1], y: [0, 1] };
    this.plain = { left: 58, right: 16, top: 26, bottom: 40 };
    this.margin = { ...this.plain };
    this.scale = 1;
    this.frame = element("g", { class: "frame", "aria-hidden": "true" }, svg);
    const name = `clip-${svg.id}`;
    const clip = element("clipPath", { id: name }, svg);
    this.clip = element("rect", {}, clip);
    this.inside = element("g", { "clip-path": `url(#${name})` }, svg);
  }
  measure() {
    const box = this.svg.getBoundingClientRect();
    this.width = Math.max(box.width, 80);
    this.height = Math.max(box.height, 80);
    this.svg.setAttribute("viewBox", `0 0 ${this.width} ${this.height}`);
    // Texts follow the page's size of letters, and what is around the axes follows texts.
    this.scale = parseFloat(getComputedStyle(document.documentElement).fontSize) / 15;
    for (const side in this.plain) this.margin[side] = this.plain[side] * this.scale;
  }
  fit(xs, ys) {
    for (const [axis, values] of [["x", xs], ["y", ys]]) {
      let low = Infinity, high = -Infinity;
      for (const value of values) if (Number.isFinite(value)) {
        if (value < low) low = value;
        if (value > high) high = value;
      }
      if (low > high) [low, high] = [0, 1];
      const size = Math.max(Math.abs(low), Math.abs(high));
      if (size < 1e-12) [low, high] = [-1, 1];
      else if (high - low < 1e-10 * size) [low, high] = [low - 0.1 * size, high + 0.1 * size];
      const beside = (axis === "x" ? 0.04 : 0.08) * (high - low);
      this.view[axis] = [low - beside, high + beside];
    }
  }
  px(x) { return this.margin.left + (x - this.view.x[0]) / (this.view.x[1] - this.view.x[0]) * this.inner().width; }
  py(y) { return this.margin.top + (this.view.y[1] - y) / (this.view.y[1] - this.view.y[0]) * this.inner().height; }
  inner() {
    return { width: this.width - this.margin.left - this.margin.right,
      height: this.height - this.margin.top - this.margin.bottom };
  }
  equal() {
    const { width, height } = this.inner(), { x, y } = this.view;
    const unit = Math.max((x[1] - x[0]) / width, (y[1] - y[0]) / height);
    const middle = [(x[0] + x[1]) / 2, (y[0] + y[1]) / 2];
    this.view.x = [middle[0] - unit * width / 2, middle[0] + unit * width / 2];
    this.view.y = [middle[1] - unit * height / 2, middle[1] + unit * height / 2];
  }
  drawFrame(xlabel, ylabel) {
    const { left, top } = this.margin, { width, height } = this.inner(), k = this.scale;
    for (const [key, value] of Object.entries({ x: left, y: top, width, height })) this.clip.setAttribute(key, value);
    this.frame.replaceChildren();
    const base = top + height;
    for (const [value, text] of ticks(...this.view.x, width / (90 * k))) {
      const x = this.px(value);
      element("line", { x1: x, x2: x, y1: top, y2: base, class: "grid" }, this.frame);
      element("text", { x, y: base + 16 * k, class: "tick", "text-anchor": "middle" }, this.frame).textContent = text;
    }
    for (const [value, text] of ticks(...this.view.y, height / (55 * k))) {
      const y = this.py(value);
      element("line", { x1: left, x2: left + width, y1: y, y2: y, class: "grid" }, this.frame);
      element("text", { x: left - 8 * k, y: y + 4 * k, class: "tick", "text-anchor": "end" }, this.frame).textContent = text;
    }
    element("path", { d: `M${left} ${top}V${base}H${left + width}`, class: "axis" }, this.frame);
    if (xlabel) element("text", { x: left + width, y: base + 33 * k, class: "name", "text-anchor": "end" },
      this.frame).textContent = xlabel;
    if (ylabel) element("text", { x: 4, y: top - 11 * k, class: "name" }, this.frame).textContent = ylabel;
  }
  zoom(factor, at = null) {
    const { left, top } = this.margin, { width, height } = this.inner();
    const share = at ? [(at[0] - left) / width, 1 - (at[1] - top) / height] : [0.5, 0.5];
    ["x", "y"].forEach((axis, k) => {
      const [low, high] = this.view[axis], middle = low + share[k] * (high - low);
      this.view[axis] = [middle - factor * (middle - low), middle + factor * (high - middle)];
    });
    this.redraw();
  }
  pan(dx, dy) {
    const { width, height } = this.inner(), { x, y } = this.view;
    const across = dx / width * (x[1] - x[0]), up = dy / height * (y[1] - y[0]);
    this.view = { x: [x[0] - across, x[1] - across], y: [y[0] + up, y[1] + up] };
    this.redraw();
  }
  // Dragging moves, the wheel and two fingers zoom; a click that moved nothing stays a click.
  interactive() {
    const held = new Map();
    let moved = 0, apart = 0;
    this.dragged = () => moved > 4;
    const place = event => {
      const box = this.svg.getBoundingClientRect();
      return [event.clientX - box.left, event.clientY - box.top];
    };
    this.svg.addEventListener("pointerdown", event => {
      if (!held.size) moved = 0;
      held.set(event.pointerId, place(event));
    });
    this.svg.addEventListener("pointermove", event => {
      if (!held.has(event.pointerId)) return;
      const now = place(event), before = held.get(event.pointerId);
      held.set(event.pointerId, now);
      if (held.size === 1) {
        moved += Math.hypot(now[0] - before[0], now[1] - before[1]);
        if (moved > 4) this.pan(now[0] - before[0], now[1] - before[1]);
      } else {
        const [one, two] = [...held.values()], far = Math.hypot(one[0] - two[0], one[1] - two[1]);
        if (apart) this.zoom(apart / far, [(one[0] + two[0]) / 2, (one[1] + two[1]) / 2]);
        apart = far;
        moved = 9;
      }
    });
    const release = event => { held.delete(event.pointerId); apart = 0; };
    for (const name of ["pointerup", "pointercancel", "pointerleave"]) this.svg.addEventListener(name, release);
    this.svg.addEventListener("wheel", event => {
      event.preventDefault();
      this.zoom(Math.exp(Math.max(-60, Math.min(60, event.deltaY)) * 0.004), place(event));
    }, { passive: false });
  }
}
