"""F(z) is a function of z: what was asked before, and in which process, changes no bit of it.

Residuals and Jacobians of a smooth orbit, of one with events, of one whose soft transitions come and go and
of one with soft transitions only, at points on and off the orbit, in two orders, after other calls, and in
processes that were asked nothing else.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import math
import os
import random
import subprocess
import sys
from collections.abc import Callable
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from hybrid_runs import machine, opened
from small_systems import small_problem

from contwalk.continuation.newton import correct
from contwalk.continuation.segment import LostBranch, Segment
from contwalk.continuation.settings import Settings
from contwalk.continuation.state import begin
from contwalk.diagram.opening import Opening
from contwalk.errors import ContwalkError, NotFinite
from contwalk.problems.hybrid.soft_orbit import SoftOrbit
from contwalk.problems.problem import PointType, Problem, Sample, equations_at
from contwalk.system import Transition

pytestmark = pytest.mark.slow

TESTS = Path(__file__).parents[1]
# How far from the orbit: rounding, a correction, a step, and more than one.
DISTANCES = (1e-9, 1e-5, 1e-3, 1e-2, 3e-2, 0.1)


def smooth() -> Opening:
    def field(t, x, p, dx):
        dx[0] = 1.0 - (p.b + 1.0) * x[0] + x[0] ** 2 * x[1]
        dx[1] = p.b * x[0] - x[0] ** 2 * x[1]

    system = small_problem(field, "xy", {"b": 2.4}, "b").system
    return found(opened(system, "b", [1.0, 2.0], until="settled"))


def impacts() -> Opening:
    """A driven oscillator at a wall."""
    return found(opened(oscillator(soft=False), "force", [0.0, 0.5], until="settled"))


def spring_and_wall() -> Opening:
    """The same with a spring on the other side, which the orbit only just reaches."""
    return found(opened(oscillator(soft=True), "force", [0.0, 0.5], {"force": 1.28}, until="settled"))


def springs() -> Opening:
    """A spring is all there is: no transition is hard."""
    return found(opened(oscillator(soft=True, wall=40.0), "force", [0.0, 0.5], until="settled"))


def oscillator(soft: bool, wall: float = 0.2):
    omega, zeta, gap = 1.2, 0.05, 1.2

    def free(t, x, p, dx):
        dx[0] = x[1]
        dx[1] = p.force * math.cos(omega * t) - 2.0 * zeta * x[1] - x[0]

    def held(t, x, p, dx):
        free(t, x, p, dx)
        dx[1] = dx[1] - 6.0 * (x[0] + gap)

    def bounce(t, x, p, after):
        after[0], after[1] = x[0], -0.7 * x[1]

    hit = Transition("hit", "free", "free", lambda t, x, p: wall - x[0], reset=bounce)
    there_and_back = [
        Transition("reach", "free", "spring", lambda t, x, p: x[0] + gap, role="soft"),
        Transition("let_go", "spring", "free", lambda t, x, p: -x[0] - gap, role="soft"),
    ]
    return machine(
        ["q", "v"],
        {"force": 1.0},
        {"free": free, "spring": held} if soft else {"free": free},
        [hit, *there_and_back] if soft else [hit],
        period=lambda p: 2.0 * math.pi / omega,
    )


ORBITS: dict[str, Callable[[], Opening]] = {
    "smooth": smooth,
    "impacts": impacts,
    "spring and wall": spring_and_wall,
    "springs": springs,
}


def found(opening) -> Opening:
    assert isinstance(opening, Opening), opening
    return opening


@cache
def points(name: str) -> list[np.ndarray]:
    """Points around an orbit, and other orbits of the branch; at the farthest there may be no motion."""
    sample = ORBITS[name]().state.sample
    way = np.cos(np.arange(1.0, len(sample.z) + 1.0))
    around = [sample.z + sign * far * sample.weights * way for far in DISTANCES for sign in (1.0, -1.0)]
    return [sample.z, *around, *along(sample), *orbits(name)]


def along(sample: Sample) -> list[np.ndarray]:
    """Points on the tangent of an orbit."""
    return [sample.z + sign * far * sample.tangent for far in DISTANCES[-4:] for sign in (1.0, -1.0)]


@cache
def orbits(name: str) -> list[np.ndarray]:
    """The solutions near them."""
    opening = ORBITS[name]()
    problem, sample = opening.problem, opening.state.sample
    normal = sample.tangent / sample.weights**2
    corrected = [correct(problem, guess, normal, sample.weights) for guess in along(sample)]
    return [each.z for each in corrected if each.ok]


def bits(problem: Problem, z: np.ndarray) -> str:
    """Residual and Jacobian, of the discretisation that reaches z, as one number."""
    _, there = equations_at(problem, z)
    return hashlib.sha256(there.residual.tobytes() + there.jacobian.tobytes()).hexdigest()


def asked_alone(name: str, number: int) -> str:
    """The same of one point, of a problem that has been asked nothing else."""
    opening = ORBITS[name]()
    return bits(opening.problem, points(name)[number])


@cache
def alone(name: str) -> list[str]:
    return [asked_alone(name, number) for number in range(len(points(name)))]


def test_they_are_orbits_of_each_kind():
    kinds = [type(ORBITS[name]().problem).__name__ for name in ORBITS]
    assert kinds == ["PeriodicOrbit", "HybridOrbit", "SoftOrbit", "SoftOrbit"]
    problem = spring_and_wall().problem
    words = {len(equations_at(problem, z)[0].explicit(z)[0].itinerary) for z in orbits("spring and wall")}
    assert words == {1, 3}  # the spring is reached on some of the orbits, on others not


@pytest.mark.drawn(2)
@pytest.mark.parametrize("name", ORBITS)
@pytest.mark.parametrize("seed", [1, 2])
def test_the_order_in_which_points_are_asked_for_changes_no_bit(name, seed):
    opening, chance = ORBITS[name](), random.Random(seed)
    there, known = points(name), alone(name)
    assert len(set(known)) > 0.8 * len(known)
    for number in chance.choices(range(len(there)), k=3 * len(there)):
        assert bits(opening.problem, there[number]) == known[number], number


@pytest.mark.drawn(1)
@pytest.mark.parametrize("name", ORBITS)
def test_what_else_is_asked_changes_no_bit(name):
    opening, chance, known = ORBITS[name](), random.Random(3), alone(name)
    problem, sample = opening.problem, opening.state.sample
    there = points(name)
    for number in chance.sample(range(len(there)), k=len(there)):
        elsewhere(problem, sample, there[chance.randrange(len(there))], chance)
        assert bits(problem, there[number]) == known[number], number


def elsewhere(problem: Problem, sample: Sample, z: np.ndarray, chance: random.Random) -> None:
    """One of the many other things that are asked of a problem along a branch, at some point."""
    there, linearization = equations_at(problem, z)
    asked: list[Callable[[], object]] = [
        lambda: problem.adapted(sample),
        lambda: there.examine(z, sample.tangent, sample.weights, linearization, None),
        lambda: problem.margins(z) if hasattr(problem, "margins") else None,
        lambda: problem.motion_of(z),
        lambda: problem.magnitudes_near(z),
        lambda: _fold(problem).locate(problem, sample, 0),
        lambda: None if linearization.nearby is None else linearization.nearby()(sample.z),
        lambda: beside(problem, sample),
    ]
    with contextlib.suppress(
        ContwalkError, np.linalg.LinAlgError
    ):  # far from the orbit there may be no motion
        chance.choice(asked)()


def _fold(problem: Problem) -> PointType:
    return next(kind for kind in problem.point_types if kind.label == "LP")


def beside(problem: Problem, sample: Sample) -> None:
    """Solutions on a step of the branch."""
    z = sample.z + 1e-2 * sample.tangent
    end = problem.examine(z, sample.tangent, sample.weights, problem.linearize(z), 0)
    with contextlib.suppress(LostBranch):
        Segment(problem, sample, end).at(0.5)


@pytest.mark.drawn(1)
@pytest.mark.parametrize("name", ORBITS)
def test_a_process_of_its_own_finds_the_same_bits(name):
    known, count = alone(name), len(alone(name))
    order = random.Random(4).sample(range(count), k=count)
    assert in_a_process(name, order) == [known[number] for number in order]


def in_a_process(name: str, order: list[int]) -> list[str]:
    """The bits at points in an order, in a Python that has computed nothing before."""
    code = f"import test_pure_equations as own; own.main({name!r}, {order!r})"
    paths = os.pathsep.join([str(TESTS / "problems"), str(TESTS)])
    told = subprocess.run(
        [sys.executable, "-c", code],
        env={**os.environ, "PYTHONPATH": paths},
        capture_output=True,
        text=True,
        check=True,
    )
    return json.loads(told.stdout)


def main(name: str, order: list[int]) -> None:
    opening = ORBITS[name]()
    there = points(name)
    print(json.dumps([bits(opening.problem, there[number]) for number in order]))


def test_a_branch_begins_where_other_soft_transitions_are_met(monkeypatch):
    """At a solution that the problem of the point before does not reach: as that of its own problem does."""
    opening = spring_and_wall()
    problem, sample = opening.problem, opening.state.sample
    z = next(z for z in orbits("spring and wall") if problem.linearize(z).remeshed is not None)
    settings = Settings((0.5, 2.0))
    begun, own = (begin(each, z, settings, sample.tangent) for each in (problem, equations_at(problem, z)[0]))
    assert begun.sample.z.tolist() == own.sample.z.tolist() == z.tolist()
    assert begun.sample.eigenvalues.tolist() == own.sample.eigenvalues.tolist()

    def refused(self: SoftOrbit, z: np.ndarray) -> None:
        raise NotFinite("The instants have no solution.", "")

    monkeypatch.setattr(SoftOrbit, "remeshed", refused)
    with pytest.raises(NotFinite, match="no finite value there"):
        begin(spring_and_wall().problem, z, settings, sample.tangent)
