"""Soft transitions only: the field switches continuously, and nothing is special where they come and go.

A linear oscillator that meets a second spring at a gap. The same machine is one smooth field but for a
bend, with `max`; of its orbits the ones with and without contact are compared.
"""

from __future__ import annotations

import math
from functools import cache

import numpy as np
import pytest
from hybrid_runs import ACCURACY, assert_met, diagram, machine

import contwalk as cw
from contwalk.branch import Branch
from contwalk.system import Mode, Observable, Parameter, State, System, Transition

WALKED = 100.0 * ACCURACY
ZETA, OMEGA, STIFFNESS, GAP = 0.1, 0.9, 8.0, 0.5
# Where the motion without contact has the gap as its amplitude.
TOUCH = GAP * math.hypot(1.0 - OMEGA**2, 2.0 * ZETA * OMEGA)
MARKS = (1.5 * TOUCH, 3.0 * TOUCH, 5.0 * TOUCH)
LARGEST = Observable("q_max", lambda t, x, p: x[:, 0].max())


def spring(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = p.force * math.cos(OMEGA * t) - 2.0 * ZETA * x[1] - x[0]


def two_springs(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = p.force * math.cos(OMEGA * t) - 2.0 * ZETA * x[1] - x[0] - STIFFNESS * (x[0] - GAP)


def bent(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = p.force * math.cos(OMEGA * t) - 2.0 * ZETA * x[1] - x[0] - STIFFNESS * max(x[0] - GAP, 0.0)


def period(p):
    return 2.0 * math.pi / OMEGA


def system(role: str = "soft") -> System:
    return machine(
        ["q", "v"],
        {"force": 1.0},
        {"free": spring, "contact": two_springs},
        [
            Transition("touch", "free", "contact", lambda t, x, p: GAP - x[0], role=role),
            Transition("leave", "contact", "free", lambda t, x, p: x[0] - GAP, role=role),
        ],
        period=period,
        observables=(LARGEST,),
    )


@cache
def whole() -> Branch:
    """The same orbits with a field that bends."""
    smooth = System(
        "bent",
        states=(State("q"), State("v")),
        parameters=(Parameter("force", 1.0),),
        modes=(Mode("only", bent),),
        period=period,
        observables=(LARGEST,),
    )
    problem = cw.PeriodicOrbit(
        smooth, {"force": 2.0 * TOUCH}, "force", discretization=cw.Discretization(accuracy=ACCURACY)
    )
    return cw.continue_branch(
        problem, [0.0, 0.0], (0.5 * TOUCH, 6.0 * TOUCH), until="settled", marks={"force": list(MARKS)}
    )


@cache
def declared_hard(force: float) -> tuple[Branch, ...]:
    return tuple(
        diagram(
            system("hard"),
            "force",
            (0.5 * TOUCH, 2.0 * TOUCH),
            [0.0, 0.0],
            {"force": force},
            until="settled",
            events={"GR": "switch", "OC": "switch"},
            depth=1,
        )
    )


@cache
def study(force: float) -> tuple[Branch, ...]:
    return tuple(
        diagram(
            system(),
            "force",
            (0.5 * TOUCH, 6.0 * TOUCH),
            [0.0, 0.0],
            {"force": force},
            until="settled",
            events={"GR": "stop", "OC": "stop"},
            marks={"force": MARKS},
            max_points=150,
            depth=2,
        )
    )


def orbits(force: float) -> Branch:
    """All of them, from a start with this force."""
    (branch,) = study(force)
    return branch


STARTS = pytest.mark.parametrize("force", [0.7 * TOUCH, 4.0 * TOUCH], ids=["without", "with contact"])


@pytest.mark.long
@STARTS
class TestThroughTheFirstContact:
    def test_nothing_is_special(self, force):
        branch = orbits(force)
        assert branch.info.signature == ()
        assert branch.outcome.reason == "bound"
        assert [branch["force"].min(), branch["force"].max()] == [0.5 * TOUCH, 6.0 * TOUCH]
        assert {p.label for p in branch.special_points} == {"EP", "UZ"}
        assert np.all(branch["unstable"] == 0)

    def test_orbits_are_those_of_the_bent_field(self, force):
        branch = orbits(force)
        for value in MARKS:
            own, other = (
                next(p for p in b.special_points if p.label == "UZ" and p.parameters["force"] == value)
                for b in (branch, whole())
            )
            assert own.period == pytest.approx(other.period, rel=1e-14)
            # Both are on steps for a hundredth of the accuracy; ways past the bend are 1e-11 long.
            np.testing.assert_allclose(np.poly(own.spectrum), np.poly(other.spectrum), rtol=0, atol=1e-10)
            assert branch["q_max"][own.index] == pytest.approx(whole()["q_max"][other.index], abs=1e-5)

    def test_determinant(self, force):
        """Springs take nothing: exp(-2 zeta T)."""
        expected = math.exp(-2.0 * ZETA * 2.0 * math.pi / OMEGA)
        for branch in (orbits(force), whole()):
            products = np.prod(branch.points["spectrum"], axis=1)
            # Steps of a walk are made for so much.
            np.testing.assert_allclose(products, expected, rtol=0, atol=WALKED)

    def test_without_contact_the_amplitude_is_that_of_the_linear_oscillator(self, force):
        branch = orbits(force)
        quiet = branch["force"] < TOUCH
        expected = GAP * branch["force"][quiet] / TOUCH
        np.testing.assert_allclose(branch["q_max"][quiet], expected, rtol=0, atol=WALKED)
        assert np.all(branch["q_max"][~quiet] >= GAP)


@pytest.mark.parametrize(
    ("force", "signatures", "kind"),
    [
        (0.7 * TOUCH, [(), ("touch", "leave")], "interior"),
        (1.5 * TOUCH, [("touch", "leave"), ()], "terminal"),
    ],
    ids=["without", "with contact"],
)
class TestDeclaredHard:
    """The first contact is a grazing then, and nothing else; beyond it the other orbits follow."""

    @pytest.mark.drawn(1)
    def test_the_contact_is_grazed_where_it_begins(self, force, signatures, kind):
        first, second = declared_hard(force)
        assert [first.info.signature, second.info.signature] == signatures
        (point,) = (p for p in first.special_points if p.label == "GR")
        assert point.kind == kind
        assert_met(point, "force", TOUCH)
        for branch in (first, second):
            assert {p.label for p in branch.special_points} <= {"EP", "GR"}
            assert all(p.status == "located" for p in branch.special_points)
            assert np.all(branch["unstable"] == 0)

    def test_together_they_reach_both_ends(self, force, signatures, kind):
        forces = np.concatenate([branch["force"] for branch in declared_hard(force)])
        assert [forces.min(), forces.max()] == [0.5 * TOUCH, 2.0 * TOUCH]


def filling(t, x, p, dx):
    dx[0] = p.a - x[0]
    dx[1] = 1.0


def leaking(t, x, p, dx):
    dx[0] = p.a - 2.0 * x[0]
    dx[1] = 1.0


def taken(t, x, p, x_plus):
    x_plus[0] = x[0] - 1.0
    x_plus[1] = 0.0


def test_an_event_that_comes_to_happen_in_another_mode_is_passed():
    """A tank from which one unit is taken each second leaks above zero: its level before that passes zero at
    a = 1 / (e - 1), and the event's leg ends in the other mode from there on."""

    def due(t, x, p):
        return x[1] - 1.0

    tank = machine(
        ["level", "clock"],
        {"a": 0.3},
        {"dry": filling, "wet": leaking},
        [
            Transition("up", "dry", "wet", lambda t, x, p: x[0], "rising", role="soft"),
            Transition("down", "wet", "dry", lambda t, x, p: x[0], "falling", role="soft"),
            Transition("take", "dry", "dry", due, "rising", taken),
            Transition("take", "wet", "dry", due, "rising", taken),
        ],
    )
    (branch,) = diagram(tank, "a", (0.3, 1.2), [-0.9, 0.0], until="settled", direction="up")
    assert branch.outcome.reason == "bound", branch.outcome
    assert {point.label for point in branch.special_points} == {"EP"}
    below = branch.points[branch["free"][:, 0] < 1.0 / (math.e - 1.0)]
    above = branch.points[branch["free"][:, 0] > 1.0 / (math.e - 1.0)]
    assert len(below) > 2
    assert len(above) > 2
    level = branch.info.states.index("level")
    expected = below["free"][:, 0] - 1.0 / (math.e - 1.0)  # right before, as long as it stays dry
    assert below["state"][:, level] == pytest.approx(expected, abs=1e-8)
