"""Finding a periodic orbit by watching a simulation come back to where it was."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from contwalk import flow
from contwalk.errors import NotFinite, StartError
from contwalk.flow.method import Choice, choose
from contwalk.flow.path import ErrorControl
from contwalk.problems.angles import whole_turns
from contwalk.problems.forcing import period_at
from contwalk.problems.initial.magnitudes import magnitudes_on
from contwalk.problems.orbit.lifts import PLAIN
from contwalk.problems.orbit.passage import Passage, closure_of
from contwalk.problems.orbit.shooting import roughness
from contwalk.problems.orbit.traced_leg import ScalarInputs
from contwalk.system import State, System
from contwalk.system.variables import declared_scales

TOLERANCE = 1e-9
# A state that varies by less stands still: squares of such numbers underflow.
LEAST_VARIATION = 1e-150
# A return this near, in units of the motion's range, is one; Newton's method does the rest.
RETURNED = 1e-4
# and in units of the range of the round alone: what is left of a transient makes the motion's range larger.
CLOSED = 1e-2
# A round smaller than this, in units of what errors are measured by, is not known to that part of itself yet.
ROUGH = 1e-5
# Simulated stretches before the search is given up, and steps of all of them.
STRETCHES, MOST_STEPS = 400, 240_000
# A stretch grows until it takes so many steps. A round of more steps is not seen in it: after so many
# stretches without a return they may take as many steps more, and again.
STEPS, PATIENCE = 400, 20
# Returns of one stretch that are looked at: orbits that close after so many rounds are found.
MOST_ROUNDS = 32
# Instants of a step at which it is looked at where a motion is.
PARTS = 4
# Trials for the instant of a return, and when it is near enough, in parts of what brackets it still.
TRIALS, NEAR = 40, 1e-9
# Variations below this part of a state's size are not resolved any better.
LEAST = 1e-3
# A motion this slow against its size is an equilibrium.
STILL = 1e-9


@dataclass(frozen=True)
class Recurrence:
    """A state on (nearly) a periodic orbit, its period in seconds, and half the range of each state on it.

    `magnitudes` are as `variation`, but positive where a state is at rest.
    """

    state: np.ndarray
    period: float
    variation: np.ndarray
    magnitudes: np.ndarray


@dataclass(frozen=True)
class Simulation:
    """A system's motion in one of its modes at fixed parameters, in seconds: n states exist in it."""

    system: System
    parameters: Mapping[str, float]
    mode: str = ""

    def constants(self) -> np.ndarray:
        """What the field depends on: a closure of one second (of one period, if forced).

        Of m parameters it has the shape (2 m + 2,), of a forced system (2 m + 1,).
        """
        names = self.system.parameter_names
        fixed = np.array([self.parameters[name] for name in names])
        scalars = [1.0] if self.system.period is None else []
        return np.concatenate([scalars, [fixed[0]], fixed, np.zeros(len(names))])

    @property
    def passage(self) -> Passage:
        """The field in units of a second, or of a period."""
        scalars = ScalarInputs(self.system.parameter_names[0])
        return closure_of(self.system, scalars, holding=False, mode=self.mode)

    @property
    def states(self) -> tuple[State, ...]:
        """Those that exist in the mode."""
        return tuple(self.system.states[k] for k in self.passage.states)

    def run(self, t: float, x: np.ndarray, end: float, weights: np.ndarray) -> Choice:
        """The motion from t to `end` by the method that works least; `path.status`: what became of it.

        x and the weights, by which errors are measured, have the shape (n,).
        """
        field = self.passage.field(PLAIN)
        c = field.constants(self.constants())
        return choose(field, c, t, x, end, ErrorControl(TOLERANCE, weights))

    def velocity(self, t: float, x: np.ndarray) -> np.ndarray:
        """dx/dt, shape (n,), at a state x, shape (n,)."""
        field = self.passage.field(PLAIN)
        return field(t, x, field.constants(self.constants()))

    def at(self, run: Choice, times: np.ndarray) -> np.ndarray:
        """States, shape (k, n), at any k times of a motion."""
        field = self.passage.field(PLAIN)
        c = field.constants(self.constants())
        return flow.dense(field, c, run.path.times, run.path.states, times, run.method)


class AtRest(StartError):
    """A simulation has come to rest at an equilibrium, at `state`, shape (n,), in `mode` if that is told."""

    def __init__(self, state: np.ndarray, mode: str | None = None) -> None:
        super().__init__(
            "The simulation comes to rest at an equilibrium.",
            "Start with start: {state: {...}}, or simulate from a state that leads to a periodic motion.",
        )
        self.state, self.mode = state.copy(), mode


def recurrent(
    system: System,
    parameters: Mapping[str, float],
    state: np.ndarray,
    until: float | str = "settled",
    mode: str = "",
) -> Recurrence:
    """The periodic orbit that a simulation settles on without an event, in the first mode by default.

    Parameters
    ----------
    state : ndarray, shape (n,)
        Of the states that exist in the mode, as those of what is found.
    until : float or "settled"
        Seconds to simulate before looking for a return.

    Raises
    ------
    NotFinite
        If the motion ends.
    AtRest
        If it comes to rest.
    StartError
        If it does not come back to where it was.
    """
    simulation = Simulation(system, parameters, mode)
    forced = system.period is not None
    unit = 1.0
    if system.period is not None:
        unit = period_at(system, parameters)
    t, x = 0.0, np.array(state, dtype=float)
    reached = np.abs(x)
    weights = _first_weights(simulation.states, reached)
    if until != "settled":
        path = _checked(simulation, simulation.run(t, x, float(until) / unit, weights), unit).path
        t, x = float(path.times[-1]), path.states[-1].copy()
    length = 8.0 if forced else _first_length(simulation, x, weights)
    if until != "settled" and not forced:
        begun = _begun_on(simulation, t, x, length, weights)
        if begun is not None:
            return begun
    taken = 0
    for stretch in range(STRETCHES):
        run = _checked(simulation, simulation.run(t, x, t + length, weights), unit)
        path = run.path
        variation = np.ptp(path.states, axis=0)
        _check_moves(simulation, path, variation, weights)
        found = _return(simulation, run, variation, weights)
        if found is not None:
            return _recurrence(simulation, path, found, unit)
        reached = np.maximum(reached, np.abs(path.states).max(axis=0))
        # A stretch may see next to nothing of a slow motion: what it varies by does not tell all.
        weights = np.maximum(np.maximum(0.5 * variation, LEAST * reached), LEAST * weights)
        weights = np.maximum(weights, LEAST_VARIATION)
        t, x = float(path.times[-1]), path.states[-1].copy()
        taken += len(path.times)
        if taken > MOST_STEPS:
            break
        if len(path.times) < STEPS * (1 + stretch // PATIENCE):
            length *= 1.5
    lasted = simulation.system.lasting(t * unit)
    raise StartError(
        f"The simulation did not come back to where it was within {lasted}: it has not settled, "
        "or settles on a motion that is not periodic.",
        "Simulate for longer with until: SECONDS, or start from another state.",
    )


def _first_weights(declared: Sequence[State], sizes: np.ndarray) -> np.ndarray:
    """Sizes of the states where a motion begins, shape (n,), the least of them in any units of their own.

    What is zero, or next to it, has a part of its declared scale, else of the largest of all, or of 1 if all
    are zero.
    """
    largest = float(sizes.max())
    scales = declared_scales(declared)
    typical = np.where(np.isfinite(scales), scales, largest if largest > 0.0 else 1.0)
    return np.maximum(sizes, LEAST * typical)


def _begun_on(
    simulation: Simulation, t: float, x: np.ndarray, length: float, weights: np.ndarray
) -> Recurrence | None:
    """The orbit that a state lies on, if it does: looked for from the state itself, since a motion leaves an
    unstable one soon; None where it does not come back within as many steps as a stretch has.
    """
    for _ in range(STRETCHES):
        run = simulation.run(t, x, t + length, weights)
        path = run.path
        variation = np.ptp(path.states, axis=0)
        if path.status != "ok" or _still(variation, path.states[-1], weights):
            return None
        found = _return(simulation, run, variation, weights)
        if found is not None:
            return _recurrence(simulation, path, found, 1.0)
        if len(path.times) >= STEPS:
            return None
        length *= 1.5
    return None


def _recurrence(
    simulation: Simulation, path: flow.Path, found: tuple[np.ndarray, float], unit: float
) -> Recurrence:
    """What is told of a return, a state and a time in units of so many seconds, on a path."""
    sizes = magnitudes_on(simulation.states, path.states, TOLERANCE)
    return Recurrence(found[0], found[1] * unit, 0.5 * np.ptp(path.states, axis=0), sizes)


def _first_length(simulation: Simulation, x: np.ndarray, weights: np.ndarray) -> float:
    """A stretch of some steps: what the state needs to change by its own size, ten times over."""
    rate = float(np.max(np.abs(simulation.velocity(0.0, x)) / weights))
    return 10.0 / rate if rate > 0.0 else 10.0


def _checked(simulation: Simulation, run: Choice, unit: float) -> Choice:
    path, system = run.path, simulation.system
    if path.status != "ok":
        what = {
            "not_finite": "the motion is not finite from there on",
            "step_too_small": "the motion grows without bound there, or its field is not smooth",
            "too_many_steps": "going on takes more steps than are allowed",
        }[path.status]
        raise NotFinite(
            f"The simulation ends after {system.lasting(path.times[-1] * unit)}: {what}."
            + roughness(simulation.passage, simulation.constants(), path),
            "Start elsewhere, or mend the plugin.",
        )
    return run


def _check_moves(simulation: Simulation, path: flow.Path, variation: np.ndarray, weights: np.ndarray) -> None:
    """An equilibrium is not an orbit."""
    if simulation.system.period is None and _still(variation, path.states[-1], weights):
        raise AtRest(path.states[-1], simulation.mode or None)


def _still(variation: np.ndarray, state: np.ndarray, weights: np.ndarray) -> bool:
    """Whether states vary by no more than their steps' errors: at a rest at zero that is all that is left."""
    return bool(np.all(variation <= STILL * np.maximum(np.abs(state), weights)))


def _return(
    simulation: Simulation, run: Choice, variation: np.ndarray, weights: np.ndarray
) -> tuple[np.ndarray, float] | None:
    """State and time of the first near return in the later half of a path to a point of it."""
    scale = np.where(variation > LEAST_VARIATION, variation, 1.0)
    turns = np.array([s.period or 0.0 for s in simulation.states])
    begin, end = float(run.path.times[0]), float(run.path.times[-1])
    if simulation.system.period is not None:
        strobe = np.arange(np.ceil(begin), end + 1e-9)
        states = simulation.at(run, np.clip(strobe, begin, end))
        for k in range(1, len(strobe)):
            if _distance(states[k], states[0], scale, turns) < RETURNED:
                return states[0], float(k)
        return None
    times = _refined(run.path.times)
    middle = times[np.searchsorted(times, begin + (end - begin) / 3.0)]
    origin = simulation.at(run, np.array([middle]))[0]
    normal = simulation.velocity(middle, origin) / scale**2
    later = times[times > middle]

    def apart(t: np.ndarray) -> np.ndarray:
        return _turned(simulation.at(run, t) - origin, turns)

    distances = apart(later)
    side = distances @ normal
    near = np.linalg.norm(distances / scale, axis=1) < 0.7
    passed = np.flatnonzero((side[:-1] < 0.0) & (side[1:] >= 0.0) & near[1:])[:MOST_ROUNDS]
    if not len(passed):
        return None
    returns = _zeros(lambda t: apart(t) @ normal, later, side, passed)
    missed = apart(returns)
    for missing, instant in zip(missed, returns, strict=True):
        if not np.linalg.norm(missing / scale) < RETURNED:
            continue
        # What has come to rest, or winds round a rest ever nearer, comes back by the range of its way there.
        loop = np.ptp(distances[later <= instant], axis=0)
        if np.any(loop > ROUGH * weights) and (
            np.linalg.norm(missing / np.maximum(loop, ROUGH * weights)) < CLOSED
        ):
            return origin, float(instant - middle)
    return None


def _refined(times: np.ndarray) -> np.ndarray:
    """The ends of steps and instants between them: in a long step a motion can go far."""
    parts = np.arange(PARTS) / PARTS
    return np.append((times[:-1, None] + np.diff(times)[:, None] * parts).ravel(), times[-1])


def _zeros(
    side: Callable[[np.ndarray], np.ndarray], times: np.ndarray, sampled: np.ndarray, passed: np.ndarray
) -> np.ndarray:
    """Instants at which a path passes its section after those samples: guesses for Newton's method.

    All at once, by false position; a side that stays weighs half as much the next time (the Illinois rule).
    """
    low, high, t = times[passed], times[passed + 1], times[passed]
    below, above = sampled[passed], sampled[passed + 1]
    went_left = went_right = np.zeros(len(passed), dtype=bool)
    for _ in range(TRIALS):
        before, t = t, high - above * (high - low) / (above - below)
        if np.all(np.abs(t - before) <= NEAR * (high - low)):
            break
        here = side(t)
        left = here < 0.0
        above = np.where(left, np.where(went_left, 0.5 * above, above), here)
        below = np.where(left, here, np.where(went_right, 0.5 * below, below))
        low, high = np.where(left, t, low), np.where(left, high, t)
        went_left, went_right = left, ~left
    return t


def _turned(apart: np.ndarray, turns: np.ndarray) -> np.ndarray:
    """Differences with angles reduced to less than half a turn."""
    return apart - whole_turns(apart, turns)


def _distance(x: np.ndarray, y: np.ndarray, scale: np.ndarray, turns: np.ndarray) -> float:
    return float(np.linalg.norm(_turned(x - y, turns) / scale))
