"""A doubled orbit at its birth is not corrected on other steps, where it could become anything.

w goes through the logistic map at each reset of a clock that it slows down: it doubles its period.
"""

from hybrid_runs import diagram, machine

from contwalk.problems.orbit import remesh
from contwalk.system import Transition


def clock():
    def runs(t, x, p, dx):
        dx[0] = x[0] * (1.0 + 0.3 * x[0])
        dx[1] = 0.2 * x[0] * (x[1] - 0.5)

    def begins(t, x, p, y):
        y[0] = 0.1 + 0.1 * x[1]
        y[1] = p.r * x[1] * (1.0 - x[1])

    out = Transition("out", "run", "run", lambda t, x, p: x[0] - 1.0, "rising", begins)
    return machine(["u", "w"], {"r": 2.79}, {"run": runs}, [out])


def test_a_branch_begins_on_the_steps_on_which_its_birth_is_a_solution(monkeypatch):
    """Where other steps always miss: the doubled branch ended at once, with singular equations."""
    monkeypatch.setattr(remesh, "MISSED", 0.0)
    chosen = {"until": "settled", "follow": ["PD"], "depth": 2, "direction": "up", "max_step": 0.5}
    once, twice = diagram(clock(), "r", (2.78, 2.9), [0.16, 0.6], max_points=12, **chosen)
    (doubling,) = [point for point in once.special_points if point.label == "PD"]
    assert doubling.criticality == "supercritical"
    assert twice["r"][-1] > doubling.parameters["r"] + 0.005, twice.outcome
    assert twice["unstable"][-1] == 0  # its parent gone round twice would have one
