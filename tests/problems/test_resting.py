"""Named starts: closed forms stay as they are, guesses become equilibria, others are refused."""

from __future__ import annotations

import numpy as np
import pytest
from small_systems import small_system

from contwalk.errors import StartError
from contwalk.problems.equilibrium.declared import named_equilibria, resting
from contwalk.system import Start


def decays(t, x, p, dx):
    # x = cosh(a), y = x^3 - 2, on scales that differ by 1e6
    dx[0] = np.cosh(p.a) - x[0]
    dx[1] = 1e6 * (x[0] ** 3 - 2.0) - x[1]


def nowhere(t, x, p, dx):
    dx[0] = 1.0 + x[0] ** 2 + p.a * x[1]
    dx[1] = -x[1]


def anywhere(t, x, p, dx):
    # a circle of equilibria, of radius 1
    growth = 1.0 - x[0] ** 2 - x[1] ** 2
    dx[0], dx[1] = growth * x[0], growth * x[1]


def named(field, state, **rest):
    return small_system(field, ("x", "y"), {"a": 0.3}, starts=(Start("rest", lambda p: [state]),), **rest)


def test_a_closed_form_is_kept_to_the_bit():
    x = float(np.cosh(0.3))
    state = [x, 1e6 * (x**3 - 2.0)]
    (found,) = named_equilibria(named(decays, state), "rest", {"a": 0.3})
    assert found.tolist() == state


def test_a_guess_is_corrected():
    (found,) = named_equilibria(named(decays, [1.4, -3e5]), "rest", {"a": 0.3})
    x = float(np.cosh(0.3))
    # to a few roundings of the terms of each equation, 3e6 in the second
    assert found[0] == pytest.approx(x, rel=1e-14)
    assert found[1] == pytest.approx(1e6 * (x**3 - 2.0), abs=1e-13 * 3e6 * 20)


def test_of_a_family_the_nearest_is_taken():
    found = resting(small_system(anywhere, ("x", "y"), {"a": 0.3}), np.array([0.5, 0.5]), {"a": 0.3})
    # along the ray by the field's symmetry, to rounding
    assert found == pytest.approx(np.full(2, np.sqrt(0.5)), rel=1e-14)


def test_where_there_is_no_equilibrium_the_start_is_refused():
    with pytest.raises(StartError, match="'rest' of 'small' is no equilibrium, and Newton's"):
        named_equilibria(named(nowhere, [0.3, 0.0]), "rest", {"a": 0.3})


def test_constant_solutions_of_forced_systems_are_as_they_are_given():
    forced = named(decays, [1.4, -3e5], period=lambda p: 1.0)
    (found,) = named_equilibria(forced, "rest", {"a": 0.3})
    assert found.tolist() == [1.4, -3e5]
