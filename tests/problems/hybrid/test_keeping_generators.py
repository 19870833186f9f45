"""Whether a field carries a neutral direction along, but for rounding, in whatever units the states are."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from small_systems import small_system

from contwalk.flow.hybrid.machine import hybrid_machine
from contwalk.problems.hybrid.families import commutes
from contwalk.problems.orbit.reporting import visits
from contwalk.system import Neutral


def shift(t, x, p, v):
    v[0] = v[1] = v[2] = 1.0


SHIFT = Neutral("shift", shift)


@pytest.mark.parametrize("unit", [1e-6, 1.0, 1e6])
@pytest.mark.parametrize(("third", "kept"), [(0.3, True), (0.31, False)])
def test_what_cancels_but_for_rounding_is_kept(unit, third, kept):
    """0.1 + 0.2 - 0.3 is not zero in floats."""

    def field(t, x, p, dx):
        dx[0] = 0.1 * x[0] + 0.2 * x[1] - third * x[2]
        dx[1] = p.k * (x[0] - x[1])
        dx[2] = p.k * (x[1] - x[2])

    system = small_system(field, "xyz", {"k": 2.0}, neutral=(SHIFT,))
    machine = hybrid_machine(system, system.defaults())
    assert commutes(machine, SHIFT, "only", 0.0, np.zeros(3), np.full(3, unit)) == kept


def test_an_orbit_without_events_meets_none():
    """Nor does one that is reported at a section."""
    for place, eventful in ((None, False), ((0, 0.0, 1.0), True)):
        told = SimpleNamespace(report_at=place)
        assert visits(SimpleNamespace(discretization=told, itinerary=SimpleNamespace(eventful=eventful))) == 0
