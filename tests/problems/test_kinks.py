"""Fields that are smooth by pieces only: noticed where solutions cross such a place."""

from __future__ import annotations

import numpy as np
import pytest

import contwalk as cw
from contwalk.storage import open_database
from contwalk.workflow.runner import Reporter

PLUGIN = """\
import math
import numpy as np
from contwalk.system import Mode, Parameter, State, System

def field(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = -x[0] - 0.4 * x[1] + p.F * math.cos(p.w * t) + {term}

SYSTEM = System("small", states=(State("y"), State("v")),
    parameters=(Parameter("F", 0.7), Parameter("w", 0.8), Parameter("D", 0.5)),
    modes=(Mode("only", field),), period=lambda p: 2 * math.pi / p.w)
"""
STILL = """\
import numpy as np
from contwalk.system import Mode, Parameter, State, System

def field(t, x, p, dx):
    dx[0] = p.a - x[0] - {term}

SYSTEM = System("small", states=(State("y"),), parameters=(Parameter("a", -1.0),), modes=(Mode("m", field),))
"""
START = "start: {state: {y: 0.0, v: 0.5}}\ncontinue: {parameter: %s, range: [0.4, 0.9], max_points: 4}\n"
LINE = "small.py, line 7"


class Kept(Reporter):
    def __init__(self):
        self.notes = []

    def note(self, text):
        self.notes.append(text)


def study(folder, plugin, run, **options):
    """The branch of a run, and the notes about kinks that came with it and are stored."""
    (folder / "small.py").write_text(plugin)
    (folder / "run.yaml").write_text(f"contwalk: 1\nsystem: ./small.py\n{run}")
    kept = Kept()
    result = cw.run(cw.read_run_file(folder / "run.yaml", output=folder / "run.h5"), reporter=kept, **options)
    with open_database(folder / "run.h5") as db:
        stored = [text for key, text in db.notes().items() if key.startswith("kink")]
    assert stored == [text for text in kept.notes if text in stored]
    return result.branches[0], stored


def orbits(folder, term, free="w"):
    return study(folder, PLUGIN.format(term=term), START % free, figures=False)


@pytest.mark.drawn(1)
@pytest.mark.parametrize(
    ("term", "what"),
    [
        ("-0.1 * np.sign(x[1])", "sign"),
        ("(0.2 if x[0] > 0.0 else 0.0)", "a comparison"),
        ("np.where(x[1] + p.D * x[0] > 0.0, -0.1, 0.1)", "a comparison"),
        ("0.3 * math.floor(2.0 * x[0])", "floor"),
        ("0.3 * (2.0 * x[0] % 1.0)", "floor"),
    ],
)
def test_orbits_that_cross_a_jump_of_the_field_are_refused(tmp_path, term, what):
    branch, _ = orbits(tmp_path, term)
    assert (branch.outcome.status, branch.outcome.reason) == ("failed", "plugin_error")
    assert f"{LINE} ({what})" in branch.outcome.message
    assert "Declare two modes" in branch.outcome.message
    assert len(branch) == 0


def test_orbits_that_reach_a_jump_on_the_way_end_before_it(tmp_path):
    # y = A cos(w t - phi) with A = F / |1 - w^2 + 0.4 i w| = 2.076 F at w = 0.8 reaches 1 at F = 0.4817
    largest = 1.0 / abs(1.0 - 0.64 + 0.32j)
    run = (START % "F").replace("max_points: 4", "max_points: 50")
    plugin = PLUGIN.format(term="(0.2 if x[0] > 1.0 else 0.0)").replace('"F", 0.7', '"F", 0.45')
    branch, _ = study(tmp_path, plugin, run, figures=False)
    assert branch.outcome.reason == "plugin_error"
    assert LINE in branch.outcome.message
    # Samples are a 512th of the period apart: a crest that passes 1 by (pi / 512)^2 / 2 may lie between two.
    assert abs(branch["F"].max() * largest - 1.0) < 2e-5
    assert (branch["stable"] == 1).all()


RATIO = "0.1 * ({u} / (np.exp({u}) - 1.0) if abs({u}) > {width} else 1.0 - 0.5 * ({u}))"


@pytest.mark.parametrize("width", [1e-4, 1e-6, 1e-9])
def test_another_formula_where_one_is_nought_over_nought_is_no_kink(tmp_path, width):
    """x / (exp x - 1): beside zero its derivatives are rounding, and the motion is there for no time."""
    branch, told = orbits(tmp_path, RATIO.format(u="(x[0] - 0.2)", width=width))
    assert branch.outcome.status != "failed"
    assert told == []


def test_a_layer_that_the_motion_is_in_for_a_while_is_told(tmp_path):
    branch, _ = orbits(tmp_path, "(5.0 if abs(x[0]) < 1e-3 else 0.0)")
    assert branch.outcome.reason == "plugin_error"
    assert f"{LINE} (a comparison)" in branch.outcome.message


def test_equilibria_pass_another_formula_for_nought_over_nought(tmp_path):
    plugin = STILL.format(term=RATIO.format(u="x[0]", width=1e-6))
    run = "start: {state: {y: -1.0}}\ncontinue: {parameter: a, range: [-1.0, 1.0]}\n"
    branch, told = study(tmp_path, plugin, run, figures=False)
    assert branch.outcome.status == "complete"
    assert told == []


@pytest.mark.drawn(3)
@pytest.mark.parametrize(
    ("term", "what", "means"),
    [
        ("-0.5 * max(x[0] - 0.3, 0.0)", "max", "slopes of the field jump"),
        ("-0.5 * abs(x[0])", "abs", "slopes of the field jump"),
        ("(-0.5 * x[0] if x[0] > 0.0 else 0.0)", "a comparison", "slopes of the field jump"),
        ("np.interp(x[0], [-1.0, 0.1, 1.0], [1.0, 0.0, -2.0])", "a table", "slopes of the field jump"),
        ("-0.1 * x[1] * abs(x[1])", "abs", "second derivatives of the field jump"),
        ("0.2 * np.sign(math.cos(p.w * t))", "sign", "an instant at which the field jumps"),
        ("0.1 * ((t * p.w / (2 * math.pi)) % 1.0)", "floor", "an instant at which the field jumps"),
    ],
)
def test_weaker_kinks_are_told_once_a_branch(tmp_path, term, what, means):
    branch, (told,) = orbits(tmp_path, term)
    assert branch.outcome.status != "failed"
    assert len(branch) > 1
    assert told.startswith("b1: ")
    assert f"{LINE} ({what})" in told
    assert means in told


@pytest.mark.drawn(2)
@pytest.mark.parametrize(
    "term",
    [
        "0.2 * abs(x[0] - 9.0)",  # never reached
        "0.2 * math.cos(x[0] % (2 * math.pi))",  # the same on both sides
        "np.where(abs(x[0]) < 1e-4, 1 - x[0]**2 / 6 + x[0]**4 / 120, np.sin(x[0]) / x[0])",  # a safe sinc
        "0.1 * x[1]**3 * abs(x[1])",  # third derivatives are continuous
        "-0.1 * max(x[0], 0.0)**4",
    ],
)
def test_nothing_is_told_where_nothing_jumps(tmp_path, term):
    branch, told = orbits(tmp_path, term)
    assert branch.outcome.status != "failed"
    assert told == []


def test_an_instant_that_the_free_parameter_moves_is_refused(tmp_path):
    pulse = "np.where((t * p.w / (2 * math.pi)) % 1.0 < p.D, 0.1, 0.0)"
    branch, _ = orbits(tmp_path, pulse, free="D")
    assert branch.outcome.reason == "plugin_error"
    assert LINE in branch.outcome.message


def test_a_motion_that_slides_along_a_jump_names_it(tmp_path):
    plugin = PLUGIN.format(term="-2.0 * np.sign(x[1])")  # more friction than force: it sticks
    for start in ("{state: {y: 0.0, v: 0.5}}", "{simulate: {state: {y: 0.0, v: 0.5}, until: settled}}"):
        run = (START % "w").replace("{state: {y: 0.0, v: 0.5}}", start)
        branch, _ = study(tmp_path, plugin, run, figures=False, force=True)
        assert branch.outcome.status == "failed"
        assert f"{LINE} (sign)" in branch.outcome.message


@pytest.mark.parametrize(
    "term", ["0.5 * max(x[0] - 0.3, 0.0)", "(0.5 * (x[0] - 0.3) if x[0] > 0.3 else 0.0)"]
)
def test_equilibria_that_cross_a_kink_are_told(tmp_path, term):
    run = "start: {state: {y: -1.0}}\ncontinue: {parameter: a, range: [-2.0, 2.0]}\n"
    branch, (told,) = study(tmp_path, STILL.format(term=term), run, figures=False)
    assert "small.py, line 5" in told
    assert "Eigenvalues jump" in told
    beyond = branch["a"] > 0.3
    assert np.allclose(branch["max_re"], np.where(beyond, -1.5, -1.0), rtol=1e-12)  # linear on both sides


def test_equilibria_that_lie_on_a_kink_are_told(tmp_path):
    plugin = STILL.format(term="0.5 * abs(x[0]) - p.a")
    run = "start: {state: {y: 0.0}}\ncontinue: {parameter: a, range: [-2.0, 2.0]}\n"
    _, (told,) = study(tmp_path, plugin, run, figures=False)
    assert "small.py, line 5 (abs)" in told
