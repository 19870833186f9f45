"""Paths with error control in one call of compiled code: each is that of a call of its own, bitwise."""

from __future__ import annotations

import numpy as np
import pytest
from flow_fields import compiled, van_der_pol

from contwalk import flow
from contwalk.flow.method import Carried, choose, choose_each
from contwalk.flow.path import ErrorControl

METHODS = ["dop853", "verner98", "radau9", "gauss8"]
BOUNDS = np.array([[0.0, 3.0], [1.0, 0.5], [2.0, 2.0], [0.0, 900.0]])
STARTS = np.array([[2.0, 0.0], [0.0, 1.0], [1.0, 1.0], [0.1, 0.2]])


@pytest.fixture(scope="module")
def oscillation():
    """Van der Pol's oscillator, which is stiff where mu is large."""
    return compiled(van_der_pol, 2, 1)


def same(one, other):
    arrays = all(getattr(one, k).tobytes() == getattr(other, k).tobytes() for k in ("times", "states"))
    told = all(getattr(one, k) == getattr(other, k) for k in ("rejected", "stiff_fraction", "status"))
    # One that runs out of room, at 512, 1024, 2048 and 4096 steps, evaluates where it goes on once more.
    return arrays and told and 0 <= other.evaluations - one.evaluations <= 4


def both(field, c, bounds, starts, control, method):
    found = flow.controlled_each(field, c, bounds, starts, control, method)
    each = zip(bounds.tolist(), starts, strict=True)
    return found, [flow.controlled(field, c, t0, x, t1, control, method) for (t0, t1), x in each]


@pytest.mark.parametrize("method", METHODS)
def test_each_path_is_that_of_a_call_of_its_own(oscillation, method):
    """Forwards, backwards, of no length, and with more steps than there is room for at first."""
    bounds = BOUNDS if method in ("dop853", "verner98") else BOUNDS[:3]  # long ones of the others take long
    found, wanted = both(
        oscillation,
        oscillation.constants([1.0]),
        bounds,
        STARTS[: len(bounds)],
        ErrorControl(1e-8, np.array([2.0, 3.0])),
        method,
    )
    assert all(map(same, found, wanted))
    assert [path.status for path in found] == ["ok"] * len(bounds)
    if len(bounds) == 4:
        assert len(found[3].times) > 4 * 128


def test_paths_that_end_on_the_way_leave_those_behind_them_alone():
    """x' = x^2 runs to a pole at t = 1 / x(0); the third path begins where nothing is left of the second."""
    field = compiled(lambda t, x, p: [x[0] ** 2], 1)
    control = ErrorControl(1e-9, np.ones(1), 60)
    bounds = np.array([[0.0, 0.5], [0.0, 2.0], [0.0, 0.5], [0.0, 1e3]])
    starts = np.array([[1.0], [1.0], [1.0], [-1e3]])
    found, wanted = both(field, field.constants([]), bounds, starts, control, "dop853")
    assert all(map(same, found, wanted))
    assert [path.status for path in found] != ["ok"] * 4
    assert found[0].states[-1, 0] == pytest.approx(2.0, rel=1e-8)  # 1 / (1 - 1/2), to some local errors
    assert same(found[0], found[2])


@pytest.mark.parametrize("mu", [1.0, 200.0])
def test_the_choice_for_each_is_its_own(oscillation, mu):
    """Of a stiff oscillation some parts are not: whichever is tried first makes no difference."""
    c, control = oscillation.constants([mu]), ErrorControl(1e-6, np.array([2.0, mu]))
    carried = Carried(oscillation, 3)
    bounds = np.array([[0.0, 0.1], [0.0, 2.0 * mu], [0.0, 1.0]])
    found = list(choose_each(oscillation, c, bounds, STARTS[:3], control, carried))
    for (t0, t1), x, choice in zip(bounds.tolist(), STARTS, found, strict=False):
        own = choose(oscillation, c, t0, x, t1, control, carried)
        assert same(choice.path, own.path)
        for told in ("method", "reason", "stability_limited", "implicit_work"):
            np.testing.assert_equal(getattr(choice, told), getattr(own, told))
    assert (found[1].method == "radau9") == (mu > 100.0)


def test_tolerances_and_shapes_are_checked(oscillation):
    c = oscillation.constants([1.0])
    with pytest.raises(ValueError, match="positive"):
        flow.controlled_each(oscillation, c, BOUNDS, STARTS, ErrorControl(0.0, np.ones(2)))
    with pytest.raises(ValueError, match="starts"):
        flow.controlled_each(oscillation, c, BOUNDS, STARTS[:2], ErrorControl(1e-6, np.ones(2)))
