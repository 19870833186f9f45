// What is told of the chosen point: facts, spectrum, phase portrait, time series.
function tell(words) {
  const facts = document.getElementById("facts");
  facts.replaceChildren();
  if (!words) return;
  const [title, lines, tables] = words, list = html("ul");
  facts.append(html("h2", title));
  for (const line of lines) list.append(html("li", line));
  facts.append(list);
  for (const [header, rows, remark] of tables) {
    const table = html("table"), head = html("tr"), body = html("tbody"), top = html("thead");
    for (const cell of header) head.append(cell ? Object.assign(html("th", cell), { scope: "col" }) : html("td"));
    top.append(head);
    for (const row of rows) {
      const line = html("tr");
      for (const cell of row) line.append(html("td", cell, /^-?[\d.]+(e[+-]?\d+)?$/.test(cell) ? "number" : ""));
      body.append(line);
    }
    table.append(top, body);
    facts.append(table);
    if (remark) facts.append(html("p", remark, "remark"));
  }
}

const FAR = 3;

class Spectrum {
  constructor(svg) {
    this.svg = svg;
    this.axes = new Axes(svg, () => this.draw());
    this.numbers = [];
  }
  show(numbers, orbit) { this.numbers = numbers; this.orbit = orbit; this.draw(); }
  draw() {
    const { axes, numbers, orbit } = this;
    axes.measure();
    axes.inside.replaceChildren();
    // What is far outside of the unit circle stands at the edge, hollow, and tells its value.
    const within = orbit ? numbers.map(([x, y]) => Math.min(1, FAR / (Math.hypot(x, y) || 1))) : numbers.map(() => 1);
    const xs = numbers.map((each, k) => within[k] * each[0]), ys = numbers.map((each, k) => within[k] * each[1]);
    if (orbit) axes.fit([...xs, -1.15, 1.15], [...ys, -1.15, 1.15]);
    else axes.fit([...xs, 0], [...ys, 0, ...(ys.every(y => !y) ? [-1, 1] : ys.map(y => -y))]);
    if (orbit) axes.equal();
    axes.drawFrame("real part", "imaginary part");
    const edge = orbit ? 90 : 1, circle = [];
    for (let k = 0; k <= edge; k++) {
      const turn = 2 * Math.PI * k / edge;
      circle.push(orbit ? [Math.cos(turn), Math.sin(turn)] : [0, axes.view.y[k]]);
    }
    element("path", { class: "border", d: circle.map(([x, y], k) => `${k ? "L" : "M"}${axes.px(x).toFixed(1)} ${axes.py(y).toFixed(1)}`).join("") }, axes.inside);
    numbers.forEach(([x, y], k) => {
      const out = orbit ? Math.hypot(x, y) > 1 : x > 0, far = within[k] < 1;
      const at = { cx: axes.px(xs[k]), cy: axes.py(ys[k]) };
      const dot = element("circle", { class: `value${out ? " out" : ""}${far ? " far" : ""}`, r: 5, ...at }, axes.inside);
      if (far) element("text", { class: "tick", x: at.cx, y: at.cy - 10 * axes.scale, "text-anchor": at.cx < axes.width / 3 ? "start" : at.cx > axes.width * 2 / 3 ? "end" : "middle" },
        axes.inside).textContent = y ? `|μ| = ${Math.hypot(x, y).toPrecision(4)}` : x.toPrecision(4).replace("-", "−");
      element("title", {}, dot).textContent = `${x} ${y < 0 ? "−" : "+"} ${Math.abs(y)}i`;
    });
  }
}

// A curve that is broken where the motion jumps, and a point that moves along it.
class Curve {
  constructor(svg) {
    this.axes = new Axes(svg, () => this.draw());
    this.behind = element("g", { class: "plane" }, this.axes.inside);
    this.plane = null;
    this.flip = false;
    this.marks = element("g", { class: "events" }, this.axes.inside);
    this.path = element("path", { class: "orbit" }, this.axes.inside);
    this.jumps = element("path", { class: "jump" }, this.axes.inside);
    this.hand = element("line", { class: "hand" }, this.axes.inside);
    this.dot = element("circle", { class: "moving", r: 6 }, this.axes.inside);
  }
  show(xs, ys, names, events) {
    Object.assign(this, { xs, ys, names, events });
    this.draw();
  }
  draw() {
    const { axes, xs, ys } = this;
    if (!xs) return;
    axes.measure();
    axes.fit(xs, ys);
    if (this.plane) {
      const [left, right, low, high] = this.plane.window;
      axes.view = this.flip ? { x: [low, high], y: [left, right] } : { x: [left, right], y: [low, high] };
    }
    axes.drawFrame(...this.names);
    drawPlane(this.behind, axes, this.plane, this.flip);
    let line = "", jumps = "";
    for (let k = 0; k < xs.length; k++) {
      if (!Number.isFinite(xs[k]) || !Number.isFinite(ys[k])) continue; // a whole branch is chosen: no state
      const at = `${axes.px(xs[k]).toFixed(1)} ${axes.py(ys[k]).toFixed(1)}`;
      const jump = k > 0 && this.broken && this.broken(k);
      if (jump) jumps += `M${axes.px(xs[k - 1]).toFixed(1)} ${axes.py(ys[k - 1]).toFixed(1)}L${at}`;
      line += `${line && !jump ? "L" : "M"}${at}`;
    }
    this.path.setAttribute("d", line);
    this.jumps.setAttribute("d", jumps);
    this.marks.replaceChildren();
    let free = -Infinity;
    const { top } = axes.margin, low = top + axes.inner().height;
    for (const [time, name] of this.events) {
      const x = axes.px(time);
      element("line", { x1: x, x2: x, y1: top, y2: low }, this.marks);
      const told = name.replaceAll("_", " "), wide = 6.4 * axes.scale * told.length + 8;
      if (x < free || x + wide > axes.width) continue;
      free = x + wide;
      element("text", { x: x + 3, y: top + 11 * axes.scale }, this.marks).textContent = told;
    }
  }
  at(x, y, hand) {
    const { axes } = this, { top } = axes.margin, there = Number.isFinite(x) && Number.isFinite(y);
    for (const each of [this.dot, this.hand]) each.setAttribute("visibility", there ? "visible" : "hidden");
    if (!there) return;
    this.dot.setAttribute("cx", axes.px(x));
    this.dot.setAttribute("cy", axes.py(y));
    this.hand.setAttribute("visibility", hand ? "visible" : "hidden");
    if (hand) for (const [key, value] of Object.entries({ x1: axes.px(x), x2: axes.px(x), y1: top, y2: top + axes.inner().height }))
      this.hand.setAttribute(key, value);
  }
}
