"""Multipliers that pass the unit circle and come back, or pass it both ways, between two points of a branch.

A map by a clock: its multipliers are what the reset says.
"""

from __future__ import annotations

import pytest
from hybrid_runs import diagram, machine
from small_systems import labelled

from contwalk.system import System, Transition


def by_a_clock(*multipliers, values=None) -> System:
    """x_k goes over to m_k(p) x_k - x_k^3 each second."""
    count = len(multipliers)

    def hold(t, x, p, dx):
        for k in range(count):
            dx[k] = 0.0
        dx[count] = 1.0

    def step(t, x, p, after):
        for k, multiplier in enumerate(multipliers):
            after[k] = multiplier(p) * x[k] - x[k] ** 3
        after[count] = 0.0

    names = [*(f"x{k}" for k in range(count)), "c"]
    tick = Transition("tick", "hold", "hold", lambda t, x, p: 1.0 - x[count], reset=step)
    return machine(names, {"lam": 0.0} | (values or {}), {"hold": hold}, [tick])


def walked(system: System, range_: tuple[float, float]):
    count = len(system.state_names)
    (branch,) = diagram(system, "lam", range_, [0.0] * count, {}, until=0.0, mode="hold")
    return branch


@pytest.mark.parametrize("half", [0.05, 0.007, 1e-3, 1e-5])
def test_a_multiplier_that_is_beyond_one_for_a_while(half):
    """1 + w^2 - (lam - c)^2: pitchforks at c - w and c + w."""
    branch = walked(by_a_clock(lambda p: 1.0 + half**2 - (p.lam - 0.3) ** 2, lambda p: 0.3), (-1.0, 1.0))
    found = labelled(branch, "BP", "LP", "PD", "NS")
    assert [(point.label, point.unstable_before, point.unstable_after) for point in found] == [
        ("BP", 0, 1),
        ("BP", 1, 0),
    ]
    for point, expected in zip(found, (0.3 - half, 0.3 + half), strict=True):
        assert abs(point.parameters["lam"] - expected) <= 10.0 * point.error + 1e-15 / half


@pytest.mark.parametrize("apart", [0.1, 0.01, 1e-4])
def test_one_multiplier_leaves_where_another_comes_back(apart):
    """Of four, the third and the fourth pass -1 in opposite directions: as many are unstable as before."""
    system = by_a_clock(
        lambda p: 3.0,
        lambda p: 2.0,
        lambda p: -1.0 - (p.lam - 0.3),
        lambda p: -1.0 + 1.7 * (p.lam - 0.3 - apart),
    )
    found = labelled(walked(system, (-0.5, 1.0)), "PD", "BP", "LP", "NS")
    assert [(point.label, point.unstable_before, point.unstable_after) for point in found] == [
        ("PD", 3, 4),
        ("PD", 4, 3),
    ]
    for point, expected in zip(found, (0.3, 0.3 + apart), strict=True):
        assert point.parameters["lam"] == pytest.approx(expected, abs=1e-12)
