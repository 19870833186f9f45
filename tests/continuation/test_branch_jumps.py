"""Steps that end on another branch beside their own are refused, where nothing but their shape tells."""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from made_up import LINE, MadeUp

from contwalk.continuation import branch_jumps
from contwalk.continuation.marks import Observer
from contwalk.continuation.segment import Segment
from contwalk.continuation.settings import Settings
from contwalk.continuation.state import ContinuationState
from contwalk.continuation.step import take_step
from contwalk.numerics.hermite_curve import HermiteCurve

# Of a branch z(lam) of two states, written as a complex number: the place and its rate.
Curve = Callable[[float], tuple[complex, complex]]


def beside(curves: list[Curve]) -> MadeUp:
    """The conjugate of the product of z - z_k(lam): every branch is a saddle, and has the same orientation.

    No count changes and no branch point is passed where a step goes over from one branch to another.
    """

    def factors(z):
        return [complex(z[0], z[1]) - curve(z[2])[0] for curve in curves]

    def f(z):
        value = math.prod(factors(z))
        return [value.real, -value.imag]

    def df(z):
        known = factors(z)
        others = [math.prod(known[:i] + known[i + 1 :]) for i in range(len(known))]
        slope = sum(others)
        along = -sum(other * curve(z[2])[1] for other, curve in zip(others, curves, strict=True))
        return [[slope.real, -slope.imag, along.real], [-slope.imag, -slope.real, -along.imag]]

    return MadeUp(f, df, lambda z: [1.0, -1.0])


def sine(w: float, size: float) -> Curve:
    return lambda lam: (size * math.sin(w * lam) + 0j, size * w * math.cos(w * lam) + 0j)


def ring(w: float, size: float) -> Curve:
    return lambda lam: (size * cmath.exp(1j * w * lam), 1j * w * size * cmath.exp(1j * w * lam))


def rise(steepness: float) -> Curve:
    def curve(lam):
        t = math.tanh(steepness * (lam - 0.11))
        return (0.3 + 0.2j) * t, (0.3 + 0.2j) * steepness * (1.0 - t * t)

    return curve


def shifted(curve: Curve, by: complex) -> Curve:
    return lambda lam: (curve(lam)[0] + by, curve(lam)[1])


def steps_along(curves: list[Curve], start: float, most: float, share: float, points: int = 60):
    """Distances from the first curve, of the points of a walk along it."""
    problem, first = beside(curves), curves[0]
    place, way = first(start)
    settings = Settings(range=(-1.0, 1.0), step=most / 3.0, max_step=most, max_share=share)
    sample = problem.sample((place.real, place.imag, start), (way.real, way.imag, 1.0))
    here = ContinuationState(sample, 0.0, settings.step)
    for _ in range(points):
        step = take_step(problem, here, settings, Observer(LINE, ()))
        z = step.there.z
        yield abs(complex(z[0], z[1]) - first(z[2])[0])
        if z[2] >= 1.0:
            return
        here = ContinuationState(step.there, 0.0, step.next_length)


@pytest.mark.parametrize(
    ("curve", "apart", "start", "number"),
    [
        (sine(10.0, 0.1), 3e-3, -1.0, 2),
        (sine(10.0, 0.1), 1e-3, -1.0, 3),
        (sine(10.0, 1.0), 1e-4, -1.0, 2),
        (sine(30.0, 0.1), 1e-4, -1.0, 3),
        (ring(20.0, 0.1), 1e-2, -1.0, 2),
        (rise(50.0), 1e-2, -0.1, 3),
        (rise(200.0), 3e-3, -0.1, 2),
    ],
)
@pytest.mark.parametrize(("most", "share"), [(0.1, 1.0 / 64.0), (0.3, 0.25)])
def test_a_walk_stays_on_its_branch_beside_others_of_the_same_shape(curve, apart, start, number, most, share):
    curves = [shifted(curve, apart * k) for k in range(number)]
    assert max(steps_along(curves, start, most, share)) < 0.1 * apart


def unfolded(size: float, side: float) -> Curve:
    """One of the two branches of z^2 = lam^2 + size^2."""
    return lambda lam: (side * math.hypot(lam, size) + 0j, side * lam / math.hypot(lam, size) + 0j)


@pytest.mark.parametrize(("most", "share"), [(0.1, 1.0 / 64.0), (0.3, 0.25)])
def test_a_walk_turns_before_an_unfolded_crossing(most, share):
    curves = [unfolded(1e-3, side) for side in (1.0, -1.0)]
    assert max(steps_along(curves, -1.0, most, share)) < 1e-4


def bent(power: float) -> Curve:
    """Straight up to a corner at 0.037, where a power of the distance begins."""

    def curve(lam):
        s = max(lam - 0.037, 0.0)
        return (0.5 + 0.3j) * s**power, (0.5 + 0.3j) * power * s ** (power - 1.0)

    return curve


@pytest.mark.parametrize("power", [1.2, 1.5, 2.0], ids=["tangent", "root", "curvature"])
@pytest.mark.parametrize(("most", "share"), [(0.1, 1.0 / 64.0), (0.3, 0.25)])
def test_a_corner_is_passed_as_if_nobody_looked(power, most, share, monkeypatch):
    told = []
    look = branch_jumps.jumped
    monkeypatch.setattr(branch_jumps, "jumped", lambda *given: told.append(look(*given)) or told[-1])
    assert max(steps_along([bent(power)], -0.5, most, share)) < 1e-9
    assert told
    assert not any(told)


@pytest.fixture
def corrections(monkeypatch):
    """The guesses that are corrected for the check alone."""
    guesses = []
    correct = branch_jumps.correct

    def counted(problem, guess, *rest):
        guesses.append(guess)
        return correct(problem, guess, *rest)

    monkeypatch.setattr(branch_jumps, "correct", counted)
    return guesses


@pytest.mark.parametrize("curve", [sine(10.0, 0.1), ring(20.0, 0.1)])
def test_of_a_branch_alone_few_steps_are_looked_at_closely(curve, corrections):
    count = len(list(steps_along([curve], -1.0, 0.1, 1.0 / 64.0, 400)))
    assert 64 <= count <= 300
    assert len(corrections) <= 0.2 * count


def test_a_step_with_no_solution_half_way_is_not_trusted():
    """lam = x^3 beside a gap: between two solutions the equation has no finite value."""

    def f(z):
        return [z[1] - z[0] ** 3 if abs(z[0]) > 0.02 else math.nan]

    gap = MadeUp(f, lambda z: [[-3.0 * z[0] ** 2, 1.0]], lambda z: [-1.0])
    assert branch_jumps.jumped(gap.segment((-0.3, -0.027), (0.3, 0.027)), 1)
    whole = MadeUp(lambda z: [z[1] - z[0] ** 3], lambda z: [[-3.0 * z[0] ** 2, 1.0]], lambda z: [-1.0])
    assert not branch_jumps.jumped(whole.segment((-0.3, -0.027), (0.3, 0.027)), 1)


def test_a_step_shorter_than_what_could_be_told_is_not_doubted(corrections):
    problem = beside([lambda lam: (0j, 0j), lambda lam: (1e-6 + 0j, 0j)])
    assert not branch_jumps.jumped(problem.segment((0.0, 0.0, 0.0), (1e-6, 0.0, 9e-5)), 9)
    assert not corrections
    assert branch_jumps.jumped(problem.segment((0.0, 0.0, 0.0), (1e-6, 0.0, 2e-4)), 9)


def test_a_step_that_departs_by_less_than_its_ends_are_known_to_is_not_doubted(corrections):
    """As of curves that shrink to nothing: what lies between two such solutions is noise."""
    segment = beside([lambda lam: (0j, 0j), lambda lam: (1e-3 + 0j, 0j)]).segment(
        (0.0, 0.0, 0.0), (1e-3, 0.0, 0.1)
    )
    assert branch_jumps.jumped(segment, 9)
    corrections.clear()
    known = [replace(end, error=1e-3) for end in (segment.a, segment.b)]
    assert not branch_jumps.jumped(Segment(segment.problem, *known), 9)
    assert not corrections


def test_an_arc_of_a_circle_turns_by_its_angle_and_does_not_depart():
    for turn in (1e-3, 0.2):
        ends = [np.array([math.cos(a), math.sin(a)]) for a in (0.3, 0.3 + turn)]
        tangents = [np.array([-end[1], end[0]]) for end in ends]
        arc = HermiteCurve((ends[0], ends[1]), (tangents[0], 3.0 * tangents[1]), np.ones(2))
        assert arc.turn == pytest.approx(turn, rel=1e-9)
        assert arc.departure < 1e-12


def test_an_arc_whose_curvature_begins_departs_by_a_sixth_of_its_turn():
    """y = x^3 / 6 from 0 to h: the tangent turns by h^2 / 2, and the chord rises by h^2 / 6."""
    h = 1e-2
    arc = HermiteCurve(
        (np.zeros(2), np.array([h, h**3 / 6.0])),
        (np.array([1.0, 0.0]), np.array([1.0, h * h / 2.0])),
        np.ones(2),
    )
    assert arc.departure == pytest.approx(arc.turn / 6.0, rel=1e-3)
