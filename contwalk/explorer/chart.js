// The regions between curves in two parameters, filled by what is stable there.
const FILLED = { 0: "stable", 1: "1 unstable direction", 2: "2 unstable directions", 3: "3 unstable directions",
  4: "4 or more unstable directions", unknown: "not known", none: "none found" };

class Chart {
  constructor(group, data) {
    const { header, body } = data, numbers = new Numbers(body), { rows, columns } = header;
    Object.assign(this, { group, header });
    this.cells = element("g", {}, group);
    this.texts = element("g", {}, group);
    const outlines = header.regions.map(() => ""), widths = header.regions.map(() => 0);
    for (let cell = 0; cell < rows * columns;) {
      const region = numbers.next() - 1;
      let length = numbers.next();
      while (length > 0) {
        const row = Math.floor(cell / columns), column = cell % columns, own = Math.min(length, columns - column);
        if (region >= 0) {
          outlines[region] += `M${column} ${row}h${own}v1h${-own}Z`;
          widths[region] = Math.max(widths[region], own);
        }
        cell += own;
        length -= own;
      }
    }
    this.widths = widths;
    header.regions.forEach(([fill, admissible], k) => element("path", { d: outlines[k],
      class: `region fill-${fill}${admissible ? "" : " beyond"}` }, this.cells));
  }
  // How its lines stand under a diagram's axes; hidden where other parameters do.
  draw(axes, x, y) {
    const { names, low, high, rows, columns, regions } = this.header, flip = x === names[1];
    const shown = names.includes(x) && names.includes(y) && x !== y;
    this.group.setAttribute("visibility", shown ? "visible" : "hidden");
    if (!shown) return;
    const at = (first, second) => flip ? [axes.px(second), axes.py(first)] : [axes.px(first), axes.py(second)];
    const [a, b] = at(low[0], low[1]), [c, d] = at(high[0], low[1]), [e, f] = at(low[0], high[1]);
    this.cells.setAttribute("transform",
      `matrix(${(c - a) / columns} ${(d - b) / columns} ${(e - a) / rows} ${(f - b) / rows} ${a} ${b})`);
    this.texts.replaceChildren();
    const { left, top } = axes.margin, { width, height } = axes.inner();
    regions.forEach(([, , counts, first, second], k) => {
      const [px, py] = at(first, second), wide = this.widths[k] / columns * Math.hypot(c - a, d - b);
      if (wide < 10 * axes.scale * (counts.length + 1) || px < left || px > left + width || py < top || py > top + height) return;
      element("text", { x: px, y: py + 4 * axes.scale, class: "tick", "text-anchor": "middle" }, this.texts).textContent = counts;
    });
  }
  key(list) {
    const fills = new Set(this.header.regions.map(each => each[0]));
    for (const fill of ["0", "1", "2", "3", "4", "unknown", "none"]) if (fills.has(fill)) list.append(html("li", FILLED[fill], `k-fill fill-${fill}`));
    if (this.header.regions.some(each => !each[1])) list.append(html("li", "none is admissible", "k-fill beyond"));
  }
}
