"""Scales at the start of a branch, and steps on fine grids."""

import numpy as np
import pytest
from small_systems import labelled, small_problem

import contwalk as cw
from contwalk.branch import SpecialPoint
from contwalk.continuation import state as here
from contwalk.continuation.metric import initial_magnitudes, later_magnitudes
from contwalk.problems.equilibrium.second_direction import branch_point_seeds
from contwalk.system import State


def bratu(n):
    """u'' + lam exp(u) = 0, u(0) = u(1) = 0, by central differences at n points."""

    def field(t, x, p, dx):
        for i in range(n):
            left = x[i - 1] if i > 0 else 0.0
            right = x[i + 1] if i < n - 1 else 0.0
            dx[i] = (left - 2.0 * x[i] + right) * (n + 1) ** 2 + p.lam * np.exp(x[i])

    return field


def test_a_finer_grid_needs_no_more_points():
    counts = []
    for n in (19, 59):
        problem = small_problem(bratu(n), [f"u{i}" for i in range(n)], {"lam": 0.0}, "lam")
        branch = cw.continue_branch(problem, np.zeros(n), (0.0, 4.0), stop_at={"lam": (1.0,)})
        assert branch.outcome.reason == "stop_at"
        counts.append(len(branch))
        # From rest u moves by -A^-1 1 lam: 1 / 8 in the middle, exactly so for central differences; the
        # parameter counts as a hundredth of its range, more than ten unknowns as ten.
        first = branch.points["weights"][0][n // 2]
        assert first == pytest.approx(np.sqrt(n / 10) * 0.04 / 8, rel=1e-9)
    assert abs(counts[1] - counts[0]) <= 3


@pytest.mark.slow
def test_the_fold_of_a_fine_grid_is_reached_from_rest():
    """The fold of the differential equation is at 3.513830719."""
    n = 99
    problem = small_problem(bratu(n), [f"u{i}" for i in range(n)], {"lam": 0.0}, "lam")
    branch = cw.continue_branch(problem, np.zeros(n), (0.0, 4.0), max_points=250)
    (fold,) = labelled(branch, "LP")
    # the order of the method: h^2 times the fourth derivative's part, of size one
    assert fold.parameters["lam"] == pytest.approx(3.513830719, abs=5.0 / (n + 1) ** 2)
    assert branch.points["state"].max() > 2.0  # beyond it


def noisy(t, x, p, dx):
    """y is zero up to rounding: its square and its cube tell nothing of z."""
    dx[0] = p.lam - 0.3 - x[0]
    dx[1] = x[0] / 3.0 - 0.1 * (p.lam - 0.3) / 0.3 - x[1]
    dx[2] = -1.1 * x[2] + 0.0041 * x[1] ** 2
    dx[3] = 4.326 * (x[3] + 1.07) + 0.4642 * x[1] ** 3


def test_rounding_noise_tells_no_scale():
    problem = small_problem(noisy, "xyzw", {"lam": 0.8}, "lam")
    branch = cw.continue_branch(problem, [0.5, 0.0, 0.0, -1.0], (0.5, 1.0))
    assert branch.outcome.reason == "bound"
    weights = branch.points["weights"]
    assert weights.min() > 1e-8
    assert weights.max() < 1e3
    assert len(branch) < 150  # a step moves the parameter by a 64th of the range at most


def test_a_start_whose_state_is_zero_is_scaled_by_how_it_moves():
    """At x = 0 the equation itself tells 1e-8 lam; but x moves by lam / 1e4."""

    def stiff(t, x, p, dx):
        dx[0] = -1e4 * x[0] + x[1]
        dx[1] = 1e4 * (p.lam - x[1])

    problem = small_problem(stiff, "xy", {"lam": 0.0}, "lam")
    z = np.zeros(3)
    found = initial_magnitudes(problem, z, problem.linearize(z), 0.01)
    assert found[:2] == pytest.approx([1e-6, 1e-2], rel=1e-12)


def test_a_declared_scale_of_one_is_kept():
    """One is what stands for an unknown scale too."""

    def small(t, x, p, dx):
        dx[0] = 1e-3 * p.lam - x[0]
        dx[1] = 1e-3 * p.lam - x[1]

    states = (State("x", scale=1.0), "y")
    branch = cw.continue_branch(small_problem(small, states, {"lam": 0.5}, "lam"), [5e-4, 5e-4], (0.0, 1.0))
    assert np.all(branch.points["weights"][:, 0] == 1.0)
    assert branch.points["weights"][:, 1].max() < 2e-3  # by its equation, whose terms add up to 1.5e-3


def test_a_declared_scale_of_one_is_no_reason_to_look_again(monkeypatch):
    """One also stands for what nothing tells yet, which is asked for anew at each point."""
    asked = []
    later = here.later_magnitudes
    monkeypatch.setattr(here, "later_magnitudes", lambda *given: asked.append(1) or later(*given))
    problem = small_problem(field_of_a_line, [State("x", scale=1.0), "y"], {"lam": 0.1}, "lam")
    branch = cw.continue_branch(problem, [0.1, 2.1], (0.1, 0.5))
    assert len(branch) > 3
    assert not asked


def field_of_a_line(t, x, p, dx):
    dx[0] = p.lam - x[0]
    dx[1] = 2.0 + p.lam - x[1]


def harmonics(t, x, p, dx):
    """A pitchfork, and eight harmonics of its amplitude: x_k = x_0^(k + 1)."""
    dx[0] = p.lam * x[0] - x[0] ** 3
    for k in range(1, 9):
        dx[k] = x[0] * x[k - 1] - x[k]


def test_harmonics_are_scaled_by_how_far_they_move_with_the_amplitude():
    """By how little they had moved at first, 1e-21, each factor of the amplitude took a hundred steps."""
    problem = small_problem(harmonics, "abcdefghi", {"lam": -0.01}, "lam")
    trivial = cw.continue_branch(problem, np.zeros(9), (-4.0, 0.05))
    branch = cw.switch_branch(problem, trivial, "BP1", range=(-4.0, 0.05))
    assert branch.outcome.reason == "bound"
    born = int(np.argmin(np.abs(branch.points["s"])))
    weights = branch.points["weights"][born + 1]
    powers = np.arange(2.0, 10.0)
    # each power is larger than the last one by as much: that of all that moves along the arclength 1
    steepness = np.diff(np.log(weights[1:9]))
    assert steepness == pytest.approx(np.full(7, steepness[0]), rel=1e-2)
    assert np.all(weights[1:9] > 0.1 * weights[0] ** powers)
    assert len(branch) < 150


def wave(t, x, p, dx):
    """u'' + lam (u - u^3) = 0 at three points: the middle one is rounding in the second mode."""
    for k, (left, right) in enumerate(((0.0, x[1]), (x[0], x[2]), (x[1], 0.0))):
        dx[k] = left - 2.0 * x[k] + right + p.lam * (x[k] - x[k] ** 3)


def test_dust_that_grows_with_the_amplitude_tells_no_scale():
    """Its power of the amplitude made a weight of 1e-16, to which nothing is known, and steps of 1e-12."""
    problem = small_problem(wave, "abc", {"lam": 2.0}, "lam")
    amplitude = 1e-2
    lam = 2.0 / (1.0 - amplitude**2)
    tangent, weights = np.array([1.0, 3e-16, -1.0, 0.0]) / np.sqrt(2.0), np.array([1.0, 1.0, 1.0, 2.0])
    places = np.array([[0.0, 0.0, 0.0, 2.0], [amplitude, 1.2e-18, -amplitude, lam]])
    origin, sample = (problem.examine(z, tangent, weights, problem.linearize(z), None) for z in places)
    assert not later_magnitudes(problem, sample, weights, origin)[1] < 1e-3 * amplitude


# -- the parameter -------------------------------------------------------------------------------------------


def cancelling(t, x, p, dx):
    """x = 0 is a solution; its terms of size one cancel. (lam + 0.7) x + 0.4 x^2 + ... crosses it at -0.7."""
    dx[0] = (p.lam + 0.7) * x[0] + 0.8 - 0.8 * np.cos(x[0])


@pytest.mark.parametrize("state", [0.0, 3e-17, -2e-16])
@pytest.mark.parametrize("lam", [-0.7, 0.3])
def test_what_the_parameter_goes_with_may_be_noise_of_zero_and_tells_nothing_of_it(state, lam):
    """One over the noise was the magnitude: 1e16."""
    problem = small_problem(cancelling, "x", {"lam": lam}, "lam")
    assert problem.linearize(np.array([state, lam])).magnitudes[-1] == abs(lam)


def test_a_parameter_that_is_zero_is_told_by_what_it_changes():
    """At lam = 0 a change of 0.3 / 2 matters beside a term of 0.3; of noise nothing is known."""
    field = lambda t, x, p, dx: dx.__setitem__(0, 0.3 - x[0] + p.lam * (x[0] + 1.7))  # noqa: E731
    problem = small_problem(field, "x", {"lam": 0.0}, "lam")
    assert problem.linearize(np.array([0.3, 0.0])).magnitudes[-1] == pytest.approx(0.15, rel=1e-14)
    problem = small_problem(cancelling, "x", {"lam": 0.0}, "lam")
    assert np.isnan(problem.linearize(np.array([3e-17, 0.0])).magnitudes[-1])


def test_a_branch_that_is_born_there_sets_out_along_its_own_tangent():
    """In that metric the parameter's share of the tangent was left out as rounding: steps began at 1e-12."""
    problem = small_problem(cancelling, "x", {"lam": 0.3}, "lam")
    point = SpecialPoint("BP", 0.0, unknowns=(3e-17, -0.7), tangent=(0.0, 0.7))
    (seed,) = branch_point_seeds(problem, point)
    assert seed.tangent[0] / seed.tangent[1] == pytest.approx(-2.5, rel=1e-12)
