"""A doubled orbit that comes back to its parent where hardly anything holds it away from it."""

import math

from hybrid_runs import diagram, machine

from contwalk.system import Transition

# Where the parent's own multiplier is -1, by its walk and its equations: PD of the orbit of one period.
PARENTS = 0.6323927412846


def test_a_branch_that_hardly_bends_at_its_parent_ends_there():
    """The cubic coefficient is 0.05: beside the pitchfork solutions are known to 1e-4 only.

    A spring is met on one side only; the walk went on in rounding to `max_points`.
    """

    def free(t, x, p, dx):
        dx[0] = x[1]
        dx[1] = -0.1 * x[1] - x[0] + p.force * math.cos(0.8 * t)

    def touching(t, x, p, dx):
        free(t, x, p, dx)
        dx[1] = dx[1] - 5.0 * (x[0] - 1.0)

    spring = lambda t, x, p: x[0] - 1.0  # noqa: E731
    transitions = [
        Transition("meets", "free", "touching", spring, direction="rising", role="soft"),
        Transition("leaves", "touching", "free", spring, direction="falling", role="soft"),
    ]
    modes = {"free": free, "touching": touching}
    system = machine(["q", "v"], {"force": 0.631}, modes, transitions, period=lambda p: 2.0 * math.pi / 0.8)
    (doubled,) = diagram(system, "force", (0.63, 0.64), [0.93, 0.4], until="settled", follow=[], depth=0)
    assert doubled.info.subharmonic == 2
    assert doubled.outcome.reason in ("rejoined", "bound"), doubled.outcome  # of two ends one
    (point,) = [p for p in doubled.special_points if p.label != "EP"]
    assert (point.label, point.kind, point.criticality) == ("BP", "pitchfork", "supercritical")
    assert abs(point.parameters["force"] - PARENTS) <= point.error <= 1e-8
    assert "repeats itself here, or is its own image" in point.note
