// Phase planes by row of a branch, and how one is drawn behind a phase portrait.
const planesOf = new Map();

function planes(branch) {
  if (planesOf.has(branch)) return planesOf.get(branch);
  const data = block(`planes ${branch}`), found = new Map();
  planesOf.set(branch, found);
  if (!data) return found;
  const { header } = data, numbers = new Numbers(data.body), { place: levels, turn, arrows } = header;
  let before = null;
  for (const { row, window, curves, rests } of header.planes) {
    const [left, right, low, high] = window, field = numbers.table(arrows * arrows, 1, before);
    before = field;
    found.set(row, { window, rests, turn, arrows, field, curves: curves.map(([kind, count]) => {
      const table = numbers.table(count, 2, null), places = [];
      for (let k = 0; k < count; k++)
        places.push([left + (right - left) * table[2 * k] / levels, low + (high - low) * table[2 * k + 1] / levels]);
      return { kind, places };
    }) });
  }
  return found;
}

// `flip`: the second state stands across, the first upwards.
function drawPlane(group, axes, plane, flip) {
  group.replaceChildren();
  if (!plane) return;
  const at = ([x, y]) => flip ? [axes.px(y), axes.py(x)] : [axes.px(x), axes.py(y)];
  const { window: [left, right, low, high], arrows, turn, field } = plane;
  const { width, height } = axes.inner(), half = 0.36 * Math.sqrt(width * height) / arrows;
  let d = "";
  field.forEach((direction, k) => {
    if (direction === turn) return;
    const column = k % arrows, line = (k - column) / arrows, angle = 2 * Math.PI * direction / turn;
    const [x, y] = at([left + (right - left) * column / (arrows - 1), low + (high - low) * line / (arrows - 1)]);
    // Directions are those in a square window.
    let [u, v] = [width * Math.cos(angle), -height * Math.sin(angle)];
    if (flip) [u, v] = [width * Math.sin(angle), -height * Math.cos(angle)];
    const scale = half / (Math.hypot(u, v) || 1);
    [u, v] = [u * scale, v * scale];
    const p = number => number.toFixed(1);
    d += `M${p(x - u)} ${p(y - v)}L${p(x + u)} ${p(y + v)}M${p(x + 0.3 * u - 0.4 * v)} ${p(y + 0.3 * v + 0.4 * u)}L${p(x + u)} ${p(y + v)}L${p(x + 0.3 * u + 0.4 * v)} ${p(y + 0.3 * v - 0.4 * u)}`;
  });
  element("path", { class: "field", d }, group);
  for (const { kind, places } of plane.curves)
    element("path", { class: kind, d: places.map((place, k) => `${k ? "L" : "M"}${at(place).map(each => each.toFixed(1)).join(" ")}`).join("") }, group);
  for (const [x, y, stable] of plane.rests) {
    const [cx, cy] = at([x, y]);
    element("circle", { class: `rest-point${stable ? "" : " hollow"}`, cx, cy, r: 4.5 }, group);
  }
}
