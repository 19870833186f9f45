"""Points that are solved for again on finer steps, of made-up equations: errors, what is known of them."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from contwalk.errors import NotFinite
from contwalk.numerics.linear import EPSILON, Factored
from contwalk.problems.orbit import augmented

LEVEL = 1e-12


def made_up(steepness):
    """x = steepness lam, known to LEVEL, on steps that do not matter."""
    jacobian = np.array([[1.0, -steepness]])
    problem = SimpleNamespace(
        size=1,
        line=SimpleNamespace(names=("lam",), free="lam", second=None),
        mesh=SimpleNamespace(tolerance=1e-6),
        discretization=SimpleNamespace(accuracy=1e-9, locating=1e-8),
        linearize=lambda z: SimpleNamespace(levels=(np.array([LEVEL]), None)),
        jacobian=lambda z: jacobian,
        factored=Factored,
    )

    def refined(z, weights, tolerance):
        assert len(z) == len(weights) == 2  # unknowns of the orbit, not those that belong to the point
        return problem

    problem.refined, problem.at_kinks = refined, lambda z: problem
    return problem, jacobian


@pytest.mark.parametrize("steepness", [0.1, 10.0])
def test_where_finer_steps_change_nothing_rounding_is_left(steepness):
    """At x = 1/3: the parameter is known no better than the equation tells it, and than a float holds it."""
    problem, jacobian = made_up(steepness)

    def evaluate(there, y):
        """With an unknown of the point's own, as an angle is."""
        rows = np.vstack([np.append(jacobian, 0.0), [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
        return rows @ y - [0.0, 1.0 / 3.0, 0.7], rows

    start = np.array([0.3, 0.4 / steepness, 0.5])
    system = augmented.Augmented(
        evaluate, start, np.abs(start), lambda found, y: replace(found, data=float(y[-1]))
    )
    sample = SimpleNamespace(z=start[:2], weights=np.array([1.0, 1.0]))
    rough = augmented.solved(problem, system, sample)
    found = rough.settled()
    assert rough.data == pytest.approx(0.7, rel=2.0 * EPSILON)
    assert found.data == pytest.approx(0.7, rel=2.0 * EPSILON)
    assert found.z == pytest.approx([1.0 / 3.0, 1.0 / 3.0 / steepness], rel=2.0 * EPSILON)
    # The equation's own level, or the rounding of its terms where that is less, and no more than both.
    assert min(LEVEL, 1e2 * EPSILON) / steepness < found.error < (LEVEL + 1e2 * EPSILON) / steepness


@pytest.mark.parametrize(("finest", "found"), [(2e-8, True), (1e-5, False)])
def test_a_field_that_is_not_smooth_to_all_digits_is_followed_as_finely_as_it_is(finest, found):
    """Steps for the accuracy that is asked for have no end there, as where a quotient comes near 0/0."""
    problem, jacobian = made_up(2.0)

    def refined(z, weights, tolerance):
        if tolerance < finest:
            raise NotFinite("One period of the motion takes more steps than are allowed.", "")
        return problem

    problem.refined = refined
    system = augmented.Augmented(
        lambda there, y: (np.append(jacobian @ y, y[0] - 0.5), np.vstack([jacobian, [1.0, 0.0]])),
        np.array([0.4, 0.3]),
        np.ones(2),
    )
    sample = SimpleNamespace(z=np.array([0.499, 0.2495]), weights=np.ones(2))
    settled = augmented.solved(problem, system, sample).settled()
    assert (settled is not None) == found
    if found:
        assert abs(settled.z[1] - 0.25) <= settled.error


@pytest.mark.parametrize("refined", [False, True])
def test_a_system_may_say_that_what_solves_it_is_no_point(refined):
    """As of a branch point whose unfolding is not zero: on its own steps, or on the finer ones."""
    problem, jacobian = made_up(2.0)
    system = augmented.Augmented(
        lambda there, y: (np.append(jacobian @ y, y[0] - 0.5), np.vstack([jacobian, [1.0, 0.0]])),
        np.array([0.4, 0.3]),
        np.ones(2),
        lambda found, y: None if found.refined == refined else found,
    )
    sample = SimpleNamespace(z=np.array([0.499, 0.2495]), weights=np.ones(2))
    rough = augmented.solved(problem, system, sample)
    assert (rough is None) != refined
    assert rough is None or rough.settled() is None
