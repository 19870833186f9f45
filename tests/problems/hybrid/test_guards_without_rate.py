"""A guard that is the root of what is zero where a motion begins has a value there, and no rate."""

import math

from hybrid_runs import machine, opened

from contwalk.branch import Outcome
from contwalk.system import Transition


def test_the_guard_is_told_and_not_the_field():
    """A rotor that starts at rest in the middle of its ring."""

    def free(t, x, p, dx):
        dx[0], dx[1] = math.cos(t) - x[0], math.sin(t) - x[1]

    def distance(t, x, p):
        return math.sqrt(x[0] ** 2 + x[1] ** 2) - p.clearance

    def back(t, x, p, after):
        after[0], after[1] = 0.1 * x[0], 0.1 * x[1]

    rotor = machine(
        ["x", "y"],
        {"clearance": 0.5},
        {"free": free},
        [Transition("touch", "free", "free", distance, "rising", reset=back)],
        period=lambda p: 2.0 * math.pi,
    )
    failed = opened(rotor, "clearance", [0.0, 0.0], until="settled")
    assert isinstance(failed, Outcome)
    assert failed.reason == "not_finite"
    assert "guard of transition 'touch' (" in failed.message
    assert "no rate at t = 0" in failed.message
    assert "field of mode" not in failed.message
