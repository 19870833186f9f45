"""The small study that is maltreated, and systems whose numbers are at their limits."""

from __future__ import annotations

from pathlib import Path

PLUGIN = """
from contwalk.system import Mode, Parameter, State, System

def field(t, x, p, dx):
    r = x[0] ** 2 + x[1] ** 2
    dx[0] = p.a * x[0] - x[1] - r * x[0]
    dx[1] = x[0] + p.a * x[1] - r * x[1]

SYSTEM = System(
    "cycle",
    states=(State("x"), State("y")),
    parameters=(Parameter("a", -0.5),),
    modes=(Mode("only", field),),
)
"""
RUN = """\
contwalk: 1
system: ./cycle.py
start: {state: {x: 0.0, y: 0.0}}
continue: {parameter: a, range: [-0.6, 0.2]}
diagram: {follow: [HB], depth: 1}
simulate: {until: 3.0, points: 20}
margins: {of: {from: study.h5, point: b2/3}, survive: {periods: 1}, states: [x], instants: 1, accuracy: 0.2}
output: study.h5
"""
STRESSED = """
import math

from contwalk.system import Mode, Parameter, State, System

def field(t, x, p, dx):
    dx[0] = {field}

SYSTEM = System(
    "stressed", states=(State("x"),), parameters=(Parameter("a", {at}),), modes=(Mode("only", field),)
)
"""
STRESSED_RUN = """\
system: ./stressed.py
start: {{{start}}}
continue: {{parameter: a, range: [{low}, {high}], max_points: 40}}
output: stressed.h5
"""
# Fields of one state, and parameter values; each is tried at several magnitudes of state and parameter.
FIELDS = {
    "p.a - x[0]": 1.0,
    "p.a - x[0] ** 2": 1.0,
    "p.a - x[0] ** 4": 1.0,
    "p.a * x[0] - x[0] ** 3": -1.0,
    "math.exp(x[0]) - p.a": 1.0,
    "math.log(x[0]) - p.a": 0.0,
    "1.0 / x[0] - p.a": 1.0,
    "math.sqrt(x[0]) - p.a": 1.0,
    "abs(x[0]) - p.a": 1.0,
    "p.a - x[0] / (1.0 + x[0] ** 200)": 0.5,
    "math.tan(x[0]) - p.a": 0.5,
    "p.a - math.hypot(x[0], 0.0)": 1.0,
    "p.a * 1e300 - x[0] * 1e300": 1.0,
    "p.a * 1e-300 - x[0] * 1e-300": 1.0,
    "0.0 * x[0] * p.a": 1.0,
}
MAGNITUDES = (1.0, 1e-9, 1e9, 1e150)


def write_study(folder: Path) -> None:
    """The plugin and its run file."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "cycle.py").write_text(PLUGIN, encoding="utf-8")
    (folder / "study.yaml").write_text(RUN, encoding="utf-8")


def write_stressed(folder: Path, field: str, at: float, size: float) -> None:
    """A stressed plugin whose state has a magnitude, and its run file."""
    folder.mkdir(parents=True, exist_ok=True)
    scaled = field.replace("x[0]", f"(x[0] / {size!r})")
    (folder / "stressed.py").write_text(STRESSED.format(field=scaled, at=at), encoding="utf-8")
    run = STRESSED_RUN.format(start=f"state: {{x: {size!r}}}", low=at - 2.0, high=at + 1.0)
    (folder / "stressed.yaml").write_text(run, encoding="utf-8")
