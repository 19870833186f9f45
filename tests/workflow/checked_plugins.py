"""Plugins for the tests of the checks: good ones, and a way to break them line by line."""

from __future__ import annotations

from pathlib import Path

from contwalk.plugin_check.system import Finding, check_reference

PENDULUMS = """\
import math
from contwalk.system import (
    Mode, Neutral, Observable, Parameter, Start, State, Symmetry, System
)

def field(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = -p.g * math.sin(x[0]) - p.c * x[1] + p.k * x[2]
    dx[2] = -x[2] + x[0] ** 3

def mirror(t, x, p, x_image):
    x_image[0] = -x[0]
    x_image[1] = -x[1]
    x_image[2] = -x[2]

def shift(t, x, p, v):
    v[0] = 1.0
    v[1] = 0.0
    v[2] = 0.0

def swing(t, x, p):
    return x[:, 0].max() - x[:, 0].min()

def hanging(p):
    return [[0.0, 0.0, 0.0]]

SYSTEM = System(
    name="pendulums",
    states=(
        State("angle", unit="rad", about="from below"),
        State("speed", unit="rad/s", about="rate of the angle"),
        State("drive", unit="1", about="follows the angle"),
    ),
    parameters=(
        Parameter("g", 9.81, unit="m/s^2", bounds=(0.0, None), about="gravity"),
        Parameter("c", 0.1, unit="1/s", bounds=(0.0, 5.0), about="damping"),
        Parameter("k", 0.0, unit="1/s^2", about="gain"),
    ),
    modes=(Mode("free", field),),
    symmetries=(Symmetry("mirror", "spatial", mirror),),
    neutral=(Neutral("shift", shift),),
    observables=(Observable("swing", swing, unit="rad"),),
    starts=(Start("hanging", hanging),),
    presets={"damped": {"c": 4.0}},
    reference="any textbook",
)
"""

IMPACT = """\
import math
from contwalk.system import Mode, Observable, Parameter, State, System, Transition

def field(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = p.force * math.cos(p.omega * t) - 2.0 * p.zeta * x[1] - x[0]

def clearance(t, x, p):
    return p.gap - x[0]

def rebound(t, x, p, x_plus):
    x_plus[0] = x[0]
    x_plus[1] = -p.restitution * x[1]

def period(p):
    return 2.0 * math.pi / p.omega

SYSTEM = System(
    name="impact",
    states=(State("q", unit="m", about="displacement"), State("v", unit="m/s", about="velocity")),
    parameters=(
        Parameter("zeta", 0.1, unit="1", about="damping ratio"),
        Parameter("omega", 1.3, unit="rad/s", about="frequency"),
        Parameter("force", 0.3, unit="m/s^2", about="amplitude"),
        Parameter("gap", 1.0, unit="m", about="clearance"),
        Parameter("restitution", 0.8, unit="1", about="of the stop"),
    ),
    modes=(Mode("free", field),),
    transitions=(
        Transition("impact", source="free", target="free", guard=clearance, reset=rebound),
    ),
    period=period,
    reference="any textbook",
)
"""


def broken(source: str, old: str, new: str) -> str:
    """The plugin with one place changed."""
    assert source.count(old) == 1, f"{old!r} occurs {source.count(old)} times"
    return source.replace(old, new)


def line_of(source: str, text: str) -> int:
    """The first line that contains a text."""
    return next(number for number, line in enumerate(source.splitlines(), start=1) if text in line)


def checked(folder: Path, source: str) -> list[Finding]:
    """What the check of a plugin with this source finds."""
    path = folder / "my_model.py"
    path.write_text(source, encoding="utf-8")
    findings = check_reference(str(path))
    assert findings
    assert all(finding.file in (None, str(path)) for finding in findings)
    return findings


def troubles(findings: list[Finding]) -> list[Finding]:
    """Warnings and errors."""
    return [finding for finding in findings if finding.level != "ok"]
