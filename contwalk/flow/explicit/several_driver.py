"""The loop around paths with error control, compiled by numba; imported only in order to be compiled."""

from __future__ import annotations

from contwalk.flow.compiled.calling import doubles, inlined, integers
from contwalk.flow.explicit.drivers import adaptive, copy, counts_at, explicit_call, place, step_control
from contwalk.flow.explicit.explicit_call import DONE, FULL
from contwalk.flow.explicit.stages import Y

# What is told of each path.
TOLD = 5
_adaptive = inlined(adaptive)


def adaptive_each(
    address: int,
    paths: int,
    starts: int,
    bounds: int,
    answers: int,
    tolerance: float,
    order: float,
    stable: float,
) -> int:
    """As `drivers.adaptive`, of paths that begin at these vectors, from and until two times each.

    Nodes of one stand behind those of the one before. Of each is told how it ended, and how many steps,
    evaluations, rejected and stiff steps it has; `FULL` where they have no room.
    """
    p = explicit_call(address)
    control, counts = step_control(p.control), counts_at(p.counts)
    times, found = doubles(bounds, 2 * paths), integers(answers, TOLD * paths)
    for j in range(paths):
        if p.room < 0:
            return FULL
        start = starts + 8 * j * p.length
        copy(start, place(p, Y), p.length)
        copy(start, p.nodes, p.length)
        doubles(p.times, 1)[0] = times[2 * j]
        control.time, control.length, control.error, control.undefined = times[2 * j], 0.0, 0.0, 0.0
        counts.steps, counts.rejected, counts.evaluations, counts.stiff = 0, 0, 0, 0
        answer = _adaptive(address, times[2 * j + 1], tolerance, order, stable)
        if answer == FULL:
            return FULL
        own = TOLD * j
        found[own], found[own + 1], found[own + 2] = answer, counts.steps, counts.evaluations
        found[own + 3], found[own + 4] = counts.rejected, counts.stiff
        taken = counts.steps + 1
        p.times += 8 * taken
        p.nodes += 8 * taken * p.length
        p.room -= taken
    return DONE
