"""A film as a page of HTML: frames and what plays them in one file, which asks no network for anything.

Frames are drawings (SVG), not pictures: sharp at any size, and small, since what frames have in common is
stored once. Each is a list of elements, of which it tells those that the frame before had not.
"""

from __future__ import annotations

import json
import re
from io import BytesIO
from pathlib import Path
from string import Template
from typing import Any

import matplotlib
from matplotlib.animation import AbstractMovieWriter
from matplotlib.figure import Figure

PAGE = Template("""\
<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<title>$title</title>
<style>
body { margin: 1em auto; max-width: ${width}px; font-family: sans-serif; color: #222222; background: white; }
#frame svg { display: block; width: 100%; height: auto; }
#controls { display: flex; gap: 0.5em; align-items: center; }
#place { flex: 1; }
button { min-width: 3em; font-size: 1em; }
</style>
</head>
<body>
<div id="frame" role="img" aria-label="$title"></div>
<div id="controls">
<button id="play" title="play or pause (space)" aria-label="play or pause">&#9208;</button>
<input id="place" type="range" min="0" max="$last" value="0" aria-label="frame (left and right keys)">
<select id="speed" aria-label="speed">
<option value="0.25">&#188; speed</option><option value="0.5">&#189; speed</option>
<option value="1" selected>speed 1</option><option value="2">speed 2</option>
</select>
</div>
<script>
/* A frame is a list of numbers of elements, or an object of those that differ from the frame before. */
const elements = $elements;
const changes = $changes;
const frames = [];
for (const change of changes)
  frames.push(Array.isArray(change) ? change : Object.assign([...frames[frames.length - 1]], change));
const drawing = number => frames[number].map(element => elements[element]).join("");
</script>
<script>
const interval = $interval;
const image = document.getElementById("frame"), place = document.getElementById("place");
const play = document.getElementById("play"), speed = document.getElementById("speed");
let at = 0, playing = true, since = null;
function show(number) {
  at = ((number % frames.length) + frames.length) % frames.length;
  image.innerHTML = drawing(at);
  place.value = at;
}
function turn(on) {
  playing = on;
  since = null;
  play.textContent = on ? "\\u23f8" : "\\u25b6";
}
function tick(now) {
  if (playing) {
    const lasting = interval / Number(speed.value);
    if (since === null) since = now;
    const passed = Math.floor((now - since) / lasting);
    if (passed > 0) { since += passed * lasting; show(at + passed); }
  }
  requestAnimationFrame(tick);
}
play.addEventListener("click", () => turn(!playing));
place.addEventListener("input", () => { turn(false); show(Number(place.value)); });
document.addEventListener("keydown", event => {
  if (event.target === speed) return;
  const way = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
  if (way) { turn(false); show(at + way); event.preventDefault(); }
  if (event.key === " ") { turn(!playing); event.preventDefault(); }
});
show(0);
requestAnimationFrame(tick);
</script>
</body>
</html>
""")

# Text stays text, and equal things have equal names in all frames.
_WRITING: dict[Any, Any] = {
    "svg.fonttype": "none",
    "svg.hashsalt": "contwalk",
    "font.sans-serif": ["DejaVu Sans", "Verdana", "sans-serif"],
}
_NAMESPACES = re.compile(r'\s+xmlns(?::\w+)?="[^"]*"')
_ASIDE = re.compile(r"<!--.*?-->|<metadata>.*?</metadata>", re.DOTALL)
_ELEMENT = re.compile(r"(<[^>]+>)([^<]*)")
_LONG_NUMBER = re.compile(r"-?\d+\.\d{3,}(?!\d*[a-zA-Z%])")


class PageWriter(AbstractMovieWriter):
    """Collects frames as drawings and writes the page when it is finished."""

    def __init__(self, fps: float, title: str) -> None:
        super().__init__(fps=fps)  # type: ignore[arg-type]
        self.title = title

    def setup(self, fig: Figure, outfile: str | Path, dpi: float | None = None) -> None:
        """Begin a film of a figure."""
        super().setup(fig, outfile, dpi)
        self.elements: dict[str, int] = {}
        self.frames: list[list[int]] = []

    def grab_frame(self, **kwargs: Any) -> None:
        """Keep what the figure shows now."""
        drawing = BytesIO()
        with matplotlib.rc_context(_WRITING):
            self.fig.savefig(drawing, format="svg", metadata={"Date": None}, **kwargs)
        found = elements_of(drawing.getvalue().decode("utf-8"))
        self.frames.append([self.elements.setdefault(element, len(self.elements)) for element in found])

    def finish(self) -> None:
        """Write the page."""
        text = PAGE.substitute(
            title=_escaped(self.title or "contwalk"),
            width=round(self.fig.get_figwidth() * self.dpi),
            last=len(self.frames) - 1,
            elements=_in_script(list(self.elements)),
            changes=_in_script(changes_of(self.frames)),
            interval=repr(1000.0 / self.fps),
        )
        Path(self.outfile).write_text(text, encoding="utf-8")


def elements_of(drawing: str) -> list[str]:
    """The elements of a drawing in SVG, as a page of HTML takes them; numbers to a hundredth of a point."""
    drawing = drawing[drawing.index("<svg") :]
    drawing = _ASIDE.sub("", drawing).replace("xlink:href", "href")
    found = _ELEMENT.findall(_NAMESPACES.sub("", drawing))
    return [re.sub(r"\s+", " ", _LONG_NUMBER.sub(_shortened, tag) + text) for tag, text in found]


def changes_of(frames: list[list[int]]) -> list[Any]:
    """Each frame as it is, or, where that is shorter, as what differs from the one before."""
    changes: list[Any] = []
    before: list[int] = []
    for frame in frames:
        different = {str(i): element for i, element in enumerate(frame) if before[i : i + 1] != [element]}
        changes.append(different if len(before) == len(frame) and 2 * len(different) < len(frame) else frame)
        before = frame
    return changes


def _shortened(number: re.Match[str]) -> str:
    """A number with as many digits as one sees."""
    value = float(number[0])
    return f"{round(value, 2):g}" if 1.0 <= abs(value) < 1e4 else f"{value:.4g}"


def _in_script(value: object) -> str:
    """A value as JSON that may stand in a script of a page: nothing in it ends the script."""
    return json.dumps(value, separators=(",", ":"), ensure_ascii=False).replace("<", "\\u003c")


def _escaped(text: str) -> str:
    for plain, written in (("&", "&amp;"), ("<", "&lt;"), (">", "&gt;"), ('"', "&quot;")):
        text = text.replace(plain, written)
    return text
