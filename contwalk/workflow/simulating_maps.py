"""One motion of a map for `contwalk simulate`: its iterates, computed by one compiled loop."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from contwalk.fields.rebind import rebound
from contwalk.fields.trace import Tracer, trace
from contwalk.flow.compiled.addresses import address
from contwalk.flow.compiled.compiled_field import EACH
from contwalk.flow.compiled.field import Field
from contwalk.flow.compiled.traced import PARAMETER, STATE, TIME, arguments
from contwalk.system import System
from contwalk.workflow.simulated import Simulated


def next_state(system: System) -> Field:
    """The next state of a map, compiled."""
    (step,), (mode,) = system.transitions, system.modes
    assert step.reset is not None
    copy = rebound(step.reset)

    def after(tracer: Tracer) -> list[Any]:
        t, x, p = arguments(tracer, system, mode.name)
        found = x.copy()
        copy(t, x, p, found)
        return list(found)

    states = [(STATE, i) for i in range(len(system.states))]
    groups = {PARAMETER: len(system.parameters)}
    return Field(trace(after), states, groups, time=(TIME, 0), differentiable=False)


def iterated(
    system: System,
    parameters: Mapping[str, float],
    state: np.ndarray,
    number: int,
    points: int,
    progress: Callable[[float], None],
    part: int = 1 << 16,
) -> Simulated:
    """So many iterates of a state, of which at most `points` are kept, evenly spread.

    Parameters
    ----------
    system : System
    parameters : mapping
    state : ndarray, shape (n,)
    number, points : int
    progress : callable
        Told how many iterates there are.
    part : int
        How many iterates lie between two reports of progress.
    """
    field = next_state(system)
    c = field.constants([parameters[name] for name in system.parameter_names])
    kept = np.unique(np.rint(np.linspace(0, number, min(points, number + 1))).astype(int))
    values = np.empty((len(kept), len(state)))
    values[0], last, done, status, reason = state, state, 0, "ok", ""
    while done < number and status == "ok":
        # What the loop writes for one state is where it reads the next one.
        count = min(part, number - done)
        orbit, times = np.empty((count + 1, len(state))), np.arange(done + 1.0, done + count + 1.0)
        orbit[0] = last
        given = address(times), address(orbit), field.n, address(c), address(orbit[1:]), field.n
        EACH(field.rhs_address, count, *given)
        if not np.isfinite(orbit).all():
            count = int(np.argmin(np.isfinite(orbit).all(axis=1))) - 1
            status = "not_finite"
            reason = f"The map has no finite value at iterate {done + count + 1}."
        wanted = (kept > done) & (kept <= done + count)
        values[wanted] = orbit[kept[wanted] - done]
        last, done = orbit[count], done + count
        progress(float(done))
    reached = kept <= done
    return Simulated(
        times=kept[reached].astype(float),
        values=values[reached],
        modes=np.zeros(int(reached.sum()), dtype=int),
        events=[],
        status=status,
        reason=reason,
        settled=None,
        steps=done,
        evaluations=done,
    )
