"""Double zeros of odd fields: Hopf points meet branch points that persist, not folds.

x'' = mu x + nu x' - x^3 - x^2 x' (Guckenheimer & Holmes 1983, section 7.3): the equilibrium zero has Hopf
points where nu = 0 > mu and branch points where mu = 0; those beside it have Hopf points where nu = mu > 0.
"""

from __future__ import annotations

import numpy as np
import pytest
from small_systems import labelled, small_system

import contwalk as cw
from contwalk.continuation.settings import Settings
from contwalk.continuation.state import ContinuationState, begin
from contwalk.diagram.reopening import reopened

RANGES = {"mu": (-1.0, 1.0), "nu": (-1.0, 1.0)}


def odd(t, x, p, dx):
    """An odd oscillator."""
    dx[0] = x[1]
    dx[1] = p.mu * x[0] + p.nu * x[1] - x[0] ** 3 - x[0] ** 2 * x[1]


@pytest.fixture(scope="module")
def system() -> cw.system.System:
    return small_system(odd, ["x", "y"], {"mu": -0.5, "nu": -0.5})


def followed(system, free: str, point: str, other: str):
    problem = cw.Equilibrium(system, system.defaults(), free)
    branch = cw.continue_branch(problem, [0.0, 0.0], range=RANGES[free])
    return cw.continue_locus(system, branch, point, {free: RANGES[free], other: RANGES[other]})


def test_hopf_points_pass_the_double_zero_where_their_own_parameter_stands_still(system) -> None:
    """The curve is nu = 0 throughout, and leads from the focus to the saddle."""
    curve = followed(system, "nu", "HB1", "mu")
    assert curve.outcome.reason == "bound"
    assert (curve["mu"].min(), curve["mu"].max()) == RANGES["mu"]
    (point,) = labelled(curve, "BT")
    assert not labelled(curve, "BP")  # it is where another curve crosses, and told once
    assert (point.status, point.kind) == ("located", "branch point")
    # Within what is claimed of the double zero, at which nothing else holds nu.
    assert np.all(np.abs(curve["nu"]) <= point.errors["nu"])
    assert point.errors["nu"] < 1e-17
    assert abs(point.parameters["mu"]) <= point.errors["mu"] < 1e-30
    assert not point.coefficients  # it has a normal form of its own


@pytest.mark.long
def test_branch_points_have_it_as_well(system) -> None:
    curve = followed(system, "mu", "BP1", "nu")
    (point,) = labelled(curve, "BT")
    assert abs(point.parameters["nu"]) <= point.errors["nu"] < 1e-30


@pytest.mark.long
def test_a_crossing_at_zero_is_left_in_units_that_are_none_of_rounding(system) -> None:
    """All parameters are zero there, and kappa: what was left of them made a metric, and steps, of 1e-18."""
    problem = cw.Equilibrium(system, system.defaults() | {"mu": 0.5, "nu": -0.5}, "nu")
    branch = cw.continue_branch(problem, [0.5**0.5, 0.0], range=RANGES["nu"])
    curve = cw.continue_locus(system, branch, "HB1", {"nu": RANGES["nu"], "mu": RANGES["mu"]})
    (point,) = labelled(curve, "BT")  # its pair is imaginary on both sides, and zero there
    assert (point.kind, labelled(curve, "BP")) == ("branch point", [])
    there, _ = reopened(system, curve, point)
    (kind, *_) = [kind for kind in there.point_types if kind.has(point)]
    seed = next(seed for seed in kind.seeds(there, point) if seed.problem.curve.of == "HB")
    state = begin(seed.problem, seed.z, Settings(range=RANGES["nu"], second_range=RANGES["mu"]))
    assert isinstance(state, ContinuationState)
    assert state.sample.z[:2] == pytest.approx([0.0, 0.0], abs=1e-15)  # the other curve is of the state zero
    assert state.sample.z[-1] == pytest.approx(0.0, abs=1e-15)  # nu
    assert state.sample.weights.min() > 1e-9  # begun a hundredth of a millionth aside


def coupled(t, x, p, dx):
    """Two Brusselators that exchange both species, A = 2, D1 = 0.3 (Lefever & Prigogine 1968)."""
    for here, there in ((0, 2), (2, 0)):
        made = x[here] ** 2 * x[here + 1]
        dx[here] = 2.0 - (p.B + 1.0) * x[here] + made + 0.3 * (x[there] - x[here])
        dx[here + 1] = p.B * x[here] - made + p.D * (x[there + 1] - x[here + 1])


@pytest.mark.long
def test_both_curves_of_hopf_points_begin_where_branches_cross() -> None:
    """The states that are alike have them where the other mode has the trace B - 5.6 - 2 D = 0."""
    system = small_system(coupled, ["x", "y", "u", "v"], {"B": 4.0, "D": 1.0})
    problem = cw.Equilibrium(system, system.defaults(), "B")
    branch = cw.continue_branch(problem, [2.0, 2.0, 2.0, 2.0], range=(3.0, 12.0))
    ranges = {"B": (3.0, 12.0), "D": (0.05, 10.0)}
    curve = cw.continue_locus(system, branch, "BP1", ranges)
    (point,) = labelled(curve, "BT")
    there, _ = reopened(system, curve, point)
    (kind,) = [kind for kind in there.point_types if kind.has(point)]
    seeds = kind.seeds(there, point)
    settings = Settings(range=ranges["B"], second_range=ranges["D"])
    begun = sorted(
        (begin(seed.problem, seed.z, settings).sample.z for seed in seeds), key=lambda z: abs(z[0] - z[2])
    )
    assert len(begun) == 2
    alike, apart = begun
    # it begins 1e-6 beside the point, where rounding over that distance moves one curve towards the other
    assert alike[:2] == pytest.approx(alike[2:4], abs=1e-7)
    assert alike[-1] - 5.6 - 2.0 * alike[-2] == pytest.approx(0.0, abs=1e-7)
    assert abs(apart[0] - apart[2]) > 1e-3  # a hundredth of a unit aside, not right beside the point


@pytest.fixture(scope="module")
def apart():
    """The system of coupled Brusselators, and the curve of Hopf points of the other mode, begun afar."""
    system = small_system(coupled, ["x", "y", "u", "v"], {"B": 5.5, "D": 0.35})
    problem = cw.Equilibrium(system, system.defaults(), "B")
    branch = cw.continue_branch(problem, [2.0, 2.75, 2.0, 2.75], range=(5.5, 9.0))
    ranges = {"B": (3.0, 12.0), "D": (0.05, 10.0)}
    return system, cw.continue_locus(system, branch, "HB1", ranges)


@pytest.mark.long
def test_the_double_zero_is_come_to_from_afar(apart) -> None:
    """B = 5.6 + 2 D; the equations of a double zero are singular there, and what creeps ends beside it."""
    _, curve = apart
    assert curve.outcome.reason == "bound"
    (point,) = labelled(curve, "BT")
    assert (point.kind, labelled(curve, "BP")) == ("branch point", [])
    off = point.parameters["B"] - 5.6 - 2.0 * point.parameters["D"]
    assert abs(off) <= point.errors["B"] + 2.0 * point.errors["D"] + 1e-15  # rounding of the sum itself


def test_folds_of_cycles_begin_where_harmonics_are_large(apart) -> None:
    """The fold's own equations begin at a cycle, not at the circle that a cycle is to first order."""
    system, curve = apart
    (point,) = labelled(curve, "GH")
    there, _ = reopened(system, curve, point)
    (kind,) = [kind for kind in there.point_types if kind.has(point)]
    (seed,) = kind.seeds(there, point)
    assert seed.label == "LP"
