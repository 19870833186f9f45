"""A resonance whose peak just reaches a stop, or just does not: both grazings within one step, or none.

Damped oscillator under a force F cos(omega t): (F / a)^2 = (1 - omega^2)^2 + (2 zeta omega)^2 for the
amplitude a, which is largest at omega^2 = 1 - 2 zeta^2.
"""

from __future__ import annotations

import math
from pathlib import Path

import pytest

import contwalk as cw

ZETA, FORCE = 0.17, 0.3
SYSTEM = Path(__file__).parents[2] / "systems" / "impact_oscillator.py"
RUN = """
contwalk: 1
system: {system}
start: {{simulate: {{state: {{q: 0.0, v: 0.0}}, until: settled}}}}
parameters: {{omega: 0.6, zeta: {zeta!r}, gap: {gap!r}, force: {force!r}}}
continue: {{parameter: omega, range: [0.6, 1.4]}}
events: {{GR: ignore}}
"""


def amplitude(omega: float) -> float:
    """The amplitude of the motion without impacts."""
    return FORCE / math.hypot(1.0 - omega**2, 2.0 * ZETA * omega)


def grazings(folder: Path, gap: float) -> list[cw.SpecialPoint]:
    """What is told of a stop."""
    path = folder / "study.yaml"
    path.write_text(RUN.format(system=SYSTEM, zeta=ZETA, force=FORCE, gap=gap), encoding="utf-8")
    result = cw.run(cw.read_run_file(path, output=folder / "study.h5"), figures=False)
    return [p for p in result.branches[0].special_points if p.label == "GR"]


# From the depth that steps show to one that none but the finest do; between them it is beyond on these for
# longer than is looked at first, and less beyond on the others than they are known to.
@pytest.mark.parametrize("depth", [1e-3, 1e-5, 1e-6, 3e-7, 1e-8])
def test_both_grazings_about_a_peak_are_located(depth, tmp_path):
    gap = amplitude(math.sqrt(1.0 - 2.0 * ZETA**2)) * (1.0 - depth)
    b = 1.0 - 2.0 * ZETA**2
    aside = math.sqrt(b * b - 1.0 + (FORCE / gap) ** 2)
    found = grazings(tmp_path, gap)
    assert [p.kind for p in found] == ["interior", "interior"]
    for point, square in zip(found, (b - aside, b + aside), strict=True):
        assert abs(point.parameters["omega"] - math.sqrt(square)) <= 2.0 * point.error < 1e-8


@pytest.mark.parametrize("depth", [1e-3, 1e-6, 1e-8])
def test_a_peak_that_does_not_reach_the_stop_makes_none(depth, tmp_path):
    assert not grazings(tmp_path, amplitude(math.sqrt(1.0 - 2.0 * ZETA**2)) * (1.0 + depth))


FASTER = """
import math

from contwalk.system import Mode, Parameter, State, System, Transition

RATE, FORCE, ZETA = {rate!r}, {force!r}, {zeta!r}


def field(t, x, p, dx):
    dx[0] = RATE * x[1]
    dx[1] = RATE * (FORCE * math.cos(p.omega * RATE * t) - 2.0 * ZETA * x[1] - x[0])


def rebound(t, x, p, out):
    out[0] = x[0]
    out[1] = -0.8 * x[1]


SYSTEM = System(
    "oscillator",
    states=(State("q"), State("v")),
    parameters=(Parameter("omega", 0.6), Parameter("gap", {gap!r})),
    modes=(Mode("free", field),),
    transitions=(Transition("hit", "free", "free", lambda t, x, p: p.gap - x[0], reset=rebound),),
    period=lambda p: 2.0 * math.pi / (p.omega * RATE),
)
"""
FAST_RUN = """
contwalk: 1
system: ./oscillator.py
start: {simulate: {state: {q: 0.0, v: 0.0}, until: settled}}
continue: {parameter: omega, range: [0.6, 1.4]}
events: {GR: ignore}
"""


@pytest.mark.parametrize("rate", [1e-4, 700.0])
def test_both_are_located_in_any_unit_of_time(rate, tmp_path):
    """The time at which a force's period begins was known to a part of a second, and so were the motions."""
    gap = amplitude(math.sqrt(1.0 - 2.0 * ZETA**2)) * (1.0 - 1e-6)
    b = 1.0 - 2.0 * ZETA**2
    aside = math.sqrt(b * b - 1.0 + (FORCE / gap) ** 2)
    system = FASTER.format(rate=rate, force=FORCE, zeta=ZETA, gap=gap)
    (tmp_path / "oscillator.py").write_text(system, encoding="utf-8")
    (tmp_path / "study.yaml").write_text(FAST_RUN, encoding="utf-8")
    result = cw.run(cw.read_run_file(tmp_path / "study.yaml", output=tmp_path / "s.h5"), figures=False)
    found = [p for p in result.branches[0].special_points if p.label == "GR"]
    assert len(found) == 2
    for point, square in zip(found, (b - aside, b + aside), strict=True):
        assert abs(point.parameters["omega"] - math.sqrt(square)) <= 2.0 * point.error < 1e-8
    assert result.branches[0].points["error"].max() < 1e-5
