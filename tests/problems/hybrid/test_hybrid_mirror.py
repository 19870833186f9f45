"""Orbits that are their own mirror images half a period later.

The Lorenz equations at large rho, whose symmetric orbit passes x = 0 from the right and from the left in
turn, as a machine of two modes. It loses its symmetry as rho falls, and the orbit that has lost it doubles
its period. The same equations as one smooth field give the same numbers. Two more states go along: a place
s that the mirror reverses, and a height h that it does not and that grows for ever; nothing depends on
either.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from hybrid_runs import ACCURACY, assert_met, diagram, machine, solution
from lorenz_mirrors import field, mirror, travelling, travelling_mirror

from contwalk.branch import Branch, SpecialPoint
from contwalk.continuation.settings import Settings
from contwalk.diagram.opening import Opening
from contwalk.diagram.reopening import reopened
from contwalk.problems.hybrid.rotated import rotated
from contwalk.problems.hybrid.simulated_round import follows
from contwalk.problems.orbit.discretization import SOLVED
from contwalk.problems.stored_itinerary import StoredItinerary
from contwalk.studies.opening_eventful import opened_itinerary
from contwalk.system import Neutral, Symmetry, System, Transition
from contwalk.workflow.stored.orbits import orbit_at

WALKED = 100.0 * ACCURACY
RANGE = (200.0, 330.0)
START = [1.0, 10.0, 300.0]
MIRROR = Symmetry("mirror", "spatial", mirror)


def two_sided(travels: bool) -> System:
    names = {"right": "left", "left": "right"}
    events = {"go_left": "go_right", "go_right": "go_left"}
    map_ = travelling_mirror if travels else mirror

    def along(k):
        def generator(t, x, p, v):
            for i in range(5):
                v[i] = 1.0 if i == k else 0.0

        return generator

    return machine(
        ["x", "y", "z", "s", "h"] if travels else ["x", "y", "z"],
        {"rho": 325.0},
        {"right": travelling, "left": travelling} if travels else {"right": field, "left": field},
        [
            Transition("go_left", "right", "left", lambda t, x, p: x[0]),
            Transition("go_right", "left", "right", lambda t, x, p: -x[0]),
        ],
        symmetries=(Symmetry("mirror", "spatial", map_, modes=names, events=events),),
        neutral=(Neutral("aside", along(3)), Neutral("up", along(4))) if travels else (),
    )


@cache
def branches(travels: bool) -> list[Branch]:
    start = [*START, 7.0, -2.0] if travels else START
    return diagram(
        two_sided(travels), "rho", RANGE, start, mode="right", until="settled", follow=("BP",), depth=2
    )


@cache
def smooth() -> list[Branch]:
    """The branches of the same equations as one field, whose orbit is half its period's as well."""
    system = machine(["x", "y", "z"], {"rho": 325.0}, {"all": field}, [], symmetries=(MIRROR,))
    return diagram(system, "rho", RANGE, START, until="settled", follow=("BP",), depth=2)


def located(found: list[Branch], label: str) -> list[SpecialPoint]:
    return [point for branch in found for point in branch.special_points if point.label == label]


@pytest.mark.parametrize("travels", [pytest.param(False, marks=pytest.mark.long), True])
def test_half_of_it_is_integrated(travels):
    parent, child = branches(travels)
    assert (parent.info.closure, child.info.closure) == ("mirror", "full")
    assert len(parent.info.signature) == 1
    assert sorted(child.info.signature) == ["go_left", "go_right"]
    assert parent.outcome.reason == child.outcome.reason == "bound"
    # The spectrum is that of the half; `max_abs` is of the whole period, as it is of the smooth orbit.
    np.testing.assert_allclose(parent["max_abs"], np.abs(parent.points["spectrum"][:, 0]) ** 2)
    assert parent.points["spectrum"].shape[1] == 2


@pytest.mark.long
@pytest.mark.parametrize("travels", [False, True])
def test_symmetry_breaking_and_doubling_are_those_of_the_smooth_orbit(travels):
    for label in ("BP", "PD"):
        ours, others = located(branches(travels), label), located(smooth(), label)
        assert len(ours) == len(others) == {"BP": 1, "PD": 2}[label]
        for one, other in zip(ours, others, strict=True):
            assert_met(one, "rho", other.parameters["rho"], 3.0 * ACCURACY)
            assert one.kind == other.kind
            assert one.criticality == other.criticality == "supercritical"
            # Of the smooth orbit the size of deviations is a mean over some instants.
            assert one.coefficients["c"] == pytest.approx(other.coefficients["c"], rel=1e-3)
            assert one.period == pytest.approx(other.period, rel=WALKED)
            assert one.period_full == pytest.approx(other.period_full, rel=WALKED)
    (breaking,) = located(branches(travels), "BP")
    assert breaking.kind == "symmetry-breaking"
    assert breaking.period_full == pytest.approx(2.0 * breaking.period, rel=1e-15)
    np.testing.assert_allclose(breaking.spectrum_full, np.square(breaking.spectrum), rtol=1e-14)


def test_a_state_that_only_the_image_passes_is_reported_there():
    """x passes -5 on its way up in the half that is not integrated: the image of 5 on the way down."""
    (parent, _), places = branches(True), []
    problem, sample = reopened(two_sided(True), parent, len(parent) // 2)
    for value, direction in ((5.0, -1.0), (-5.0, 1.0)):
        chosen = replace(problem.discretization, report_at=(0, value, direction))
        places.append(problem.varied(discretization=chosen).reported(sample.z))
    ours, images = places
    assert ours[0] == pytest.approx(5.0, abs=1e-9)
    np.testing.assert_allclose(images[:3], [-ours[0], -ours[1], ours[2]], rtol=1e-9)


def test_the_whole_motion_is_told():
    """Half of it is the image of the other half, seen from the ground; an oblique one gets somewhere else."""
    parent, child = branches(True)
    orbit = orbit_at(two_sided(True), parent, 3)
    count = len(orbit.times) // 2
    half = orbit.times[count]
    np.testing.assert_allclose(orbit.times[count:], orbit.times[:count] + half, rtol=1e-14)
    np.testing.assert_allclose(orbit.states[count:, :2], -orbit.states[:count, :2], atol=1e-12)
    assert orbit.closures == 1
    assert sorted(orbit.events) == ["go_left", "go_right"]
    aside, up = orbit.turns[3:]
    assert aside == pytest.approx(0.0, abs=1e-9)
    z = orbit.states[:, 2]
    risen = float(np.sum(0.5 * (z[1:] + z[:-1]) * np.diff(orbit.times)))
    assert up == pytest.approx(risen, rel=1e-4)
    np.testing.assert_allclose(orbit.states[-1, 3:] - orbit.states[0, 3:], [aside, up], atol=1e-6)
    oblique = orbit_at(two_sided(True), child, 3)
    assert abs(oblique.turns[3]) > 1e-3 * abs(oblique.turns[4])
    np.testing.assert_allclose(oblique.states[-1, 3:] - oblique.states[0, 3:], oblique.turns[3:], rtol=1e-4)


def test_a_half_cycle_is_stored_and_taken_up_again(tmp_path):
    """Row 3 of a stored branch begins a branch with the same closure, the same pins and the same orbits."""
    parent, _ = branches(True)
    system = two_sided(True)
    problem, sample = reopened(system, parent, 3)
    assert problem.itinerary.image == "mirror"
    assert [pin.name for pin in problem.pins] == ["aside", "up"]
    stored = StoredItinerary(parent.info.settings["legs"], 1, parent.unknowns(3), "mirror", ("aside", "up"))
    values = {"rho": float(sample.z[-1])}
    settings = Settings(range=RANGE)
    opening = opened_itinerary(system, values, "rho", settings, None, None, None, stored)
    assert isinstance(opening, Opening)
    np.testing.assert_allclose(opening.state.sample.eigenvalues, sample.eigenvalues, rtol=1e-6)


@pytest.mark.long
def test_it_may_begin_with_any_leg():
    """An itinerary of two legs in half a cycle, begun with the other one: the image of the first follows."""
    system = machine(
        ["x", "y", "z", "s", "h"],
        {"rho": 325.0},
        {"right": travelling, "left": travelling, "high": travelling, "deep": travelling},
        [
            Transition("rise", "right", "high", lambda t, x, p: p.rho - x[2], direction="falling"),
            Transition("go_left", "high", "left", lambda t, x, p: x[0]),
            Transition("lift", "left", "deep", lambda t, x, p: p.rho - x[2], direction="falling"),
            Transition("go_right", "deep", "right", lambda t, x, p: -x[0]),
        ],
        symmetries=(
            Symmetry(
                "mirror",
                "spatial",
                travelling_mirror,
                modes={"right": "left", "left": "right", "high": "deep", "deep": "high"},
                events={"rise": "lift", "lift": "rise", "go_left": "go_right", "go_right": "go_left"},
            ),
        ),
        neutral=two_sided(True).neutral,
    )
    problem, z = solution(system, "rho", [*START, 0.0, 0.0], mode="right", until="settled")
    assert len(problem.itinerary) == 2
    found = problem.multipliers(z, problem.jacobian(z)).values
    other, turned = rotated(problem, z, 1)
    assert other.itinerary.legs[0] != problem.itinerary.legs[0]
    # On steps of its own, to their tolerance.
    assert other.linearize(turned).excess * SOLVED < 1.0
    np.testing.assert_allclose(other.multipliers(turned, other.jacobian(turned)).values, found, rtol=1e-6)
    assert follows(other, turned) is None
