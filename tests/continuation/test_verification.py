"""Special points recomputed on another path, and stored ones that were tampered with."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from small_systems import labelled, small_system

import contwalk as cw
from contwalk.branch import Branch, SpecialPoint
from contwalk.diagram.reopening import reopened, stored_place
from contwalk.errors import DatabaseError
from contwalk.problems.orbit.discretization import Discretization
from contwalk.problems.restoring import problem_of
from contwalk.system import Neutral, Observable, State, Symmetry, System
from contwalk.verification.finding import AGREES, CANNOT_TELL, DISAGREES, SLACK, Finding
from contwalk.verification.points import checked_point

STEPS = Discretization(accuracy=1e-7)


def folding_cycle(t, x, p, dx):
    # r' = r (mu + r^2 - r^4), phase' = 1: cycles fold at mu = -1/4, r^2 = 1/2
    r2 = x[0] ** 2 + x[1] ** 2
    growth = p.mu + r2 - r2**2
    dx[0] = growth * x[0] - x[1]
    dx[1] = x[0] + growth * x[1]


def roessler(t, x, p, dx):
    dx[0] = -x[1] - x[2]
    dx[1] = x[0] + 0.2 * x[1]
    dx[2] = 0.2 + x[2] * (x[0] - p.c)


def van_der_pol(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = p.mu * (1.0 - x[0] ** 2) * x[1] - x[0]


def hodgkin_huxley(t, x, p, dx):
    v, m, h, n = x[0], x[1], x[2], x[3]
    dx[0] = p.i - 120.0 * m**3 * h * (v - 50.0) - 36.0 * n**4 * (v + 77.0) - 0.3 * (v + 54.4)
    dx[1] = (
        0.1 * (v + 40.0) / (1.0 - np.exp(-(v + 40.0) / 10.0)) * (1.0 - m)
        - 4.0 * np.exp(-(v + 65.0) / 18.0) * m
    )
    dx[2] = 0.07 * np.exp(-(v + 65.0) / 20.0) * (1.0 - h) - h / (1.0 + np.exp(-(v + 35.0) / 10.0))
    dx[3] = (
        0.01 * (v + 55.0) / (1.0 - np.exp(-(v + 55.0) / 10.0)) * (1.0 - n)
        - 0.125 * np.exp(-(v + 65.0) / 80.0) * n
    )


def mirrored(t, x, p, y):
    y[0], y[1] = -x[0], -x[1]


def moved_to(point: SpecialPoint, value: float, **rest) -> SpecialPoint:
    """A record whose parameter has another value, wherever it stands."""
    (free,) = [name for name, own in point.parameters.items() if own == point.unknowns[-1]]
    unknowns = (*point.unknowns[:-1], value)
    return replace(point, unknowns=unknowns, parameters={**point.parameters, free: value}, **rest)


def checked(system: System, branch: Branch, point: SpecialPoint) -> Finding:
    return checked_point(system, branch, point)


@pytest.fixture(scope="module")
def folded():
    """A cycle with a fold at mu = -1/4."""
    system = small_system(folding_cycle, ("x", "y"), {"mu": -0.2})
    radius = np.sqrt(0.5 + np.sqrt(0.25 - 0.2))
    problem = cw.PeriodicOrbit(system, system.defaults(), "mu", discretization=STEPS)
    branch = cw.continue_branch(
        problem, [radius, 0.0], range=(-0.3, -0.1), period=2.0 * np.pi, direction="backward"
    )
    return system, branch


def test_fold_of_cycles(folded):
    system, branch = folded
    (point,) = labelled(branch, "LP")
    found = checked(system, branch, point)
    assert found.verdict == AGREES
    # the claim of the recomputed value is an estimate of its own error, taken SLACK times as `verify` does
    assert abs(found.recomputed + 0.25) <= SLACK * found.own_error
    assert found.own_error < STEPS.accuracy * 0.25
    assert found.method == "SciPy DOP853"


def test_a_value_beyond_its_error_disagrees(folded):
    system, branch = folded
    (point,) = labelled(branch, "LP")
    found = checked(system, branch, moved_to(point, point.unknowns[-1] - 1e-9, error=1e-12))
    assert found.verdict == DISAGREES
    assert found.failed
    assert "errors" in found.reason
    assert found.difference == pytest.approx(1e-9, rel=0.05)  # the stored one was off by its own error too


def test_a_point_that_is_none_is_not_found_again(folded):
    system, branch = folded
    (fold,) = labelled(branch, "LP")
    row = int(np.argmax(branch["mu"]))  # a point far from any fold
    z = branch.unknowns(row)
    moved = replace(moved_to(fold, z[-1]), unknowns=tuple(z), index=row)
    assert checked(system, branch, moved).failed


def test_what_was_not_located_is_skipped(folded):
    system, branch = folded
    found = checked(system, branch, replace(labelled(branch, "LP")[0], status="unlocated"))
    assert found.verdict == CANNOT_TELL
    assert not found.failed


@pytest.mark.parametrize("gap", [3e-7, 1e-5])
def test_of_two_points_beside_each_other_each_is_found_again(gap):
    """The search began farther away than the neighbour, and went to it."""

    def swinging(t, x, p, dx):
        growth = 100.0 * (p.mu - 0.5) * (p.mu - 0.5 - gap)
        dx[0] = growth * x[0] - x[1]
        dx[1] = x[0] + growth * x[1]

    system = small_system(swinging, ("x", "y"), {"mu": 0.0})
    problem = cw.Equilibrium(system, system.defaults(), "mu")
    branch = cw.continue_branch(problem, [0.0, 0.0], range=(0.0, 1.0))
    points = labelled(branch, "HB")
    assert len(points) == 2
    assert [checked(system, branch, point).verdict for point in points] == [AGREES, AGREES]


def test_marked_values_are_solved_again(folded):
    system, _ = folded
    radius = np.sqrt(0.5 + np.sqrt(0.25 - 0.2))
    problem = cw.PeriodicOrbit(system, system.defaults(), "mu", discretization=STEPS)
    marked = cw.continue_branch(
        problem,
        [radius, 0.0],
        range=(-0.21, 0.1),
        period=2.0 * np.pi,
        marks={"mu": [-0.1], "max_abs": [0.01]},
        direction="forward",
    )
    by_kind = {point.kind: point for point in labelled(marked, "UZ")}
    found = checked(system, marked, by_kind["parameter"])
    assert (found.verdict, found.quantity != "mu") == (AGREES, True)
    assert checked(system, marked, by_kind["observable"]).verdict == AGREES
    assert checked(system, marked, by_kind["observable"]).verdict == AGREES  # it tells itself
    unknown = checked(system, marked, replace(by_kind["observable"], mark={}))
    assert unknown.verdict == CANNOT_TELL
    assert "does not tell what is marked" in unknown.reason


def test_period_doubling_has_its_multiplier_at_minus_one():
    system = small_system(roessler, ("x", "y", "z"), {"c": 2.5})
    problem = cw.PeriodicOrbit(system, system.defaults(), "c", discretization=STEPS)
    branch = cw.continue_branch(
        problem, [2.0, 0.0, 0.1], range=(2.4, 3.2), until="settled", direction="forward"
    )
    (point,) = labelled(branch, "PD")
    found = checked(system, branch, point)
    assert found.verdict == AGREES


@pytest.fixture(scope="module")
def firing():
    """The first fold of the cycles of an axon, in 20 segments."""
    system = small_system(hodgkin_huxley, ("v", "m", "h", "n"), {"i": 9.0})
    steps = Discretization(accuracy=1e-8, segments=20)
    rest = cw.Equilibrium(system, system.defaults(), "i", discretization=steps)
    equilibria = cw.continue_branch(rest, [-60.0, 0.1, 0.4, 0.4], range=(0.0, 20.0))
    cycles = cw.switch_branch(rest, equilibria, "HB1", range=(0.0, 20.0), max_points=30)
    return system, cycles, steps


def test_a_point_in_many_segments_is_found_again(firing):
    system, branch, steps = firing
    assert branch.info.settings["segments"] == 20
    (fold,) = labelled(branch, "LP")
    found = checked(system, branch, fold)
    assert found.verdict == AGREES
    assert found.own_error <= steps.accuracy * abs(found.stored)


def test_a_wrong_value_disagrees_whatever_is_aimed_at(firing):
    system, branch, _ = firing
    (fold,) = labelled(branch, "LP")
    wrong = (*fold.unknowns[:-1], fold.unknowns[-1] * (1.0 + 3e-8))  # three times the accuracy asked for
    found = checked(system, branch, moved_to(fold, wrong[-1]))
    assert found.verdict == DISAGREES


def test_orbits_reopened_close_as_they_did():
    mirror = Symmetry("mirror", "spatial", mirrored)
    system = small_system(van_der_pol, ("x", "v"), {"mu": 1.0}, symmetries=(mirror,))
    problem = cw.PeriodicOrbit(system, system.defaults(), "mu", discretization=STEPS)
    branch = cw.continue_branch(problem, [2.0, 0.0], range=(0.5, 1.5), until="settled")
    for row in (0, len(branch) // 2, len(branch) - 1):
        there, sample = reopened(system, branch, row, STEPS)
        assert there.whole == ("mirror", 2)
        assert there.duration(sample.z) == pytest.approx(branch["period"][row], rel=1e-12)
        stored = branch.points[row]
        # the same orbit on steps made for it: its multipliers are those stored, to the stored error
        gap = np.abs(sample.eigenvalues - stored["spectrum"]).max()
        assert gap <= 10.0 * max(stored["spectrum_error"], STEPS.accuracy)


def test_equilibria_and_their_marks():
    def brusselator(t, x, p, dx):
        dx[0] = 1.0 - (p.b + 1.0) * x[0] + x[0] ** 2 * x[1]
        dx[1] = p.b * x[0] - x[0] ** 2 * x[1]

    system = small_system(brusselator, ("x", "y"), {"b": 1.0})
    problem = cw.Equilibrium(system, system.defaults(), "b")
    marks = {"b": [1.5], "max_re": [-0.1, "extremum"]}
    branch = cw.continue_branch(problem, [1.0, 1.0], range=(0.5, 3.0), marks=marks)
    points = [point for point in branch.special_points if point.label != "EP"]
    assert "HB" in [point.label for point in points]
    for point in points:
        assert checked(system, branch, point).verdict == AGREES, point


@pytest.mark.parametrize("role", ["spatial", "relabel"])
def test_equilibria_that_lose_a_declared_symmetry(role):
    def pitchfork(t, x, p, dx):
        dx[0] = (p.a - 2.0) * x[0] - x[0] ** 3 - x[1]
        dx[1] = x[0] - 2.0 * x[1]

    mirror = Symmetry("mirror", role, mirrored)
    system = small_system(pitchfork, ("x", "y"), {"a": 1.0}, symmetries=(mirror,))
    problem = cw.Equilibrium(system, system.defaults(), "a")
    middle = cw.continue_branch(problem, [0.0, 0.0], range=(1.0, 3.0))
    (point,) = labelled(middle, "BP")
    assert point.kind == ("symmetry-breaking" if role == "spatial" else "pitchfork")
    found = checked(system, middle, point)
    assert found.verdict == AGREES, found.reason
    assert found.recomputed == pytest.approx(2.5, rel=1e-15)  # (a - 2) y - y / 4 = 0 of y = x / 2, to an ulp
    # Seen from the branch that lost it, the eigenvalue touches zero and does not cross.
    seed = [np.sqrt(0.4), np.sqrt(0.4) / 2.0]
    aside = cw.continue_branch(
        cw.Equilibrium(system, {"a": 2.9}, "a"), seed, range=(1.0, 3.0), direction="backward"
    )
    (same,) = labelled(aside, "BP")
    assert checked(system, aside, same).verdict == AGREES


def test_branch_points_on_a_path():
    def fork(t, x, p, dx):
        dx[0] = (p.a + p.b - 1.0) * x[0] - x[0] ** 3

    system = small_system(fork, ("x",), {"a": 0.0, "b": 0.0})
    ends = ({"a": 0.0, "b": 0.0}, {"a": 1.0, "b": 2.0})
    problem = cw.Equilibrium(system, ends[0], "path", ends)
    branch = cw.continue_branch(problem, [0.0], range=(0.0, 1.0))
    (point,) = labelled(branch, "BP")
    again = problem_of(system, branch.info, np.zeros(1))
    assert again.line.ends == ends
    found = checked(system, branch, point)
    assert found.verdict == AGREES
    assert found.recomputed == pytest.approx(1.0 / 3.0, rel=1e-15)  # a + b = 3 path, to an ulp


def drifting(t, x, p, dx):
    # the position s matters to nobody
    dx[0] = p.r * x[0] - x[0] ** 3
    dx[1] = x[0]


@pytest.mark.parametrize("declared", [True, False])
def test_pinned_directions_are_pinned_again(declared):
    def along(t, x, p, v):
        v[1] = 1.0
        v[0] = 0.0

    rest = {"neutral": (Neutral("shift", along, pin="s"),)} if declared else {}
    system = small_system(drifting, (State("x"), State("s")), {"r": -1.0}, **rest)
    problem = cw.Equilibrium(system, system.defaults(), "r")
    branch = cw.continue_branch(problem, [0.0, 0.3], range=(-1.0, 1.0))
    assert len(branch.info.settings["pins"]) == 1
    _, sample = reopened(system, branch, 3)
    stored = branch.points["spectrum"][3]
    assert np.allclose(sample.eigenvalues, stored, rtol=1e-14, atol=0.0)


def test_a_point_that_is_not_located_stands_at_its_row(folded):
    system, branch = folded
    point = replace(branch.special_points[0], status="unlocated", unknowns=(), tangent=(), index=2)
    place, row = stored_place(branch, point), stored_place(branch, 2)
    np.testing.assert_array_equal(place.z, row.z)
    np.testing.assert_array_equal(reopened(system, branch, point)[1].z, row.z)


def test_another_system_is_refused(folded):
    _, branch = folded
    other = small_system(roessler, ("x", "y", "z"), {"c": 2.5})
    with pytest.raises(DatabaseError, match="another system"):
        reopened(other, branch, 0)


def test_an_extremum_of_an_observable_is_checked_as_what_it_is():
    """x = mu, and 1 - (x - 0.3)^2 is largest at 0.3; it has no extremum beside it, and a value is not one."""

    def field(t, x, p, dx):
        dx[0] = p.mu - x[0]

    hill = Observable("hill", lambda t, x, p: (1.0 - (x[:, 0] - 0.3) ** 2).max())
    system = small_system(field, "x", {"mu": 0.0}, observables=(hill,))
    problem = cw.Equilibrium(system, system.defaults(), "mu")
    marks = {"hill": [0.96, "extremum"]}
    branch = cw.continue_branch(problem, [0.0], (-0.2, 0.6), marks=marks)
    points = {point.kind: point for point in labelled(branch, "UZ")}
    for kind in ("extremum", "observable"):
        assert not checked(system, branch, points[kind]).failed
    assert checked(system, branch, points["observable"]).verdict == AGREES
    lost = checked(system, branch, replace(points["extremum"], mark={}))
    assert lost.verdict == CANNOT_TELL
    assert "does not tell what is marked" in lost.reason


def test_a_value_that_is_only_touched_is_known_to_the_root_of_its_rounding():
    """x = mu, and cos(x) is one at the start: the equations of that value have a double root there."""

    def field(t, x, p, dx):
        dx[0] = p.mu - x[0]

    wave = Observable("wave", lambda t, x, p: np.cos(x[:, 0]).max())
    system = small_system(field, "x", {"mu": 0.0}, observables=(wave,))
    marks = {"wave": [1.0]}
    branch = cw.continue_branch(
        cw.Equilibrium(system, system.defaults(), "mu"), [0.0], (-0.2, 0.6), marks=marks
    )
    (point,) = labelled(branch, "UZ")
    assert 1e-8 < point.error < 1e-6
    assert checked(system, branch, point).verdict == AGREES
    moved = tuple(value + 1e-3 for value in point.unknowns)
    assert checked(system, branch, replace(point, unknowns=moved)).verdict != AGREES
