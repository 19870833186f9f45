"""Steps on which orbits are integrated: made for an orbit, and kept while equations are solved on them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise

import numpy as np

from contwalk import flow
from contwalk.errors import NotFinite
from contwalk.flow.method import Carried, Choice, choose_each
from contwalk.flow.tableaus.runge_kutta import DOP853
from contwalk.numerics.distinct import distinct
from contwalk.problems.kinks import at_the_end
from contwalk.problems.orbit import without_value
from contwalk.problems.orbit.lifts import PLAIN, TANGENT
from contwalk.problems.orbit.passage import Passage

# An orbit that moves less than this part of typical magnitudes is at rest: solutions are known to 1e-10.
AT_REST = 1e-9
# A state that moves less than this part of what the one does that moves most does not move.
CONSTANT = 1e-5
# A motion that has grown so much when its steps vanish grows without bound.
BURST = 1e3
# A motion that ends beyond this part of a leg may have passed the leg's own event.
AT_ITS_END = 1.0 - 1e-6
# How far beyond such an end it is looked what has no value, in lengths of the last step.
BEYOND = 8.0
# Steps of a leg at most.
MOST_STEPS = 100_000


@dataclass(frozen=True, eq=False)
class Mesh:
    """Steps of each segment in time, 0 to 1 over the closure or of segments of legs over each, and how they
    came about.

    Parameters
    ----------
    steps : tuple of ndarray
        Times of each segment's steps, its two ends included.
    method : str
        The integrator, one of `flow.METHODS`.
    tolerance : float
        Local error of each state in units of its variation along the orbit.
    variation : ndarray, shape (n,)
        Half the range of each state, or its typical magnitude where it hardly moves.
    magnitudes : ndarray, shape (n,)
        Typical magnitudes of the states.
    reason : str
        Why this integrator.
    total : float
        The duration of the closure, where it is unknown: the unit of durations.
    grown : tuple of float
        How much a generic deviation grows at most over each segment, from any time on.
    amplified : float
        What local errors grow by at most over a segment, in units of the tolerance, beyond what is expected.
    guards : ndarray, shape (m,), optional
        The largest value of each leg's own guard on it: the units of guards.
    """

    steps: tuple[np.ndarray, ...]
    method: str
    tolerance: float
    variation: np.ndarray
    magnitudes: np.ndarray
    reason: str = ""
    total: float = 1.0
    grown: tuple[float, ...] = ()
    amplified: float = 1.0
    guards: np.ndarray | None = None

    @property
    def growth(self) -> float:
        """The largest growth of a generic deviation within a segment."""
        return max(self.grown, default=1.0)

    @property
    def segments(self) -> int:
        """Number of segments."""
        return len(self.steps)

    @cached_property
    def cuts(self) -> np.ndarray:
        """Times at which the segments start, shape (m,)."""
        return np.array([steps[0] for steps in self.steps])

    def divided(self, cuts: np.ndarray) -> Mesh:
        """The same steps in segments that start at other times, or at the steps next to these (m,).

        A motion that is cut at its own steps stays the same to the last bit.
        """
        times = distinct(self.times)
        after = np.clip(np.searchsorted(times, cuts), 1, len(times) - 1)
        nearest = after - (cuts - times[after - 1] < times[after] - cuts)
        bounds = np.append(distinct(nearest), len(times) - 1)
        steps = tuple(times[first : last + 1] for first, last in pairwise(bounds) if last > first)
        return replace(self, steps=steps, grown=())  # what was seen was over others

    def begun(self, time: float) -> tuple[Mesh, float]:
        """The same steps in one segment that begins at the step next to a time, and when that is."""
        times = distinct(self.times)
        k = int(np.argmin(np.abs(times[:-1] - time)))
        first = float(times[k])
        later = np.concatenate([times[k:] - first, times[1 : k + 1] + (1.0 - first)])
        later[-1] = 1.0
        return replace(self, steps=(later,)), first

    @cached_property
    def times(self) -> np.ndarray:
        """Times of all segments' steps, one segment after the other: where two meet, a time is repeated.

        Shape (s,).
        """
        return np.concatenate(self.steps)

    @cached_property
    def ends(self) -> np.ndarray:
        """Where in `times` the segments end, shape (m,)."""
        return np.cumsum([len(steps) for steps in self.steps]) - 1


def velocity(passage: Passage, x: np.ndarray, time: float, values: np.ndarray) -> np.ndarray:
    """dx/dt at a time in 0..1, in units of the leg's duration, shape (n,)."""
    field = passage.field(PLAIN)
    return field(time, x, field.constants(values))


@dataclass(frozen=True, eq=False)
class Run:
    """A part of a motion that steps are made for.

    Parameters
    ----------
    passage : Passage
    x, scalars : ndarray
        Its start, and the scalars of the leg.
    carried : int
        Tangents that are to be computed on its steps.
    begin, end : float
        Times of the leg, 0..1.
    """

    passage: Passage
    x: np.ndarray
    scalars: np.ndarray
    carried: int
    begin: float = 0.0
    end: float = 1.0


def stepped(
    runs: Sequence[Run],
    fixed: np.ndarray,
    variation: np.ndarray,
    tolerance: float,
    method: str,
    most: int = MOST_STEPS,
    closure: bool = False,
) -> tuple[list[flow.Path], str, str]:
    """The path of every run with a generic neighbour, the integrator, and why this one.

    The neighbour makes sure that derivatives are right too: where the motion stands still, itself would
    allow steps of any length. Runs of a closure are parts of one motion, in the same times.
    """
    together = [_Together.of(runs, fixed, variation, tolerance, most)] if closure else []
    each = together or [_Together.of([run], fixed, variation, tolerance, most, True) for run in runs]
    if method == "auto":
        choices = [choice for some in each for choice in some.chosen()]
        stiffest = max(choices, key=lambda choice: choice.stability_limited)
        method, reason = stiffest.method, stiffest.reason
        if len({choice.method for choice in choices}) == 1:
            return [choice.path for choice in choices], method, reason
    else:
        reason = "as the run file says"
    return [path for some in each for path in some.paths(method)], method, reason


@dataclass(frozen=True, eq=False)
class _Together:
    """Runs of one field with the same scalars, each with a generic neighbour.

    Parameters
    ----------
    run : Run
        One of them.
    values, constants : ndarray
        What their field depends on, and that of their lift.
    bounds, starts : ndarray, shapes (m, 2) and (m, 2 n)
    control : ErrorControl
    """

    run: Run
    values: np.ndarray
    constants: np.ndarray
    bounds: np.ndarray
    starts: np.ndarray
    control: flow.ErrorControl

    @classmethod
    def of(
        cls,
        runs: Sequence[Run],
        fixed: np.ndarray,
        variation: np.ndarray,
        tolerance: float,
        most: int,
        far_out: bool = False,
    ) -> _Together:
        """Some runs; arguments as for `stepped`, and `far_out` as of an `ErrorControl`."""
        run = runs[0]
        field, sizes = run.passage.field(TANGENT), variation[list(run.passage.states)]
        generic = sizes * np.cos(np.arange(1.0, len(sizes) + 1.0))
        values = np.concatenate([run.scalars, fixed])
        c = field.constants(np.concatenate([values, np.zeros(len(run.scalars))]))
        starts = np.array([np.concatenate([each.x, generic]) for each in runs])
        control = flow.ErrorControl(tolerance, np.concatenate([sizes, sizes]), most, far_out)
        return cls(run, values, c, np.array([(each.begin, each.end) for each in runs]), starts, control)

    @property
    def _given(self) -> tuple[flow.CompiledField, np.ndarray, np.ndarray, np.ndarray, flow.ErrorControl]:
        field = self.run.passage.field(TANGENT)
        return field, self.constants, self.bounds, self.starts, self.control

    def chosen(self) -> Iterator[Choice]:
        """The method for each; where one ends on the way, the others need not be tried."""
        carried = Carried(self.run.passage.field(PLAIN), self.run.carried)
        for choice in choose_each(*self._given, carried):
            arrived(choice.path, self.run.passage, self.values)
            yield choice

    def paths(self, method: str) -> list[flow.Path]:
        """Their paths by a method."""
        found = flow.controlled_each(*self._given, method)
        return [arrived(path, self.run.passage, self.values) for path in found]


def arrived(path: flow.Path, passage: Passage | None = None, values: np.ndarray | None = None) -> flow.Path:
    """A path that reached its end; `passage` and `values` tell more of one that did not.

    Raises
    ------
    NotFinite
        With what became of the motion.
    """
    if path.status == "ok":
        return path
    status, rough = path.status, ""
    if passage is not None and values is not None:
        _refuse_steep_event(path, passage, values)
        rough = roughness(passage, values, path) or _without_value(passage, values, path)
    if status == "step_too_small" and np.abs(path.states[-1]).max() > BURST * np.abs(path.states[0]).max():
        status = "not_finite"
    raise NotFinite(_SENTENCES[status] + rough, "Start elsewhere, or keep the run away from there.")


def _refuse_steep_event(path: flow.Path, passage: Passage, values: np.ndarray) -> None:
    """Raise for a motion that ends right after its event, for which its instant is too steep."""
    transition, n = passage.leg.transition, len(passage.states)
    if path.status == "too_many_steps" or transition is None or path.times[-1] < AT_ITS_END:
        return
    watched, state = passage.watched(transition.name, transition.guard), np.nan_to_num(path.states[-1:, :n])
    after = float(watched.along(path.times[-1:], state, values, np.zeros((1, n)))[0, 0])
    if (after < 0.0) != (transition.direction == "falling"):
        return
    raise NotFinite(
        # By how little is not said: steps end before the pole, and guesses of the duration beyond it.
        f"The motion ceases to exist right after '{transition.name}', as a spike does that runs to a pole: "
        "so near to it the event's instant is not known well enough. "
        "Let the guard act earlier on the way up, and the reset stand for the rest of it.",
        "Start elsewhere, or mend the plugin.",
    )


def roughness(passage: Passage, values: np.ndarray, path: flow.Path) -> str:
    """A sentence where a path of a lift ends at a place at which the field is smooth by pieces only."""
    course = passage.course(values, path.times, path.states[:, : len(passage.states)])
    return "" if course is None or path.status == "not_finite" else at_the_end(course)


def _without_value(passage: Passage, values: np.ndarray, path: flow.Path) -> str:
    """A sentence where the field has no value right beyond the end of a path of a lift."""
    if len(path.times) < 2:
        return ""
    (before, last), nodes = path.times[-2:], path.states[-2:, : len(passage.states)]
    steps = np.array([before, last, min(last + BEYOND * (last - before), 1.0)])
    line = without_value.along(
        passage, values, steps, np.vstack([nodes, np.full_like(nodes[:1], np.nan)]), DOP853.name
    ) or without_value.vanishing(passage, values, path.times, path.states[:, : len(passage.states)])
    return f" {line}" if line else ""


def growth_of(deviations: np.ndarray) -> float:
    """How much a deviation grows at most from any time on. Deviations have the shape (s, n)."""
    sizes = np.sqrt((deviations * deviations).sum(axis=1))
    return float((sizes / np.minimum.accumulate(np.maximum(sizes, 1e-300))).max())


_SENTENCES = {
    "not_finite": "The motion is not finite within one period: it ends, or grows without bound.",
    "too_many_steps": "One period of the motion takes more steps than are allowed.",
    "step_too_small": "The integrator's step becomes too small within one period: the field is not "
    "smooth there.",
}
