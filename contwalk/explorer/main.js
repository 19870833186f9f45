// The page: what is chosen, how it moves, keys.
const data = block("head").header;
const byName = new Map(data.branches.map(branch => [branch.name, branch]));
const get = id => document.getElementById(id);
const diagrams = [];
const spectrum = new Spectrum(get("spectrum-svg"));
const portrait = new Curve(get("portrait-svg"));
const series = new Curve(get("series-svg"));
const machine = new Machine(get("machine-svg"));
let chosen = null, motion = null, phase = 0, playing = false, preview = 0, since = null;

function locate(name) {
  const [branchName, pointName] = name.split(/\/(.*)/), branch = byName.get(branchName);
  if (!branch || !branch.count) return null;
  if (pointName === undefined) return { name: branchName, branch, row: null, at: [0, 0] };
  if (/^\d+$/.test(pointName)) {
    const row = Number(pointName);
    return row < branch.count ? { name, branch, row, at: [row, 0] } : null;
  }
  const point = branch.points.find(each => each.name === pointName);
  return point ? { name, branch, row: point.index, point, at: point.at } : null;
}

function choose(name, quietly = false) {
  const found = locate(name);
  if (!found) return;
  chosen = found;
  document.body.dataset.selected = name;
  for (const each of document.querySelectorAll("[aria-current]")) each.removeAttribute("aria-current");
  for (const each of document.querySelectorAll("button[data-point],button[data-branch]"))
    if (each.dataset.point === name || each.dataset.branch === name) each.setAttribute("aria-current", "true");
  for (const diagram of diagrams) diagram.show(found.row === null ? { ...found, name: null } : found);
  if (found.row === null) { tellBranch(found.branch); follow(null); spectrum.show([], found.branch.orbit); }
  else {
    const words = block(`words ${found.branch.name}`).header;
    tell(found.point ? words.points[found.point.name] : words.rows[found.row]);
    spectrum.show(found.point ? found.point.spectrum : found.branch.spectrum[found.row], found.branch.orbit);
    follow(found);
  }
  get("spectrum-title").textContent = found.branch.orbit ? "Multipliers" : "Eigenvalues";
  get("said").textContent = name;
  command(found);
  if (!quietly && motion && motion.times.length && !matchMedia("(prefers-reduced-motion: reduce)").matches) {
    preview = 2;
    since = null;
  }
}

function tellBranch(branch) {
  const lines = [branch.problem, branch.origin, `${branch.count} points`, branch.ended].filter(Boolean);
  tell([branch.name, lines, [[["point", "what", "where"], branch.points.map(each => [each.name, each.what, each.where]), ""]]]);
}

function command(found) {
  const point = found.row === null ? "" : ` ${found.name}`;
  const words = found.row === null ? `contwalk show ${data.command.file} ${found.name}`
    : `contwalk continue ${data.command.run} --set ${data.command.start.replace("@", found.name)} --output ${data.command.output.replace("@", found.name.replace("/", "_"))}`;
  get("command").textContent = words;
  get("command").dataset.of = point;
}

function fill(select, entries, value) {
  select.replaceChildren(...entries.map(([key, text]) => Object.assign(html("option", text), { value: key })));
  select.value = value;
}

function follow(found) {
  motion = found ? motions(found.branch.name).get(found.row) || null : null;
  phase = 0;
  preview = 0;
  turn(false);
  const branch = found ? found.branch : null, states = data.states;
  machine.show(motion && motion.pictures ? motion.pictures : null);
  const still = branch && !branch.orbit;
  document.body.classList.toggle("rest", !(motion && motion.times.length));
  get("without").textContent = !found || motion && motion.times.length || still ? "" :
    branch.plane ? "A curve in two parameters holds no motion." : "The motion of this point cannot be shown.";
  redraw();
}

function redraw() {
  if (!chosen) return;
  const x = get("portrait-x").value, y = get("portrait-y").value, z = get("series-y").value;
  const read = name => motion && motion.times.length ? motion.states[motion.names.indexOf(name)] : atRest(name);
  const xs = read(x), ys = read(y), zs = read(z), times = motion && motion.times.length ? motion.times : [0];
  const broken = k => times[k] === times[k - 1];
  portrait.broken = series.broken = broken;
  // At rest: where it stands among all points of its branch.
  const column = name => chosen && chosen.row !== null ? columnOf(chosen.branch, name) : null;
  const own = chosen && chosen.row !== null ? planes(chosen.branch.name).get(chosen.row) || null : null;
  portrait.plane = own && get("show-field").checked && x !== y ? own : null;
  portrait.flip = x === data.states[1];
  get("field-choice").hidden = !own;
  get("field-key").hidden = !portrait.plane;
  const along = !portrait.plane && !(motion && motion.times.length) && column(x) && column(y);
  portrait.still = along ? [between(column(x), chosen.at), between(column(y), chosen.at)] : null;
  if (along) portrait.broken = () => false;
  portrait.path.classList.toggle("pale", Boolean(along));
  portrait.show(along ? column(x) : xs, along ? column(y) : ys, [x, y], []);
  series.show(times, zs, [data.time, z], motion && motion.times.length ? motion.events : []);
  show(phase);
}

function atRest(name) {
  const column = chosen && chosen.row !== null ? columnOf(chosen.branch, name) : null;
  return column ? [between(column, chosen.at)] : [NaN];
}

function show(time) {
  machine.at(time);
  const move = motion && motion.times.length, times = move ? motion.times : [0];
  let low = 0, high = times.length - 1;
  while (high - low > 1) {
    const middle = low + high >> 1;
    if (times[middle] <= time) low = middle; else high = middle;
  }
  const way = times[high] - times[low], share = way > 0 ? Math.min(1, (time - times[low]) / way) : 0;
  const value = values => values[low] + share * (values[high] - values[low]);
  if (portrait.still) portrait.at(...portrait.still, false);
  else if (portrait.xs) portrait.at(value(portrait.xs), value(portrait.ys), false);
  if (series.xs) series.at(time, value(series.ys), Boolean(move));
  get("time").value = move ? Math.round(1000 * time / motion.period) : 0;
  get("clock").textContent = move ? `${time.toPrecision(4)} of ${motion.period.toPrecision(6)}` : "at rest";
}

function turn(on) {
  playing = on;
  since = null;
  get("play").setAttribute("aria-pressed", String(on));
  get("play").textContent = on ? "Pause" : "Play";
}

function tick(now) {
  if ((playing || preview > 0) && motion && motion.times.length) {
    if (since !== null) {
      // A period lasts as long as it does where that is 1 to 6 s, so that one can follow it.
      const lasts = Math.min(6, Math.max(1, motion.period)) / Number(get("speed").value);
      const passed = (now - since) / 1000 * motion.period / lasts;
      phase += passed;
      if (!playing) preview -= passed / motion.period;
      if (!playing && preview <= 0) { preview = 0; phase = 0; }
      phase %= motion.period;
      show(phase);
    }
    since = now;
  } else since = null;
  requestAnimationFrame(tick);
}

function walk(step) {
  if (!chosen) { const first = data.branches.find(branch => branch.count); if (first) choose(`${first.name}/0`); return; }
  const row = chosen.row === null ? 0 : Math.max(0, Math.min(chosen.branch.count - 1, chosen.row + step));
  choose(`${chosen.branch.name}/${row}`, true);
}

function keys(event) {
  const own = event.target.closest("select, input, textarea, summary, [contenteditable]");
  if (own || event.ctrlKey || event.altKey || event.metaKey) return;
  const stands = event.target.closest("[data-point],[data-row],[data-branch]");
  if (event.key === "ArrowLeft" || event.key === "ArrowRight") { walk(event.key === "ArrowRight" ? 1 : -1); event.preventDefault(); }
  else if (event.key === " " && (stands || !event.target.closest("button, a"))) {
    if (stands && (stands.dataset.point || stands.dataset.row) !== document.body.dataset.selected)
      choose(stands.dataset.point || stands.dataset.row || stands.dataset.branch, true);
    preview = 0;
    turn(!playing);
    event.preventDefault();
  } else if ("+=-0".includes(event.key)) for (const diagram of diagrams) {
    if (event.key === "0") diagram.reset(); else diagram.axes.zoom(event.key === "-" ? 1.25 : 0.8);
    event.preventDefault();
  }
}

function list() {
  const nav = get("branches");
  for (const branch of data.branches) {
    const item = html("li"), name = html("button", branch.name, `chip b${data.branches.indexOf(branch) % 7}`);
    name.dataset.branch = branch.name;
    name.addEventListener("click", () => choose(branch.name));
    item.append(name, html("span", `${branch.problem}, ${branch.count} points`, "about"));
    for (const point of branch.points) {
      const chip = html("button", point.name, "point");
      chip.dataset.point = `${branch.name}/${point.name}`;
      chip.title = `${point.what}, ${point.where}`;
      chip.addEventListener("click", () => choose(chip.dataset.point));
      item.append(chip);
    }
    nav.append(item);
  }
}

// What labels mean, and how the file was made.
function making({ facts, config }) {
  const used = new Set(data.branches.flatMap(branch => branch.points.map(point => point.label)));
  for (const [label, meaning] of Object.entries(data.meanings || {}))
    if (used.has(label)) get("labels").append(html("li", `${label} ${meaning}`));
  get("making").hidden = !facts;
  if (!facts) return;
  for (const fact of facts) get("made").append(html("li", fact));
  get("config").textContent = config;
}

function begin() {
  get("system").textContent = data.system;
  get("model").textContent = [data.model, data.file].filter(Boolean).join(" · ");
  for (const text of [...data.made, ...data.notes, ...data.missing]) get("notes").append(html("li", text));
  list();
  making(data.making || {});
  for (const [id, panel] of [["diagram", data.diagram], ["plane", data.plane]]) {
    get(`${id}-panel`).hidden = !panel;
    if (!panel) continue;
    if (id === "plane") panel.chart = block("chart");
    const made = new Diagram(get(id), data, panel, choose);
    if (made.chart) made.chart.key(get("chart-key"));
    fill(get(`${id}-x`), panel.x, made.x);
    fill(get(`${id}-y`), panel.y, made.y);
    get(`${id}-x`).addEventListener("change", event => made.across(event.target.value));
    get(`${id}-y`).addEventListener("change", event => made.upwards(event.target.value));
    for (const [what, act] of [["in", () => made.axes.zoom(0.7)], ["out", () => made.axes.zoom(1 / 0.7)], ["all", () => made.reset()]])
      get(`${id}-${what}`).addEventListener("click", act);
    diagrams.push(made);
    made.reset();
  }
  document.body.classList.toggle("both", Boolean(data.diagram && data.plane));
  document.body.classList.toggle("draws", data.draws);
  const states = data.states.map(name => [name, name]);
  fill(get("portrait-x"), states, data.states[0]);
  fill(get("portrait-y"), states, data.states[Math.min(1, states.length - 1)]);
  fill(get("series-y"), states, data.states[0]);
  data.states.slice(0, 2).forEach((name, k) => get(`null${k}`).textContent = `${name}\u2032 = 0`);
  for (const id of ["portrait-x", "portrait-y", "series-y", "show-field"]) get(id).addEventListener("change", redraw);
  get("play").addEventListener("click", () => { preview = 0; turn(!playing); });
  get("time").addEventListener("input", event => {
    preview = 0;
    turn(false);
    phase = motion ? motion.period * Number(event.target.value) / 1000 : 0;
    show(phase);
  });
  get("error").textContent = data.error ? `Orbits are integrated once more and drawn within ${(100 * data.error).toPrecision(2)} % of each state's range; numbers are the stored ones.` : "Numbers are the stored ones.";
  get("theme").addEventListener("click", () => {
    const dark = document.documentElement.dataset.theme === "dark" || !document.documentElement.dataset.theme && matchMedia("(prefers-color-scheme: dark)").matches;
    document.documentElement.dataset.theme = dark ? "light" : "dark";
  });
  get("copy").addEventListener("click", async () => {
    const text = get("command").textContent;
    try { await navigator.clipboard.writeText(text); } catch {
      const range = document.createRange();
      range.selectNodeContents(get("command"));
      getSelection().removeAllRanges();
      getSelection().addRange(range);
      document.execCommand("copy");
    }
    get("copy").textContent = "Copied";
    setTimeout(() => { get("copy").textContent = "Copy"; }, 1500);
  });
  document.addEventListener("keydown", keys);
  new ResizeObserver(() => {
    for (const diagram of diagrams) diagram.resize();
    spectrum.draw();
    machine.show(motion && motion.pictures ? motion.pictures : machine.pictures || null);
    if (data.basin) drawBasin(data.basin);
    redraw();
  }).observe(document.querySelector("main"));
  const query = new URLSearchParams(location.search), asked = query.get("point");
  try { if (query.has("seen")) seeAgain(query.get("seen")); } catch { /* an address that somebody has written: all is shown */ }
  const first = data.branches.find(branch => branch.count);
  const ranked = first ? [...first.points].filter(point => point.label !== "EP").sort((a, b) => rank(a) - rank(b)) : [];
  const special = ranked[0];
  if (asked && locate(asked)) choose(asked, true);
  else {
    if (asked) get("notes").append(html("li", `There is no point named ${asked}.`));
    if (first) choose(special ? `${first.name}/${special.name}` : `${first.name}/0`, true);
  }
  if (data.margins || data.basin) pushed(data, machine);
  requestAnimationFrame(tick);
}

// What one looks at, for the page that comes in place of this one: axes, how far one has zoomed, the chosen states.
const CHOICES = ["portrait-x", "portrait-y", "series-y"];
function seen() {
  const shown = diagrams.map(({ svg, x, y, zoomed, axes }) => [svg.id, x, y, zoomed ? axes.view : null]);
  return { shown, chosen: CHOICES.map(id => [id, get(id).value]), theme: document.documentElement.dataset.theme || "",
    scroll: [scrollX, scrollY] };
}

function seeAgain(text) {
  const before = JSON.parse(text);
  const offers = (id, value) => [...get(id).options].some(option => option.value === value);
  for (const [id, x, y, view] of before.shown || []) {
    const diagram = diagrams.find(each => each.svg.id === id);
    if (!diagram || !offers(`${id}-x`, x) || !offers(`${id}-y`, y)) continue;
    get(`${id}-x`).value = x;
    get(`${id}-y`).value = y;
    diagram.across(x);
    diagram.upwards(y);
    if (!view || ![...view.x, ...view.y].every(Number.isFinite)) continue;
    diagram.axes.view = view;
    diagram.axes.redraw();
  }
  for (const [id, value] of before.chosen || []) if (CHOICES.includes(id) && offers(id, value)) get(id).value = value;
  if (["light", "dark"].includes(before.theme)) document.documentElement.dataset.theme = before.theme;
  if (before.scroll) requestAnimationFrame(() => scrollTo(...before.scroll));
}

// A page that is served looks now and then whether its database has grown, and is loaded anew where it is.
function watch() {
  if (!data.watched) return;
  setInterval(async () => {
    try {
      const answer = await fetch("state", { cache: "no-store" });
      if (!answer.ok || await answer.text() === data.watched || playing) return;
      const name = document.body.dataset.selected, again = new URLSearchParams({ seen: JSON.stringify(seen()) });
      if (name) again.set("point", name);
      location.replace(`?${again}`);
    } catch { /* the server has ended: what is shown stays */ }
  }, 1000);
}

begin();
watch();
