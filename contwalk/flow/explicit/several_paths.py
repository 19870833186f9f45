"""Several paths of one field with error control, in one call of compiled code."""

from __future__ import annotations

import numpy as np

from contwalk.flow.compiled.addresses import address
from contwalk.flow.compiled.compiled_field import CompiledField
from contwalk.flow.compiled.entry_points import Entry
from contwalk.flow.explicit.columns import aligned
from contwalk.flow.explicit.driver_call import Call, checked
from contwalk.flow.explicit.explicit_call import Counts, StepControl
from contwalk.flow.path import FULL, STATUS, ErrorControl, Path

ADAPTIVE_EACH = Entry("contwalk.flow.explicit.several_driver", "adaptive_each", "q", "qqqqqddd")
# Nodes that each path has room for at first.
_ROOM = 128
# Numbers that are told of each path.
_ANSWERS = 5


def adaptive_each(
    field: CompiledField, c: np.ndarray, bounds: np.ndarray, x0: np.ndarray, bound: ErrorControl, method: str
) -> list[Path]:
    """As `integrate.controlled_each`."""
    paths = len(bounds)
    call = Call(field, c, method, None)
    call.weigh(bound.weights)
    starts = aligned(paths, call.length)
    starts[:, : field.n] = checked(x0, (paths, field.n), "starts")
    ends = checked(bounds, (paths, 2), "bounds")
    control, counts, answers = StepControl(), Counts(), np.empty((paths, _ANSWERS), dtype=np.int64)
    call.controlled(control, counts)
    call.record.most_steps, call.record.far_out = bound.max_steps, bound.far_out
    room, answer = _ROOM * paths, FULL
    while answer == FULL:
        times, nodes = np.empty(room), np.empty((room, call.length))
        call.record.times, call.record.nodes, call.record.room = address(times), address(nodes), room - 1
        answer = ADAPTIVE_EACH(
            call.record.address,
            paths,
            address(starts),
            address(ends),
            address(answers),
            bound.tolerance,
            call.method.error_order,
            call.method.stable,
        )
        room *= 2
    call.over()
    found, first = [], 0
    for ended, steps, evaluations, rejected, stiff in answers.tolist():
        own = slice(first, first + steps + 1)
        found.append(
            Path(
                times=times[own].copy(),
                states=nodes[own, : field.n].copy(),
                evaluations=evaluations,
                rejected=rejected,
                stiff_fraction=stiff / max(steps, 1),
                status=STATUS[ended],
            )
        )
        first += steps + 1
    return found
