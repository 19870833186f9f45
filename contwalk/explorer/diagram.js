// Branches in a plane: lines by how stable they are, dots for stored points, marks for special ones.
function columnOf(branch, name) {
  const { values, fixed } = branch;
  if (name in values) return values[name];
  if (name in fixed) return values.s ? new Array(branch.count).fill(fixed[name]) : Array(branch.count).fill(fixed[name]);
  const [kind, state] = name.split(/:(.*)/);
  if (state in values && !branch.orbit && (kind === "max" || kind === "min")) return values[state];
  return null;
}

function between(values, at) {
  const [row, share] = at, next = Math.min(row + 1, values.length - 1);
  return share ? values[row] + share * (values[next] - values[row]) : values[row];
}

// Bifurcations come first where there is not room for all.
function rank(point) {
  return ["LP", "HB", "BP", "PD", "NS"].includes(point.label) ? 0 : point.label === "UZ" ? 2 : 1;
}

class Diagram {
  constructor(svg, data, panel, choose) {
    this.svg = svg;
    this.panel = panel;
    this.choose = choose;
    this.branches = data.branches.filter(branch => panel.names.includes(branch.name));
    this.numbers = new Map(data.branches.map((branch, k) => [branch.name, k]));
    this.zoomed = false;
    this.axes = new Axes(svg, () => { this.zoomed = true; this.draw(); });
    this.axes.interactive();
    this.regions = element("g", { class: "regions", "aria-hidden": "true" }, this.axes.inside);
    this.chart = panel.chart ? new Chart(this.regions, panel.chart) : null;
    this.ties = element("g", { class: "ties", "aria-hidden": "true" }, this.axes.inside);
    this.lines = element("g", { "aria-hidden": "true" }, this.axes.inside);
    this.linked = element("g", { class: "linked", "aria-hidden": "true" }, this.axes.inside);
    this.dots = element("g", {}, this.axes.inside);
    this.marks = element("g", {}, this.axes.inside);
    this.labels = element("g", { "aria-hidden": "true" }, this.axes.inside);
    this.ring = element("circle", { class: "ring", r: 9, visibility: "hidden" }, this.axes.inside);
    this.x = panel.x[0][0];
    this.y = panel.y[0][0];
    this.selected = null;
    svg.addEventListener("click", event => this.click(event));
    this.build();
  }
  across(name) { this.x = name; this.build(); this.reset(); }
  upwards(name) { this.y = name; this.build(); this.reset(); }
  // The curves of a branch: one, or the largest and the least value of a state.
  curves(branch) {
    const entry = this.panel.y.find(each => each[0] === this.y), names = entry[2][branch.name] || [this.y];
    const xs = columnOf(branch, this.x);
    return xs ? names.map(name => [xs, columnOf(branch, name)]).filter(pair => pair[1]) : [];
  }
  build() {
    this.places = [];
    for (const group of [this.ties, this.lines, this.dots, this.marks, this.labels]) group.replaceChildren();
    for (const branch of this.branches) {
      const kind = `b${this.numbers.get(branch.name) % 7}`, gaps = new Set(branch.gaps);
      const curves = this.curves(branch);
      curves.forEach(([xs, ys], which) => {
        for (const [first, last, stable, admissible] of branch.runs) {
          const look = branch.plane ? "curve" : stable === true ? "stable" : stable === false ? "unstable" : "unknown";
          const line = { xs, ys, first, last, gaps };
          if (!admissible) line.ties = element("path", { class: `tie ${kind}` }, this.ties);
          line.path = element("path", { class: `line ${look} ${kind}${admissible ? "" : " barred"}`,
            "data-branch": branch.name }, this.lines);
          this.places.push({ line });
        }
        if (which) return;
        for (let row = 0; row < branch.count; row++) {
          if (xs[row] === null || ys[row] === null) continue;
          const dot = element("circle", { class: `dot ${kind}`, r: 2.4, "data-row": `${branch.name}/${row}` }, this.dots);
          this.places.push({ x: xs[row], y: ys[row], node: dot, name: `${branch.name}/${row}`, kind: "row" });
        }
      });
      if (!curves.length) continue;
      for (const point of branch.points) {
        const [xs, ys] = curves[0], x = between(xs, point.at), y = between(ys, point.at);
        if (!Number.isFinite(x) || !Number.isFinite(y)) continue;
        const name = `${branch.name}/${point.name}`;
        const mark = element("path", { class: `mark ${kind} ${point.label}${point.located ? "" : " hollow"}`,
          d: shape(point.label), "data-point": name }, this.marks);
        element("title", {}, mark).textContent = `${name}: ${point.what}, ${point.where}`;
        this.places.push({ x, y, node: mark, name, kind: "point", point, branch: kind });
      }
    }
  }
  reset() {
    this.axes.measure();
    this.zoomed = false;
    const xs = [], ys = [];
    for (const { line } of this.places) if (line) {
      xs.push(...line.xs.slice(line.first, line.last + 1).filter(Number.isFinite));
      ys.push(...line.ys.slice(line.first, line.last + 1).filter(Number.isFinite));
    }
    this.axes.fit(xs, ys);
    this.draw();
  }
  resize() { this.axes.measure(); this.draw(); }
  draw() {
    const { axes } = this, label = (list, name) => list.find(each => each[0] === name)[1];
    axes.drawFrame(label(this.panel.x, this.x), label(this.panel.y, this.y));
    if (this.chart) this.chart.draw(axes, this.x, this.y);
    for (const { line, x, y, node, kind } of this.places) {
      if (line) {
        let d = "", pen = "M";
        for (let row = line.first; row <= line.last; row++) {
          if (line.xs[row] === null || line.ys[row] === null) { pen = "M"; continue; }
          d += `${pen}${axes.px(line.xs[row]).toFixed(1)} ${axes.py(line.ys[row]).toFixed(1)}`;
          pen = line.gaps.has(row) ? "M" : "L";
        }
        line.path.setAttribute("d", d);
        if (line.ties) line.ties.setAttribute("d", d);
      } else if (kind === "row") {
        node.setAttribute("cx", axes.px(x).toFixed(1));
        node.setAttribute("cy", axes.py(y).toFixed(1));
      } else node.setAttribute("transform", `translate(${axes.px(x).toFixed(1)} ${axes.py(y).toFixed(1)})`);
    }
    this.write();
    this.show(this.selected);
  }
  // Names of special points where there is room; the others are counted at their neighbour's, until one zooms.
  write() {
    const { axes } = this, taken = [], written = [];
    this.labels.replaceChildren();
    const { width, height } = axes.inner(), { left, top } = axes.margin;
    const marks = this.places.filter(place => place.kind === "point" && place.point.label !== "EP")
      .map(place => ({ ...place, px: axes.px(place.x), py: axes.py(place.y) }))
      .filter(each => each.px >= left && each.px <= left + width && each.py >= top && each.py <= top + height);
    for (const mark of marks) taken.push([mark.px - 5, mark.py - 5, mark.px + 5, mark.py + 5]);
    const free = box => box[0] >= left && box[2] <= left + width && box[1] >= top && box[3] <= top + height &&
      !taken.some(other => box[0] < other[2] && box[2] > other[0] && box[1] < other[3] && box[3] > other[1]);
    for (const mark of marks.sort((a, b) => rank(a.point) - rank(b.point))) {
      const text = mark.point.name, k = axes.scale, wide = k * (7.6 * text.length + 4);
      const spots = [[8, -8 * k], [8, 16 * k], [-8 - wide, -8 * k], [-8 - wide, 16 * k], [-wide / 2, -12 * k], [-wide / 2, 21 * k]];
      const spot = spots.find(([dx, dy]) => free([mark.px + dx, mark.py + dy - 11 * k, mark.px + dx + wide, mark.py + dy + 3 * k]));
      if (!spot) {
        let nearest = null, way = 60;
        for (const each of written) {
          const far = Math.hypot(each.px - mark.px, each.py - mark.py);
          if (far < way) [nearest, way] = [each, far];
        }
        if (nearest) nearest.more++;
        continue;
      }
      const box = [mark.px + spot[0], mark.py + spot[1] - 11 * k, mark.px + spot[0] + wide, mark.py + spot[1] + 3 * k];
      taken.push(box);
      const node = element("text", { x: mark.px + spot[0] + 2, y: mark.py + spot[1], class: `label ${mark.branch}` }, this.labels);
      node.textContent = text;
      written.push({ ...mark, more: 0, label: node, box, before: spot[0] < 0 });
    }
    for (const each of written) if (each.more) {
      const box = [...each.box];
      box[0] = box[2];
      box[2] += 7 * this.axes.scale * (String(each.more).length + 2);
      if (each.before || !free(box)) continue;
      taken.push(box);
      const more = element("tspan", { class: "more" }, each.label);
      more.textContent = ` +${each.more}`;
    }
  }
  nearest(x, y, within) {
    let found = null, least = within;
    for (const place of this.places) {
      if (place.line) continue;
      const way = Math.hypot(this.axes.px(place.x) - x, this.axes.py(place.y) - y) - (place.kind === "point" ? 0.5 : 0);
      if (way < least) [found, least] = [place, way];
    }
    return found;
  }
  click(event) {
    if (this.axes.dragged()) return;
    const own = event.target.closest("[data-point],[data-row]");
    const box = this.svg.getBoundingClientRect();
    // Where dots lie over one another, a pointer means the one whose middle is nearest.
    const found = event.detail ? this.nearest(event.clientX - box.left, event.clientY - box.top, 22) : null;
    if (found) { this.choose(found.name); return; }
    if (own) { this.choose(own.dataset.point || own.dataset.row); return; }
    const line = event.target.closest("[data-branch]");
    if (line) this.choose(line.dataset.branch);
  }
  // What is chosen: its own place, or where its parameters are on these axes.
  show(selected) {
    this.selected = selected;
    this.linked.replaceChildren();
    for (const { line } of this.places) if (line)
      line.path.classList.toggle("chosen", selected !== null && line.path.dataset.branch === selected.branch.name);
    const own = selected && this.branches.includes(selected.branch) ? this.places.find(each => each.name === selected.name) : null;
    this.ring.setAttribute("visibility", own ? "visible" : "hidden");
    const { axes } = this, { left, top } = axes.margin, { width, height } = axes.inner();
    if (own) {
      this.ring.setAttribute("cx", axes.px(own.x));
      this.ring.setAttribute("cy", axes.py(own.y));
    } else if (selected && !this.branches.includes(selected.branch)) {
      const read = name => { const column = columnOf(selected.branch, name); return column ? between(column, selected.at) : null; };
      const x = read(this.x), y = this.panel.y.length && columnOf(selected.branch, this.y) ? read(this.y) : null;
      if (Number.isFinite(x)) element("line", { x1: axes.px(x), x2: axes.px(x), y1: top, y2: top + height }, this.linked);
      if (Number.isFinite(y) && this.branches[0].plane)
        element("line", { x1: left, x2: left + width, y1: axes.py(y), y2: axes.py(y) }, this.linked);
    }
  }
}

function shape(label) {
  const forms = { LP: "M-5 4.5L0-5.5L5 4.5Z", BP: "M-5 0L0-5.5L5 0L0 5.5Z", HB: "M-4.5-4.5H4.5V4.5H-4.5Z",
    PD: "M-5-4.5L0 5.5L5-4.5Z", EP: "M0-4V4", UZ: "M-4-4L4 4M4-4L-4 4",
    GR: "M-5 0H5M0-5V5", AZ: "M-5 4L0-5L5 4M-3 1H3", OC: "M-5-3H5M-5 3H5" };
  return forms[label] || "M-4.6 0A4.6 4.6 0 1 0 4.6 0A4.6 4.6 0 1 0 -4.6 0Z";
}
