// How far a motion may be pushed: a table of bars to click on; the machine and the facts of a push.
function pushed(data, machine) {
  document.body.classList.add("pushed", "rest");
  get("margins-panel").hidden = !data.margins.rows.length;
  get("basin-panel").hidden = !data.basin;
  const { instants, rows } = data.margins, found = data.draws ? motions("margins") : new Map();
  const show = (number, title, lines) => {
    const at = instants[number];
    tell([title, [...lines, at.title, at.mode ? `mode ${at.mode}` : ""].filter(Boolean),
      [[["state", "value", "unit"], at.states, "where it is pushed"]]]);
    machine.show(found.has(number) ? found.get(number).pictures : null);
  };
  const table = html("table"), head = html("tr"), second = html("tr"), body = html("tbody"), top = html("thead");
  head.append(Object.assign(html("th", "state"), { rowSpan: 2, scope: "col" }));
  instants.forEach(at => {
    head.append(Object.assign(html("th", at.title), { colSpan: 2, scope: "colgroup" }));
    for (const way of ["down", "up"]) second.append(Object.assign(html("th", way), { scope: "col" }));
  });
  top.append(head, second);
  for (const state of new Set(rows.map(row => row.state))) {
    const line = html("tr");
    line.append(Object.assign(html("th", state), { scope: "row" }));
    instants.forEach((_, number) => {
      for (const up of [false, true]) {
        const row = rows.find(each => each.state === state && each.instant === number && each.up === up);
        const cell = html("td", "", up ? "up" : "down");
        if (row) cell.append(push(row, number, show));
        line.append(cell);
      }
    });
    body.append(line);
  }
  table.append(top, body);
  get("margins").append(table);
  if (data.basin) keyOfBasin(data.basin);
  if (instants.length) show(0, data.system, []);
}

function push(row, number, show) {
  const way = row.up ? "up" : "down", name = `${number}/${row.state}/${way}`;
  const button = html("button", row.text, [row.several ? "several" : "", row.open ? "open" : ""].join(" ").trim());
  button.dataset.push = name;
  button.setAttribute("aria-label", `${row.state} pushed ${way}: ${row.facts[0]}`);
  const bar = html("i");
  bar.style.width = `${100 * row.share}%`;
  button.append(bar);
  button.addEventListener("click", () => {
    for (const each of document.querySelectorAll("[aria-current]")) each.removeAttribute("aria-current");
    button.setAttribute("aria-current", "true");
    document.body.dataset.selected = name;
    get("said").textContent = `${row.state} pushed ${way}`;
    show(number, `${row.state} pushed ${way}`, row.facts);
  });
  return button;
}

function keyOfBasin(basin) {
  basin.names.forEach((name, k) => get("basin-key").append(html("li", name, `b${k % 7}`)));
  drawBasin(basin);
}

let basinAxes = null;
function drawBasin(basin) {
  if (!basinAxes) { basinAxes = new Axes(get("basin"), () => drawBasin(basin)); basinAxes.interactive(); }
  const axes = basinAxes;
  axes.measure();
  if (!axes.fitted) { axes.fit(basin.x, basin.y); axes.fitted = true; }
  axes.drawFrame(...basin.states);
  axes.inside.replaceChildren();
  const outlines = basin.names.map(() => "");
  basin.x.forEach((x, k) => { outlines[basin.labels[k]] += `M${axes.px(x).toFixed(1)} ${axes.py(basin.y[k]).toFixed(1)}m-2.5-2.5h5v5h-5Z`; });
  outlines.forEach((d, k) => element("path", { class: `place b${k % 7}`, d }, axes.inside));
}
