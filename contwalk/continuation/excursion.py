"""A curve in two parameters outside its range, until it comes back.

What lies outside is neither stored nor looked at: it only tells which pieces inside are one curve. Its points
are solved for, and nothing else is asked of them.
"""

from __future__ import annotations

from dataclasses import replace

from contwalk.continuation import control, outcomes
from contwalk.continuation.attempt import predict
from contwalk.continuation.correction import Correction
from contwalk.continuation.newton import correct
from contwalk.continuation.settings import Settings
from contwalk.continuation.state import ContinuationState
from contwalk.numerics.hermite_curve import HermiteCurve
from contwalk.numerics.linear import norm_in, unit_in
from contwalk.problems.problem import Problem, Sample, at_stored

# How far outside it is followed: parts of each range's width beyond either end, and steps, tried ones too,
# which are so many times as long as inside at most.
WIDTHS, MOST_STEPS, LONGER = 0.5, 80, 2.0

Reentry = tuple[Problem, ContinuationState]


def reentered(problem: Problem, state: ContinuationState, settings: Settings, sign: float) -> Reentry | None:
    """Where a curve that leaves its range comes back into it, and the equations there.

    `state` is at an end of the range, facing out of it. None where the curve is not followed so far: it
    ends, goes too far or beyond what the plugin declares, or is not the machine's where it comes back.
    """
    ends, outside = _farthest(problem, settings), replace(settings, max_step=LONGER * settings.max_step)
    sample, s, length = state.sample, state.s, state.step
    try:
        for _ in range(MOST_STEPS):
            found = _step(problem, sample, length, settings)
            if found is None:
                length = control.shrunk(length)
                continue
            correction, there = found
            if correction.problem.diagnosis.ended(sample, there) is not None:
                return None
            arc = HermiteCurve((sample.z, there.z), (sample.tangent, there.tangent), sample.weights)
            if control.inside(there.z, settings.bounds):
                begins = replace(state, sample=there, s=s, step=length)
                return _entry(correction.problem, arc, sample, begins, settings, sign)
            if not control.inside(there.z, ends):
                return None
            problem = at_stored(correction.problem, there.z, there.weights)
            length = control.next_step(
                length, control.turn(sample, there.tangent), correction.effort, outside
            )
            sample, s = there, s + sign * arc.length
    except outcomes.BREAKDOWNS:
        return None
    return None


def _farthest(problem: Problem, settings: Settings) -> dict[int, tuple[float, float]]:
    """How far each free parameter may go outside, by its place in z."""
    names = problem.line.names
    declared = {p.name: p.bounds for p in problem.system.parameters}  # type: ignore[attr-defined]
    ends = {}
    for place, (low, high) in settings.bounds.items():
        least, most = declared[names[-1 - place]]
        reach = WIDTHS * (high - low)
        ends[place] = (
            low - reach if least is None else max(low - reach, min(least, low)),
            high + reach if most is None else min(high + reach, max(most, high)),
        )
    return ends


def _step(
    problem: Problem, sample: Sample, length: float, settings: Settings
) -> tuple[Correction, Sample] | None:
    """The solution a step on, with its place and tangent; None where the step is too long."""
    weights, normal = sample.weights, sample.tangent / sample.weights**2
    guess = sample.z + length * sample.tangent
    found = correct(problem, guess, normal, weights, settings.newton_iterations, beside=sample.z)
    if not found.ok or found.linearization is None or norm_in(found.z - guess, weights) > 0.5 * length:
        return None
    tangent = unit_in(found.linearization.tangent(normal, weights), weights)
    angle = control.turn(sample, tangent)
    if angle > settings.max_angle or control.left_branch(sample, found.z, tangent, angle):
        return None
    return found, replace(sample, z=found.z, tangent=tangent)


def _entry(
    problem: Problem,
    arc: HermiteCurve,
    before: Sample,
    state: ContinuationState,
    settings: Settings,
    sign: float,
) -> Reentry | None:
    """The place at which a step that ends inside enters the range; its end where it hardly was outside.

    `before` is the solution at its start, `state` that at its end; the end of the range is met going back.
    """
    there = replace(state.sample, tangent=-state.sample.tangent)
    back = predict(replace(state, sample=there), arc.length, settings)
    guess, normal = (back.guess, back.normal) if back.to_bound else (there.z, arc.normal)
    found = correct(problem, guess, normal, arc.weights, settings.newton_iterations)
    if not found.ok or found.linearization is None:
        return None
    z = found.z.copy()
    if back.bounded is not None:
        z[back.bounded] = guess[back.bounded]
    if not control.inside(z, settings.bounds):
        return None
    tangent = found.linearization.tangent(arc.normal, arc.weights)
    sample = found.problem.examine(z, tangent, arc.weights, found.linearization, None)
    # Outside no spectrum was asked for: what ends a curve by its eigenvalues shows here only.
    if found.problem.diagnosis.ended(before, sample) or _lost(found.problem, sample, settings):
        return None
    return found.problem, ContinuationState(sample, state.s + sign * arc.position(z) * arc.length, state.step)


def _lost(problem: Problem, sample: Sample, settings: Settings) -> bool:
    """Whether a limit at which curves end has been passed outside."""
    if problem.limited is None:
        return False
    limits = zip(problem.limited.limits, sample.margins, strict=True)
    asked = (
        settings.events.get(o.type.like or o.type.label, "ignore") for o, margin in limits if margin < 0.0
    )
    return any(action != "ignore" for action in asked)
