"""The loops of `batched_steps`, compiled by numba; imported only in order to be compiled."""

from __future__ import annotations

from contwalk.fields.lanes import LANES
from contwalk.flow.compiled.calling import caller, doubles, integers, record
from contwalk.flow.explicit.drivers import copy, explicit_call, first_stage, place, step
from contwalk.flow.explicit.explicit_call import DONE, BatchedCall
from contwalk.flow.explicit.stages import NEXT, Y

batched_call = record(BatchedCall)
_jacobians = caller("v", "qqq")


def march_batched(address: int) -> int:
    """As `drivers.march_each`, with the tangents of each path in blocks of columns apart from its states.

    Some steps of the states are taken and their stages written down; then the Jacobians of all these stages
    are evaluated, some at once; then each block of tangents takes the same steps.
    """
    p = batched_call(address)
    whole, block = explicit_call(p.states), explicit_call(p.tangents)
    recorded, replayed = integers(whole.problem, 7), integers(block.problem, 6)
    n, length, start, carried = whole.n, whole.length, whole.starts, p.carried
    times, i = doubles(whole.times, whole.room + 1), 0
    copy(start, place(whole, Y), length)
    copy(start, whole.states, n)
    while i < whole.room:
        if times[i + 1] == times[i]:
            copy(place(whole, Y), start, length)
            start += 8 * length
            carried += 8 * p.blocks * block.length
            copy(start, place(whole, Y), length)
            copy(start, whole.states + 8 * (i + 1) * n, n)
            i += 1
            continue
        first, recorded[6] = i, 0
        while i < whole.room and i - first < p.chunk and times[i + 1] != times[i]:
            t, h = times[i], times[i + 1] - times[i]
            first_stage(whole, t, Y)
            step(whole, t, h)
            copy(place(whole, NEXT), place(whole, Y), length)
            copy(place(whole, Y), whole.states + 8 * (i + 1) * n, n)
            i += 1
        for b in range((recorded[6] + LANES - 1) // LANES):
            batch = recorded[2] + 8 * b * LANES * (p.rows + 1)
            _jacobians(p.jacobians, batch, recorded[1], replayed[3] + 8 * b * LANES * p.entries)
        for b in range(p.blocks):
            own = carried + 8 * b * block.length
            replayed[2], replayed[5] = p.sources + 8 * b * p.driving, 0
            copy(own, place(block, Y), block.length)
            for j in range(first, i):
                t, h = times[j], times[j + 1] - times[j]
                first_stage(block, t, Y)
                step(block, t, h)
                copy(place(block, NEXT), place(block, Y), block.length)
            copy(place(block, Y), own, block.length)
    copy(place(whole, Y), start, length)
    return DONE
