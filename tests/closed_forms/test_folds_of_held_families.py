"""A family of equilibria that turns back in what says where on it one is: no eigenvalue passes zero there."""

from __future__ import annotations

import math

import numpy as np
import pytest
from small_systems import labelled, small_system

import contwalk as cw
from contwalk.system import Neutral
from contwalk.verification.checking import checked, records_of
from contwalk.verification.finding import AGREES

RANGES = {"place": (-3.0, 3.0), "mu": (0.3, 2.0)}


def around(t, x, p, v):
    v[0], v[1], v[2] = -x[1], x[0], 0.0


@pytest.mark.parametrize("growth", [-3.0, 3.0])
def test_folds_of_a_circle_in_one_of_its_coordinates(growth: float):
    """x = place is what says where on the circle x^2 + y^2 = mu one is: it turns back at x^2 = mu."""

    def field(t, x, p, dx):
        left = p.mu - x[0] ** 2 - x[1] ** 2
        dx[0] = left * x[0]
        dx[1] = left * x[1]
        dx[2] = (p.mu + growth) * x[2]

    neutral = Neutral("around", around, pin="x", value="place")
    system = small_system(field, "xyz", {"place": 0.0, "mu": 1.0}, neutral=(neutral,))
    rest = cw.Equilibrium(system, system.defaults(), "place")
    branch = cw.continue_branch(rest, [0.0, 1.0, 0.0], (-2.0, 2.0))
    assert [round(point.parameters["place"], 12) for point in labelled(branch, "LP")] == [1.0, -1.0]
    curve = cw.continue_locus(system, branch, "LP1", RANGES)
    place, mu = curve["place"], curve["mu"]
    np.testing.assert_allclose(place**2, mu, rtol=1e-12)
    wanted = np.sort(np.column_stack([-2.0 * mu, mu + growth]))[:, ::-1]
    np.testing.assert_allclose(curve.points["spectrum"], wanted, rtol=1e-12)
    assert (curve["unstable"] == int(growth > 0.0)).all()
    assert (curve["stable"] == int(growth < 0.0)).all()
    found = checked(system, records_of([branch, curve]), RANGES, math.inf)
    assert [each for each in found if each.verdict != AGREES] == []


@pytest.mark.parametrize("growth", [-2.0, 0.6])
def test_orbits_on_a_circle_are_as_stable_where_it_turns_back(growth: float):
    """Its multipliers are those of the cycle itself and the one of the way off the circle."""

    def field(t, x, p, dx):
        left = 1.0 - x[0] ** 2 - x[1] ** 2
        dx[0] = left * x[0] - 6.0 * x[1]
        dx[1] = 6.0 * x[0] + left * x[1]
        off = 0.5 * growth * (x[2] ** 2 + x[3] ** 2 - 1.0)
        dx[2] = off * x[2]
        dx[3] = off * x[3]

    def along(t, x, p, v):
        v[0], v[1], v[2], v[3] = 0.0, 0.0, -x[3], x[2]

    neutral = Neutral("along", along, pin="a", value="place")
    system = small_system(field, "xyab", {"place": 0.8}, neutral=(neutral,))
    orbit = cw.PeriodicOrbit(system, system.defaults(), "place")
    branch = cw.continue_branch(orbit, [1.0, 0.0, 0.8, 0.6], (0.7, 1.5), period=math.pi / 3.0)
    assert branch["place"].max() == pytest.approx(1.0, abs=1e-9)  # it turns back there
    wanted = sorted(np.exp(np.array([-2.0, growth]) * math.pi / 3.0))[::-1]
    np.testing.assert_allclose(branch.points["spectrum"].real, [wanted] * len(branch), rtol=1e-6)
    assert (branch["stable"] == int(growth < 0.0)).all()
