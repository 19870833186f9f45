"""Equilibria that reach a guard of their mode (BE), against closed forms.

Source of the kinds: M. di Bernardo, C. J. Budd, A. R. Champneys, P. Kowalczyk, Piecewise-smooth Dynamical
Systems, Springer 2008, chapter 5.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

import contwalk as cw
from contwalk.branch import Branch

RUN = """
contwalk: 1
system: ./machine.py
start: {state: STATE, parameters: {F: BEGIN}}
continue: {parameter: F, range: RANGE}
events: {BE: ACTION}
diagram: {follow: FOLLOWED}
output: machine.h5
"""
STIFF = 50.0
HEAD = "from contwalk.system import Mode, Parameter, State, System, Transition\n"


def soft(x: str, other: str, guard: str, states: str = "x") -> str:
    """A plugin of two modes on either side of a guard."""
    names = ", ".join(f'State("{name}")' for name in states)
    return f"""{HEAD}
def above(t, x, p, dx):
{x}

def below(t, x, p, dx):
{other}

def guard(t, x, p):
    return {guard}

SYSTEM = System(name="machine", states=({names},), parameters=(Parameter("F", 1.0),),
    modes=(Mode("above", above), Mode("below", below)),
    transitions=(Transition("down", "above", "below", guard, "falling", role="soft"),
                 Transition("up", "below", "above", guard, "rising", role="soft")))
"""


def stop(stiffness: float) -> str:
    """A mass on a spring with a force, that bounces off a wall at x = 1."""
    return f"""{HEAD}
def free(t, x, p, dx):
    dx[0], dx[1] = x[1], p.F - {stiffness} * x[0] - 0.2 * x[1]

def gap(t, x, p):
    return 1.0 - x[0]

def bounce(t, x, p, after):
    after[0], after[1] = x[0], -0.5 * x[1]

SYSTEM = System(name="machine", states=(State("x"), State("v")), parameters=(Parameter("F", 0.2),),
    modes=(Mode("free", free),),
    transitions=(Transition("hit", "free", "free", gap, "falling", reset=bounce),))
"""


MASS = soft(
    "    dx[0], dx[1] = x[1], p.F - x[0] - 0.2 * x[1]",
    f"    dx[0], dx[1] = x[1], p.F - x[0] - 0.2 * x[1] - {STIFF} * (x[0] - 1.0)",
    "1.0 - x[0]",
    "xv",
)
FOLD = soft("    dx[0] = p.F - x[0]", "    dx[0] = p.F + x[0]", "x[0]")


@pytest.fixture
def study(tmp_path) -> Callable[..., list[Branch]]:
    def run(
        plugin: str, state: str, begin: float, range_: str, action: str, followed: str = "none"
    ) -> list[Branch]:
        (tmp_path / "machine.py").write_text(plugin, encoding="utf-8")
        text = RUN.replace("STATE", state).replace("BEGIN", str(begin)).replace("RANGE", range_)
        text = text.replace("FOLLOWED", followed)
        (tmp_path / "machine.yaml").write_text(text.replace("ACTION", action), encoding="utf-8")
        result = cw.run(
            cw.read_run_file(tmp_path / "machine.yaml", [], str(tmp_path / "machine.h5")),
            figures=False,
            force=True,
        )
        return list(result.branches)

    return run


def the_point(branch: Branch):
    (point,) = [each for each in branch.special_points if each.label == "BE"]
    assert point.status == "located"
    return point


def test_an_equilibrium_goes_on_in_the_other_mode(study):
    """x = F until a soft contact at 1; x = (F + 50) / 51 beyond."""
    free, pressed = study(MASS, "{x: 0.2, v: 0.0}", 0.2, "[0, 3]", "switch")
    point = the_point(free)
    assert point.kind == "persistence"
    assert abs(point.parameters["F"] - 1.0) <= point.error < 1e-15
    assert (free.outcome.status, free.outcome.reason) == ("complete", "boundary_equilibrium")
    assert pressed.info.origin == "b1/BE1"
    np.testing.assert_allclose(pressed["x"], (pressed["F"] + STIFF) / (1.0 + STIFF), rtol=1e-13)
    assert (pressed["F"].min(), pressed["F"].max()) == (1.0, 3.0)
    assert pressed.points["admissible"].all()
    assert pressed.info.settings["mode"] == "below"


@pytest.mark.parametrize(
    ("action", "end", "reason"), [("stop", 1.0, "boundary_equilibrium"), ("ignore", 3.0, "bound")]
)
def test_a_branch_stops_there_or_goes_on_where_it_is_not_the_machines(study, action, end, reason):
    (free,) = study(MASS, "{x: 0.2, v: 0.0}", 0.2, "[0, 3]", action)
    assert the_point(free).kind == "persistence"
    assert free["F"].max() == pytest.approx(end, abs=1e-15)
    assert free.outcome.reason == reason
    beyond = free["F"] > 1.0 + 1e-9
    assert not free.points["admissible"][beyond].any()
    assert free.points["admissible"][free["F"] < 1.0 - 1e-9].all()
    for each in free.special_points:  # the end of the range among them
        assert each.admissible == (each.parameters["F"] <= 1.0), each.name


def test_a_branch_that_comes_from_beyond_becomes_the_machines(study):
    (free,) = study(MASS, "{x: 2.5, v: 0.0}", 2.5, "[0, 3]", "stop")
    assert the_point(free).kind == "persistence"
    assert (free["F"].min(), free["F"].max()) == (0.0, 3.0)


def test_a_start_is_of_the_mode_that_is_named(study, tmp_path):
    """Pressed, x = (F + 50) / 51; from its database it is taken up in the same mode."""
    pressed, free = study(MASS, "{x: 1.1, v: 0.0}, mode: below", 2.5, "[0, 3]", "switch")
    assert pressed.info.settings["mode"] == "below"
    np.testing.assert_allclose(pressed["x"], (pressed["F"] + STIFF) / (1.0 + STIFF), rtol=1e-13)
    assert (the_point(pressed).kind, free.info.settings["mode"]) == ("persistence", "above")
    np.testing.assert_allclose(free["x"], free["F"], rtol=1e-13, atol=1e-13)
    file = tmp_path / "again.yaml"
    file.write_text(
        "contwalk: 1\nsystem: ./machine.py\nstart: {from: machine.h5, point: b1/EP2}\n"
        "continue: {parameter: F, range: [0, 3]}\noutput: again.h5\n"
    )
    read = cw.read_run_file(file, [], str(tmp_path / "again.h5"))
    (again,) = cw.run(read, figures=False).branches
    assert again.info.settings["mode"] == "below"
    assert again["F"].min() == pytest.approx(1.0, abs=1e-14)


FOCI = soft(
    "    dx[0], dx[1] = 0.6 * x[0] + x[1], p.F - x[0]",
    "    dx[0], dx[1] = x[1] - (x[0] - 0.5 * x[0] ** 2 / p.a) / 2.0 - 0.1 * x[0] ** 3, p.F - x[0]",
    "x[0]",
    "xy",
).replace('Parameter("F", 1.0)', 'Parameter("F", 1.0), Parameter("a", -0.5)')


def test_a_curve_of_a_mode_beyond_the_first_is_of_its_field(study, tmp_path):
    """Below 0 the trace -1/2 + x / (2 a) - 0.3 x^2 is zero where a = x / (1 + 0.6 x^2); above it is 0.6."""
    (below,) = study(FOCI, "{x: -0.2, y: -0.1}, mode: below", -0.2, "[-1, -0.1]", "stop")
    assert [each.label for each in below.special_points].count("HB") == 1
    file = tmp_path / "curve.yaml"
    file.write_text(
        "contwalk: 1\nsystem: ./machine.py\nstart: {from: machine.h5, point: b1/HB1}\n"
        "continue: {parameters: [F, a], range: {F: [-0.9, -0.3], a: [-2, -0.1]}}\noutput: curve.h5\n"
    )
    read = cw.read_run_file(file, [], str(tmp_path / "curve.h5"))
    curve = cw.run(read, figures=False).branches[0]
    assert curve.info.settings["mode"] == "below"
    assert curve.outcome.reason == "bound"
    np.testing.assert_allclose(curve["a"], curve["F"] / (1.0 + 0.6 * curve["F"] ** 2), rtol=1e-10)


def test_two_equilibria_end_at_a_nonsmooth_fold(study):
    """x' = F - |x|: x = F and x = -F, for F > 0 only."""
    above, below = study(FOLD, "{x: 1.0}", 1.0, "[-1, 2]", "switch")
    point = the_point(above)
    assert (point.kind, above["F"].min()) == ("fold", pytest.approx(0.0, abs=1e-15))
    np.testing.assert_allclose(below["x"], -below["F"], atol=1e-15)
    assert below["F"].max() == 2.0
    assert (above["unstable"].max(), below["unstable"][1:].min()) == (0, 1)


@pytest.mark.parametrize(("stiffness", "kind"), [(1.0, "rest"), (-1.0, "fold")])
def test_a_mass_comes_to_rest_against_a_stop_or_leaves_it(study, stiffness, kind):
    """The wall pushes back where F > stiffness: with a spring that is beyond F = 1, with its opposite not."""
    begin = 0.2 * stiffness
    (free,) = study(stop(stiffness), "{x: 0.2, v: 0.0}", begin, f"[{min(begin, stiffness) - 1}, 2]", "stop")
    point = the_point(free)
    assert point.kind == kind
    assert point.parameters["F"] == pytest.approx(stiffness, abs=1e-15)
    assert "'hit'" in point.note


@pytest.mark.parametrize(("other", "kind"), [(2.0, "persistence"), (-2.0, "fold")])
def test_between_two_fields_that_jump(study, other, kind):
    """x' = F - x above 0 and a constant below: at rest between both for F < 0 if that leads back to 0."""
    jumps = soft("    dx[0] = p.F - x[0]", f"    dx[0] = {other}", "x[0]").replace(
        'role="soft"', "level=True"
    )
    (above, *rest) = study(jumps, "{x: 1.0}", 1.0, "[-1, 2]", "switch")
    point = the_point(above)
    assert (point.kind, point.parameters["F"]) == (kind, pytest.approx(0.0, abs=1e-15))
    assert rest == []
    assert "No mode of the plugin" in above.outcome.message


BUCKLED = f"""{HEAD}from contwalk.system import Symmetry

def free(t, x, p, dx):
    dx[0], dx[1] = x[1], p.F * x[0] - x[0] ** 3 - 0.2 * x[1]

def wall(t, x, p):
    return SIDE * x[0] + 1.0

def bounce(t, x, p, after):
    after[0], after[1] = x[0], -0.5 * x[1]

def flip(t, x, p, out):
    out[0], out[1] = -x[0], -x[1]

SYSTEM = System(name="machine", states=(State("x"), State("v")), parameters=(Parameter("F", -1.0),),
    modes=(Mode("free", free),), symmetries=(Symmetry("flip", "spatial", flip),),
    transitions=(Transition("hit", "free", "free", wall, "falling", reset=bounce),))
"""


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize("action", ["stop", "ignore"])
def test_a_wall_on_one_side_is_met_on_one_half_alone(study, side, action):
    """The field is odd, and both halves x = -+sqrt(F) are images of each other; the wall is at -side."""
    plugin = BUCKLED.replace("SIDE", str(side))
    _, halves = study(plugin, "{x: 0.0, v: 0.0}", -1.0, "[-1, 3]", action, "[BP]")
    point = the_point(halves)
    assert (point.kind, point.state["x"]) == ("rest", pytest.approx(-side, abs=1e-15))
    here, there = (halves["F"][halves["x"] * side * sign < 0.0].max() for sign in (1.0, -1.0))
    assert (here, there) == ((1.0 if action == "stop" else 3.0), 3.0)
    beyond = halves["x"] * side < -1.0 - 1e-9
    assert halves.points["admissible"][~beyond].all()
    assert not halves.points["admissible"][beyond].any()


def test_of_an_event_that_changes_nothing_no_kind_is_told(study):
    """Its reset keeps all: no sign says whether anything holds the mass there."""
    plugin = BUCKLED.replace("SIDE", "-1.0").replace("-0.5 * x[1]", "x[1]")
    _, halves = study(plugin, "{x: 0.0, v: 0.0}", -1.0, "[-1, 3]", "ignore", "[BP]")
    point = the_point(halves)
    assert point.kind is None
    assert "is not known" in point.note
