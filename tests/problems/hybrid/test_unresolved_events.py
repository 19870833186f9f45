"""Events before which motions come to rest in their guard: a branch ends where their instant is unknown."""

import numpy as np
import pytest
from hybrid_runs import branch_of, machine

from contwalk.problems.hybrid.unresolved import _below_since
from contwalk.system import Transition


def clock():
    """A damped oscillator that is kicked where it passes zero upwards."""

    def field(t, x, p, dx):
        dx[0], dx[1] = x[1], -x[0] - 2.0 * p.z * x[1]

    def reset(t, x, p, x_plus):
        x_plus[0], x_plus[1] = x[0], x[1] + 0.1

    kick = Transition("kick", "on", "on", lambda t, x, p: x[0], "rising", reset)
    return machine(["x", "v"], {"z": 0.3}, {"on": field}, [kick])


@pytest.mark.parametrize(("accuracy", "least", "most"), [(1e-8, 0.85, 0.94), (1e-12, 0.95, 0.98)])
def test_a_branch_ends_where_an_event_is_not_resolved(accuracy, least, most) -> None:
    branch = branch_of(
        clock(),
        "z",
        (0.3, 2.0),
        [-0.1, 0.0],
        until="settled",
        accuracy=accuracy,
        direction="up",
        max_points=90,
    )
    assert (branch.outcome.status, branch.outcome.reason) == ("stopped", "event_lost")
    assert "'kick' is not resolved beyond z = 0.9" in branch.outcome.message
    # v falls by exp(-z T) over the period T = 2 pi / sqrt(1 - z^2): to 1e-8, 1e-12 there.
    assert least < branch["z"][-1] < most
    # At the last orbits an instant is known to its error over the rate of the guard, a part in 1e4 at most.
    np.testing.assert_allclose(branch["period"], 2.0 * np.pi / np.sqrt(1.0 - branch["z"] ** 2), rtol=1e-4)


def test_samples_of_a_flight_are_far_apart_and_its_end_is_resolved() -> None:
    """From its top a ball falls to the ground in one step of the integrator."""
    times = np.array([0.0, 0.5, 0.75, 1.0])
    heights = np.array([0.0, 0.4, 0.3, 0.0])
    # Along the last straight line it falls by 0.3 in 0.25: below 0.003 it is in the last hundredth of that.
    assert _below_since(times, heights, 0.003) == pytest.approx(0.9975, rel=1e-12)
    assert _below_since(times, 1e-3 * heights, 0.003) == 0.0
    assert _below_since(times, heights + 1.0, 0.003) == 1.0
