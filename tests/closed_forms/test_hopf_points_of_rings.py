"""Oscillators in a ring: two pairs pass at once, and waves that rotate or stand are born.

Of three it happens at mu = 3 k:

z_j' = (mu + i) z_j - |z_j|^2 z_j + k (z_j+1 + z_j-1 - 2 z_j). Rotating waves have |z|^2 = mu - 3 k; of those
that stand and change their sign under a reflection two cells have it, and one is at rest.
"""

from __future__ import annotations

import numpy as np
import pytest

import contwalk as cw
from contwalk.branch import Branch
from contwalk.continuation.settings import Settings
from contwalk.diagram.branch_in_progress import Start
from contwalk.diagram.diagram import Diagram, Plan
from contwalk.problems.equilibrium.points.lyapunov import critical_space, lyapunov
from contwalk.problems.equilibrium.points.symmetric_vectors import symmetric_vectors
from contwalk.studies.opening import opened
from contwalk.system import Mode, Parameter, State, Symmetry, System

K, LAST = 0.1, 0.6


def ring() -> System:
    def field(t, x, p, dx):
        for i in range(3):
            a, b = x[2 * i], x[2 * i + 1]
            j, k = 2 * ((i + 1) % 3), 2 * ((i + 2) % 3)
            size = a * a + b * b
            dx[2 * i] = (p.mu - size) * a - b + K * (x[j] + x[k] - 2.0 * a)
            dx[2 * i + 1] = a + (p.mu - size) * b + K * (x[j + 1] + x[k + 1] - 2.0 * b)

    def turned(t, x, p, image):
        for i in range(6):
            image[i] = x[(i + 2) % 6]

    def reflected(t, x, p, image):
        image[0], image[1], image[2], image[3] = x[2], x[3], x[0], x[1]
        image[4], image[5] = x[4], x[5]

    return System(
        "ring",
        states=tuple(State(name) for name in ("a1", "b1", "a2", "b2", "a3", "b3")),
        parameters=(Parameter("mu", 0.1),),
        modes=(Mode("only", field),),
        symmetries=(Symmetry("turn", "spatial", turned), Symmetry("reflection", "spatial", reflected)),
    )


def walked(system: System, free: str, state: np.ndarray, settings: Settings) -> list[Branch]:
    """The equilibria from a state at the default of the parameter, and the waves that are born on them."""
    steps, values = cw.Discretization(accuracy=1e-8), system.defaults()
    opening = opened(system, values, free, state, settings, discretization=steps)
    start = Start(system, free, values, opening, "the start")
    made = Diagram([start], Plan(settings, frozenset({"HB"}), 1))
    for _ in made.events():
        pass
    return made.branches


@pytest.mark.long
def test_waves_that_rotate_and_waves_that_stand_are_born() -> None:
    rest, *waves = walked(ring(), "mu", np.zeros(6), Settings(range=(0.1, LAST)))
    points = [p for p in rest.special_points if p.label == "HB"]
    assert [p.parameters["mu"] for p in points] == pytest.approx([3.0 * K] * 2, abs=1e-14)
    assert [b.info.closure for b in waves].count("turn") == 2  # one each way round
    assert [b.info.closure for b in waves].count("reflection") == 1
    assert len(waves) == 4  # and the one that the reflection keeps; all of them once
    assert {b.info.parent[0] for b in waves} == {"b1"}
    for branch in waves:
        assert branch.outcome.reason == "bound"
        radii = np.sort(np.hypot(*[[branch[f"{s}{i}"][-1] for i in (1, 2, 3)] for s in "ab"]))
        if branch.info.closure == "turn":
            assert radii == pytest.approx(
                np.full(3, np.sqrt(LAST - 3.0 * K)), abs=1e-6
            )  # to the walk's steps
        if branch.info.closure == "reflection":
            assert radii == pytest.approx(np.sqrt([0.0, *[LAST - 3.0 * K] * 2]), abs=1e-6)


def neurons() -> System:
    """Four of FitzHugh and Nagumo's that repel each other's voltage; eigenvectors are at no right angles."""

    def field(t, x, p, dx):
        for i in range(4):
            v, w = x[i], x[4 + i]
            dx[i] = v - v**3 / 3.0 - w - 0.1 * (x[(i + 1) % 4] - 2.0 * v + x[(i - 1) % 4])
            dx[4 + i] = 0.08 * (v + p.a - 0.8 * w)

    def turned(t, x, p, image):
        for i in range(4):
            image[i], image[4 + i] = x[(i + 1) % 4], x[4 + (i + 1) % 4]

    def reflected(t, x, p, image):
        for i in range(4):
            image[i], image[4 + i] = x[-i % 4], x[4 + -i % 4]

    return System(
        "neurons",
        states=tuple(State(f"{name}{i}") for name in "vw" for i in range(4)),
        parameters=(Parameter("a", 0.537),),
        modes=(Mode("only", field),),
        symmetries=(Symmetry("turn", "spatial", turned), Symmetry("reflection", "spatial", reflected)),
    )


def test_each_wave_has_its_own_first_lyapunov_coefficient() -> None:
    """Two pairs pass where v^2 = 1 + 0.2 - 0.064, and waves that are images of each other have one."""
    system, v = neurons(), -np.sqrt(1.136)
    rest_state = np.repeat([v, v - v**3 / 3.0], 4)
    problem, a = cw.Equilibrium(system, system.defaults(), "a"), 0.8 * rest_state[-1] - v
    few = Settings(range=(a - 0.004, a + 0.006), max_points=25)
    rest, *waves = walked(system, "a", rest_state, few)
    point = next(p for p in rest.special_points if p.label == "HB")
    assert point.parameters["a"] == pytest.approx(a, abs=1e-13)
    assert point.criticality is None
    assert "4 waves are followed (2 supercritical, 2 subcritical)" in point.note
    z, omega = np.array(point.unknowns), float(point.coefficients["omega"])
    space = critical_space(problem.jacobian(z)[:8, :8], omega).right
    found = [lyapunov(problem, z, omega, q).l1 for q in symmetric_vectors(problem, z, space)]
    # Eigenvectors of a symmetry are known to about 1e-12.
    assert len(found) == 4
    assert found[0] == pytest.approx(found[1], rel=1e-9)
    assert found[2] == pytest.approx(found[3], rel=1e-9)
    assert len(waves) == 4
    assert {wave.outcome.reason for wave in waves} <= {"max_points", "bound"}
