// The machine as its plugin draws it, between the pictures that the page has.
class Machine {
  constructor(svg) { this.svg = svg; this.nodes = []; }
  show(pictures) {
    this.svg.replaceChildren();
    this.nodes = [];
    this.pictures = pictures;
    if (!pictures) return;
    const { machine, tracks, height } = pictures, size = machine.scale.view;
    this.svg.setAttribute("viewBox", `0 0 ${size} ${height}`);
    const box = this.svg.getBoundingClientRect();
    this.pixel = Math.max(size / Math.max(box.width, 1), height / Math.max(box.height, 1));
    this.point = this.pixel * Math.max(0.75, Math.min(1.33, box.width / 430));
    for (const track of tracks) {
      const [kind, look, text, , outline] = machine.keys[track.key], style = machine.looks[look];
      if (!style.marker || style.stroke && machine.keys[track.key][3] > 1) this.add(track, kind, style, text, outline);
      if (style.marker) {
        const node = element("path", { fill: style.fill || "none", stroke: style.edge, opacity: style.opacity || 1,
          "stroke-width": style.thick * this.point / this.pixel, "vector-effect": "non-scaling-stroke" }, this.svg);
        this.nodes.push({ node, track, kind, style, outline, markers: true });
      }
    }
    this.at(0);
  }
  add(track, kind, style, text, outline) {
    const { machine } = this.pictures;
    const node = element(kind === "text" ? "text" : "path", {}, this.svg);
    this.dress(node, kind, style);
      if (kind === "text") node.textContent = text;
    if (outline >= 0) node.setAttribute("d", this.line(machine.outlines[outline], machine.scale.outline, kind));
    this.nodes.push({ node, track, kind, style, outline });
  }
  dress(node, kind, style) {
    const set = (key, value) => value !== undefined && node.setAttribute(key, value);
    if (kind === "text") {
      set("fill", style.fill);
      set("font-size", style.font * this.point);
      set("text-anchor", style.across);
      set("dominant-baseline", { center: "central", top: "hanging", bottom: "auto" }[style.up] || "auto");
      set("font-style", style.style);
      set("font-weight", style.weight);
    } else {
      set("fill", kind === "fill" ? style.fill || "none" : "none");
      set("stroke", style.stroke || "none");
      set("stroke-width", (style.width || 1) * this.point / this.pixel);
      set("stroke-dasharray", style.dash);
      node.setAttribute("vector-effect", "non-scaling-stroke");
      set("stroke-linecap", style.cap);
      node.setAttribute("stroke-linejoin", "round");
    }
    set("opacity", style.opacity);
  }
  moved(outline, [a, b, x, y]) {
    const { machine } = this.pictures, { scale } = machine, found = [], points = machine.outlines[outline];
    for (let k = 0; k < points.length; k += 2) {
      const [u, v] = [points[k] / scale.outline, points[k + 1] / scale.outline];
      found.push(x + (a * u - b * v) / scale.turn, y + (b * u + a * v) / scale.turn);
    }
    return found;
  }
  line(numbers, scale, kind) {
    let d = "";
    for (let k = 0; k < numbers.length; k += 2) d += `${k ? "L" : "M"}${numbers[k] / scale} ${numbers[k + 1] / scale}`;
    return d + (kind === "fill" ? "Z" : "");
  }
  markers(numbers, style) {
    const r = style.size / 2 * this.point;
    let d = "";
    for (let k = 0; k < numbers.length; k += 2) {
      const [x, y] = [numbers[k], numbers[k + 1]];
      if (style.marker === "+") d += `M${x - r} ${y}H${x + r}M${x} ${y - r}V${y + r}`;
      else if (style.marker === "x") d += `M${x - r} ${y - r}L${x + r} ${y + r}M${x + r} ${y - r}L${x - r} ${y + r}`;
      else if (style.marker === "s") d += `M${x - r} ${y - r}h${2 * r}v${2 * r}h${-2 * r}Z`;
      else d += `M${x - r} ${y}a${r} ${r} 0 1 0 ${2 * r} 0a${r} ${r} 0 1 0 ${-2 * r} 0Z`;
    }
    return d;
  }
  at(time) {
    const { pictures } = this;
    if (!pictures) return;
    const { times } = pictures;
    let frame = 0, last = times.length - 1;
    while (frame < last && times[frame + 1] <= time) frame++;
    const next = Math.min(frame + 1, last), way = times[next] - times[frame];
    const share = way > 0 ? Math.max(0, Math.min(1, (time - times[frame]) / way)) : 0;
    for (const { node, track, kind, style, outline, markers } of this.nodes) {
      const own = frame - track.first;
      const there = own >= 0 && own < track.count;
      node.setAttribute("visibility", there ? "visible" : "hidden");
      if (!there) continue;
      const begin = own * track.width, then = own + 1 < track.count ? begin + track.width : begin, numbers = [];
      for (let k = 0; k < track.width; k++)
        numbers.push(track.values[begin + k] + share * (track.values[then + k] - track.values[begin + k]));
      if (kind === "text") {
        const scale = pictures.machine.scale.outline;
        const x = numbers[0] + numbers[2] / scale * this.point, y = numbers[1] - numbers[3] / scale * this.point;
        node.setAttribute("transform", `translate(${x} ${y})${style.turn ? ` rotate(${-style.turn})` : ""}`);
      } else if (markers) node.setAttribute("d", this.markers(outline < 0 ? numbers : this.moved(outline, numbers), style));
      else if (outline >= 0) {
        const scale = pictures.machine.scale.turn, [a, b] = [numbers[0] / scale, numbers[1] / scale];
        node.setAttribute("transform", `matrix(${a} ${b} ${-b} ${a} ${numbers[2]} ${numbers[3]})`);
      } else node.setAttribute("d", this.line(numbers, 1, kind) + (style.arrow ? this.head(numbers) : ""));
    }
  }
  head(numbers) {
    const [x, y] = numbers.slice(-2), [u, v] = numbers.slice(-4, -2), way = Math.hypot(x - u, y - v) || 1;
    const a = 6 * this.point * (x - u) / way, b = 6 * this.point * (y - v) / way;
    return `M${x - a - b / 2} ${y - b + a / 2}L${x} ${y}L${x - a + b / 2} ${y - b - a / 2}`;
  }
}
