"""Whether a motion has come to rest: where its mode draws it to an equilibrium, however slowly."""

from __future__ import annotations

import numpy as np
import pytest
from small_systems import small_system

from contwalk.flow.hybrid.machine import hybrid_machine
from contwalk.flow.hybrid.motion_segment import MotionSegment
from contwalk.problems.initial.coming_to_rest import check_moves
from contwalk.problems.initial.recurrence import AtRest


def arc_of(x):
    times = np.linspace(0.0, 1.0, 5)
    return MotionSegment("only", times, np.tile(x, (5, 1)))


@pytest.mark.parametrize("rate", [1e-3, 1.0, 1e3])
def test_what_stands_still_where_it_is_drawn_to_rests(rate):
    def drawn(t, x, p, dx):
        dx[0] = p.rate * (1.0 - x[0])

    system = small_system(drawn, "x", {"rate": rate})
    machine = hybrid_machine(system, system.defaults())
    with pytest.raises(AtRest):
        check_moves(system, machine.mode("only"), arc_of([1.0]), np.ones(1))


@pytest.mark.parametrize("rate", [1e-3, 1.0, 1e3])
def test_what_stands_still_where_it_is_driven_from_does_not(rate):
    """It creeps away from an equilibrium that repels; a field that is zero draws nothing."""

    def driven(t, x, p, dx):
        dx[0] = p.rate * (x[0] - 1.0)

    def idle(t, x, p, dx):
        dx[0] = 0.0 * p.rate

    for field in (driven, idle):
        system = small_system(field, "x", {"rate": rate})
        machine = hybrid_machine(system, system.defaults())
        check_moves(system, machine.mode("only"), arc_of([1.0]), np.ones(1))
