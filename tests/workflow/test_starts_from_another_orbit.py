"""A stored orbit is taken up as itself: where the corrector comes to another one, the start is refused."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from contwalk.workflow import starting
from contwalk.workflow.run_file.reading import read_run_file
from contwalk.workflow.runner import run
from contwalk.workflow.stored.points import stored_point

# Cycles of radius 1 and 2, which go round in 2 pi and in 56 pi / 31.
PLUGIN = """
from contwalk.system import Mode, Parameter, State, System

def field(t, x, p, dx):
    square = x[0] ** 2 + x[1] ** 2
    radial, turning = p.a * (1.0 - square) * (square - 4.0), (square + 27.0) / 28.0 + p.b
    dx[0] = radial * x[0] - turning * x[1]
    dx[1] = turning * x[0] + radial * x[1]

SYSTEM = System(
    name="rings",
    states=(State("x"), State("y")),
    parameters=(Parameter("a", 1.0), Parameter("b", 0.0)),
    modes=(Mode("smooth", field),),
)
"""
RUN = """
contwalk: 1
system: ./rings.py
start: START
continue: {parameter: a, range: [-0.04, -0.01]}
parameters: {a: -0.02}
diagram: none
output: NAME.h5
"""
FIRST = "{simulate: {state: {x: 0.9, y: 0.0}, until: settled}}"


def study(folder, name, start):
    text = RUN.replace("START", start).replace("NAME", str(folder / name))
    if "from:" in start:
        text = text.replace("parameters: {a: -0.02}\n", "")
    (folder / f"{name}.yaml").write_text(text)
    return run(read_run_file(folder / f"{name}.yaml"))


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("rings")
    (folder / "rings.py").write_text(PLUGIN)
    study(folder, "first", FIRST)
    return folder


def test_a_stored_orbit_is_taken_up(folder):
    (branch,) = study(folder, "again", "{from: first.h5, point: b1/3}").branches
    assert branch.outcome.status != "failed"


def test_what_has_another_period_is_refused(folder, monkeypatch):
    """The state read is one of the other cycle, as if growing deviations had led there."""

    def elsewhere(*given):
        return replace(stored_point(*given), state=np.array([2.0, 0.0]))

    monkeypatch.setattr(starting, "stored_point", elsewhere)
    (branch,) = study(folder, "other", "{from: first.h5, point: b1/3}").branches
    assert (branch.outcome.status, branch.outcome.reason) == ("failed", "no_convergence")
    assert "has the period 6.28319, and from its state the corrector comes to one with 5.67514" in (
        branch.outcome.message
    )
    # With another parameter it is another orbit that is asked for.
    (branch,) = study(folder, "changed", "{from: first.h5, point: b1/3, parameters: {b: 0.5}}").branches
    assert branch.outcome.status != "failed"
