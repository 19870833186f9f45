"""Special points beside each other, at the ends of ranges, and on branches with states that are zero."""

import math

import numpy as np
import pytest
from invariants import check_branch
from small_systems import bifurcations, small_problem

import contwalk as cw
from contwalk.system import Mode, Parameter, State, Symmetry, System


def duffing(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = p.mu * x[0] - x[0] ** 3 - p.d * x[1]


@pytest.mark.parametrize("d", [0.3, 0.0])
def test_a_machine_whose_velocities_are_zero_is_followed_through_its_pitchfork(d):
    problem = small_problem(duffing, "yv", {"mu": -1.0, "d": d}, "mu")
    branch = cw.continue_branch(problem, [0.0, 0.0], (-1.0, 3.0))
    (point,) = bifurcations(branch)
    assert (point.label, point.kind, point.criticality) == ("BP", "pitchfork", "supercritical")
    other = cw.switch_branch(problem, branch, point, (-1.0, 3.0))
    check_branch(other, problem)
    assert other["mu"] == pytest.approx(other["y"] ** 2, rel=1e-12, abs=1e-15)
    assert sorted(other["y"][[0, -1]]) == pytest.approx([-math.sqrt(3.0), math.sqrt(3.0)], rel=1e-14)


@pytest.mark.drawn(1)
@pytest.mark.parametrize("b", [1e-2, 1e-4, 1e-5])
def test_a_hopf_point_beside_a_fold_is_not_taken_for_its_count(b):
    # Bogdanov-Takens: HB at mu = -b^2, where z' changes sign at y = -b, and the fold at 0.
    def field(t, x, p, dx):
        dx[0] = x[1]
        dx[1] = p.mu + p.b * x[1] + x[0] ** 2 + x[0] * x[1]

    problem = small_problem(field, "yz", {"mu": -1.0, "b": b}, "mu")
    branch = cw.continue_branch(problem, [-1.0, 0.0], (-1.0, 1.0))
    hopf, fold = bifurcations(branch)
    assert (hopf.label, hopf.unstable_before, hopf.unstable_after) == ("HB", 0, 2)
    assert hopf.parameters["mu"] == pytest.approx(-b * b, rel=1e-12)
    assert (fold.label, fold.unstable_before, fold.unstable_after) == ("LP", 2, 1)
    assert abs(fold.parameters["mu"]) < 1e-30


def test_the_end_of_a_range_is_a_point_of_the_branch():
    def lorenz(t, x, p, dx):
        dx[0] = 10.0 * (x[1] - x[0])
        dx[1] = x[0] * (p.rho - x[2]) - x[1]
        dx[2] = x[0] * x[1] - 2.0 * x[2]

    branch = cw.continue_branch(small_problem(lorenz, "xyz", {"rho": 0.5}, "rho"), [0.0] * 3, (0.0, 1.0))
    assert [(q.label, q.parameters["rho"]) for q in bifurcations(branch)] == [("BP", 1.0)]

    def hopf(t, x, p, dx):
        r = x[0] ** 2 + x[1] ** 2
        dx[0] = p.mu * x[0] - x[1] - r * x[0]
        dx[1] = x[0] + p.mu * x[1] - r * x[1]

    branch = cw.continue_branch(small_problem(hopf, "xy", {"mu": -1.0}, "mu"), [0.0, 0.0], (-1.0, 0.0))
    assert [(q.label, q.unstable_after) for q in bifurcations(branch)] == [("HB", 2)]

    def fold(t, x, p, dx):
        dx[0] = p.mu + x[0] ** 2

    branch = cw.continue_branch(small_problem(fold, "x", {"mu": -1.0}, "mu"), [-1.0], (-1.0, 0.0))
    assert [q.label for q in bifurcations(branch)] == ["LP"]
    assert branch["x"][[0, -1]] == pytest.approx([-1.0, 1.0])


def test_a_zero_population_stays_zero():
    # Two species: the axes are invariant, and rounding on them must neither grow nor die away for ever.
    def field(t, x, p, dx):
        dx[0] = x[0] * (0.38 + 0.4 * p.mu + 1.096 * x[0] - 0.735 * x[1] - 0.359 * x[0] ** 2)
        dx[1] = x[1] * (-0.43 + 0.898 * p.mu - 0.792 * x[0] - 0.289 * x[1] - 0.225 * x[1] ** 2)

    problem = small_problem(field, "uv", {"mu": 0.1}, "mu")
    trivial = cw.continue_branch(problem, [0.0, 0.0], (-3.0, 3.0))
    points = bifurcations(trivial)
    assert [q.parameters["mu"] for q in points] == pytest.approx([-0.38 / 0.4, 0.43 / 0.898], rel=1e-14)
    for point in points:
        other = cw.switch_branch(problem, trivial, point, (-3.0, 3.0))
        check_branch(other, problem)
        assert other.outcome.status == "complete"
        assert np.all(np.minimum(np.abs(other["u"]), np.abs(other["v"])) == 0.0)


@pytest.mark.drawn(1)
@pytest.mark.parametrize(("role", "kind"), [("spatial", "symmetry-breaking"), ("relabel", "pitchfork")])
def test_a_pitchfork_that_a_mirror_forces_is_symmetry_breaking(role, kind):
    def mirror(t, x, p, image):
        image[0] = -x[0]
        image[1] = -x[1]

    system = System(
        "mirrored",
        states=(State("y"), State("v")),
        parameters=(Parameter("mu", -1.0), Parameter("d", 0.3)),
        modes=(Mode("smooth", duffing),),
        symmetries=(Symmetry("mirror", role, mirror),),
    )
    branch = cw.continue_branch(cw.Equilibrium(system, system.defaults(), "mu"), [0.0, 0.0], (-1.0, 1.0))
    (point,) = bifurcations(branch)
    assert (point.kind, point.criticality) == (kind, "supercritical")
    assert "'mirror'" in point.note


def test_a_branch_whose_parameter_moves_little_is_new():
    def field(t, x, p, dx):
        dx[0] = p.mu * x[0] / p.e - x[0] ** 3
        dx[1] = 1.0 - x[1]

    for e in (1e-4, 1e-9):
        problem = small_problem(field, "yz", {"mu": -e, "e": e}, "mu")
        branch = cw.continue_branch(problem, [0.0, 1.0], (-2.0 * e, 2.0 * e))
        other = cw.switch_branch(problem, branch, "BP1", (-2.0 * e, 2.0 * e))
        assert np.abs(other["y"][[0, -1]]) == pytest.approx([math.sqrt(2.0)] * 2, rel=1e-12)
