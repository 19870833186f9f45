"""A film as a page of HTML: frames and what plays them in one file, which asks no network for anything."""

from __future__ import annotations

import json
from base64 import b64encode
from io import BytesIO
from pathlib import Path
from string import Template
from typing import Any

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
img { display: block; width: 100%; }
#controls { display: flex; gap: 0.5em; align-items: center; }
#place { flex: 1; }
button { min-width: 3em; font-size: 1em; }
</style>
</head>
<body>
<img id="frame" alt="$title">
<div id="controls">
<button id="play" title="play or pause (space)" aria-label="play or pause">&#9208;</button>
<input id="place" type="range" min="0" max="$last" value="0" aria-label="frame (left and right keys)">
<select id="speed" aria-label="speed">
<option value="0.25">&#188; speed</option><option value="0.5">&#189; speed</option>
<option value="1" selected>speed 1</option><option value="2">speed 2</option>
</select>
</div>
<script>
const frames = [
$frames
];
const interval = $interval;
const image = document.getElementById("frame"), place = document.getElementById("place");
const play = document.getElementById("play"), speed = document.getElementById("speed");
let at = 0, playing = true, since = null;
function show(number) {
  at = ((number % frames.length) + frames.length) % frames.length;
  image.src = frames[at];
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


class PageWriter(AbstractMovieWriter):
    """Collects frames as PNG and writes the page when it is finished."""

    def __init__(self, fps: float, title: str) -> None:
        super().__init__(fps=fps)  # type: ignore[arg-type]
        self.title = title

    def setup(self, fig: Figure, outfile: str | Path, dpi: float | None = None) -> None:
        """Begin a film of a figure."""
        super().setup(fig, outfile, dpi)
        self.frames: list[str] = []

    def grab_frame(self, **kwargs: Any) -> None:
        """Keep what the figure shows now."""
        picture = BytesIO()
        self.fig.savefig(picture, format="png", dpi=self.dpi, **kwargs)
        self.frames.append(b64encode(picture.getvalue()).decode("ascii"))

    def finish(self) -> None:
        """Write the page."""
        text = PAGE.substitute(
            title=_escaped(self.title or "contwalk"),
            width=round(self.fig.get_figwidth() * self.dpi),
            last=len(self.frames) - 1,
            frames=",\n".join(json.dumps("data:image/png;base64," + frame) for frame in self.frames),
            interval=repr(1000.0 / self.fps),
        )
        Path(self.outfile).write_text(text, encoding="utf-8")


def _escaped(text: str) -> str:
    for plain, written in (("&", "&amp;"), ("<", "&lt;"), (">", "&gt;"), ('"', "&quot;")):
        text = text.replace(plain, written)
    return text
