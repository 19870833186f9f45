"""Branch points and folds beside a state whose own eigenvalue is tiny, and not zero: which one is, is known.

With a state of rate e and none of its own at zero, all coefficients are those without it, whatever e is.
"""

from __future__ import annotations

import numpy as np
import pytest
from small_systems import labelled, small_problem

import contwalk as cw

SLOW = [1e-3, 1e-6, 1e-8, 1e-10, 1e-12]
UNITS = [(1.0, 1.0, 1.0), (1e4, 1e-3, 1e2), (1e-5, 1e3, 1e-1)]


def in_units(rates, units, order):
    """A field of three states in other units and another order."""

    def field(t, x, p, dx):
        own = rates(p, *(x[k] / unit for k, unit in zip(order, units, strict=True)))
        for k, unit, rate in zip(order, units, own, strict=True):
            dx[k] = unit * rate

    return field


def driven(p, x, y, z):
    """y' = (a - 0.5) y - y^3: supercritical, c = -1; x drives it at the rate e, and z follows fast."""
    return p.e * (p.a * x - x**3), (p.a - 0.5) * y - y**3 + 0.1 * x, 1e4 * (y - z)


def slaved(p, x, y, z):
    """x is y^2 in the end, whatever its rate: c = 3 - 1, subcritical."""
    return p.e * (y**2 - x), (p.a - 0.5) * y - y**3 + 3.0 * x * y, p.e**0.5 * (y**3 - z)


def held(p, x, y, z):
    """As above with c = -3 - 1, supercritical, and two slow states one after the other."""
    return p.e * (z - x), (p.a - 0.5) * y - y**3 - 3.0 * x * y, 0.1 * p.e * (y**2 - z)


def exchange(p, x, y, z):
    """y' = (a - 0.5) y - y^2."""
    return -p.e * x, (p.a - 0.5) * y - y**2 + 0.1 * x, -(z - y)


def turning(p, x, y, z):
    """y' = 0.5 - a - y^2 and x' = -e x: a fold, with a = -1 along a q of y alone."""
    return -p.e * x, 0.5 - p.a - y**2 + 0.1 * x, -z + x


@pytest.mark.parametrize("e", SLOW)
@pytest.mark.parametrize("units", UNITS)
@pytest.mark.parametrize(
    ("rates", "kind", "criticality"),
    [
        (driven, "pitchfork", "supercritical"),
        (slaved, "pitchfork", "subcritical"),
        (held, "pitchfork", "supercritical"),
        (exchange, "transcritical", None),
    ],
    ids=lambda each: getattr(each, "__name__", each),
)
def test_the_coefficients_are_those_without_it(rates, kind, criticality, units, e) -> None:
    field = in_units(rates, units, (2, 0, 1))
    problem = small_problem(field, ["s0", "s1", "s2"], {"a": 0.3, "e": e}, "a")
    branch = cw.continue_branch(problem, np.zeros(3), (0.1, 1.0))
    (point,) = labelled(branch, "BP", "LP")
    assert point.status == "located"
    assert point.parameters["a"] == pytest.approx(0.5, abs=1e-14)
    assert (point.kind, point.unstable_after - point.unstable_before) == (kind, 1)
    # A sign is told where it is known, and is right then.
    assert point.criticality in (criticality, None)
    assert point.criticality == criticality or point.coefficients["c_error"] > 0.0
    if units == UNITS[0]:
        assert point.criticality == criticality


@pytest.mark.parametrize("e", SLOW)
@pytest.mark.parametrize("units", UNITS)
def test_so_are_those_of_a_fold(units, e) -> None:
    problem = small_problem(in_units(turning, units, (1, 2, 0)), ["s0", "s1", "s2"], {"a": -0.5, "e": e}, "a")
    start = np.array([0.0, 0.0, 0.0])
    start[2] = units[1]
    branch = cw.continue_branch(problem, start, (-1.0, 1.0))
    (fold,) = labelled(branch, "BP", "LP")
    assert fold.label == "LP"
    assert fold.parameters["a"] == pytest.approx(0.5, abs=1e-14)
    # y = u s with |q| = 1: s' = -u s^2
    assert fold.coefficients["a"] == pytest.approx(-1.0 / units[1], rel=1e-9)


@pytest.mark.parametrize("e", [1e-18, 1e-24])
def test_where_the_slow_state_is_not_known_from_zero_no_sign_is_told(e) -> None:
    problem = small_problem(in_units(driven, UNITS[0], (0, 1, 2)), ["x", "y", "z"], {"a": 0.3, "e": e}, "a")
    branch = cw.continue_branch(problem, np.zeros(3), (0.1, 1.0))
    (point,) = labelled(branch, "BP")
    assert point.criticality in (None, "supercritical")
