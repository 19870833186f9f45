"""Tangents over known steps, with the Jacobians of many stages evaluated at once.

On known steps the states do not wait for the tangents. So they go ahead over some steps; Jacobians of all
stages on these are independent of each other, and evaluated in the lanes of vector registers; then the
tangents follow, some columns at a time, as many as stay in the processor's first cache. Every number is that
of a pass that does all at once, bitwise.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from contwalk.flow.compiled.addresses import address
from contwalk.flow.compiled.batched import LANES, BatchedJacobian
from contwalk.flow.compiled.compiled_field import CompiledField
from contwalk.flow.compiled.entry_points import Entry
from contwalk.flow.explicit import stages
from contwalk.flow.explicit.columns import aligned, driving, padded
from contwalk.flow.explicit.explicit_call import BatchedCall, ExplicitCall

MARCH_BATCHED = Entry("contwalk.flow.explicit.batched_driver", "march_batched", "q", "q")

# Bytes that vectors of a block's tangents may take, and Jacobians between two passes.
_FIRST_CACHE, _SECOND_CACHE = 40_000, 300_000
# Numbers of a state's tangents from which on two passes save more than it takes to prepare them.
WORTH = 256
# Steps that are recorded at most.
_MOST_STEPS = 16


class Paths(NamedTuple):
    """Paths over known steps, one after the other: where a time is repeated the next one begins.

    Parameters
    ----------
    c : ndarray
        The field's constants.
    times : ndarray, shape (s,)
    starts : ndarray, shape (m, n)
    tangents : ndarray, shape (n, q)
        Derivatives of each start.
    """

    c: np.ndarray
    times: np.ndarray
    starts: np.ndarray
    tangents: np.ndarray


class Memory:
    """What calls of a method with so many tangents of a field write to, one at a time.

    Parameters
    ----------
    field : CompiledField
    jacobian : BatchedJacobian
        The field's.
    method : str
    columns : int
        How many tangents.
    """

    def __init__(self, field: CompiledField, jacobian: BatchedJacobian, method: str, columns: int) -> None:
        tableau, code, n = stages.TABLEAUS[method], stages.code(method).addresses, field.n
        vectors = stages.vectors(tableau)
        fitting = max(_FIRST_CACHE // (8 * vectors * max(n, 1)) // stages.WIDTH, 1) * stages.WIDTH
        self.blocks = -(-columns // fitting)
        self.width = padded(-(-columns // self.blocks))
        self.length = padded(n)
        self.field, self.jacobian = field, jacobian
        per_step = 8 * tableau.stages_of_step * max(jacobian.entries, 1)
        self.chunk = 2 * min(max(_SECOND_CACHE // per_step // 2, 1), _MOST_STEPS // 2)
        batches = -(-self.chunk * tableau.stages_of_step // LANES)
        self._batches = aligned(batches * (jacobian.rows + 1), LANES)
        self._jacobians = aligned(batches * max(jacobian.entries, 1), LANES)
        self._vectors = aligned(vectors, self.length), aligned(vectors, n * self.width)
        self.recorded = np.array(
            [field.rhs_address, 0, address(self._batches), address(jacobian.places), n, jacobian.rows, 0]
        )
        product = jacobian.product.addresses["product"]
        self.replayed = np.array(
            [product, self.width // stages.WIDTH, 0, address(self._jacobians), jacobian.entries, 0]
        )
        self.states, self.tangents = (
            ExplicitCall(
                step=code["step"],
                evaluate=code[evaluate],
                problem=address(problem),
                n=n,
                length=own.shape[1],
                work=address(own),
            )
            for evaluate, problem, own in zip(
                ("recorded", "replayed"), (self.recorded, self.replayed), self._vectors, strict=True
            )
        )
        self.call = BatchedCall(
            states=self.states.address,
            tangents=self.tangents.address,
            jacobians=jacobian.jacobians.addresses["jacobians"],
            rows=jacobian.rows,
            entries=jacobian.entries,
            chunk=self.chunk,
            blocks=self.blocks,
            driving=max(field.k, 1) * self.width,
        )


def marched(
    field: CompiledField, paths: Paths, sources: Sequence[int] | np.ndarray, method: str
) -> tuple[np.ndarray, np.ndarray] | None:
    """States at all times, shape (s, n), and the derivatives of the paths' ends, shape (m, n, q).

    None where the field's Jacobian cannot be evaluated in lanes. `sources` as of `integrate.tangents`.
    """
    (n, q), (m, _) = paths.tangents.shape, paths.starts.shape
    jacobian = field.batched if n * q >= WORTH else None
    if jacobian is None:
        return None
    spare = field.forms.setdefault((f"{method} in lanes", q), [])
    memory = spare.pop() if spare else Memory(field, jacobian, method, q)
    blocks, width = memory.blocks, memory.width
    driven = _blocks(driving(field.k, blocks * width, sources), blocks)
    columns = np.zeros((n, blocks * width))
    columns[:, :q] = paths.tangents
    carried = np.tile(_blocks(columns, blocks), (m, 1, 1, 1))
    starts, states = np.zeros((m, memory.length)), np.empty((len(paths.times), n))
    starts[:, :n] = paths.starts
    memory.recorded[1] = address(paths.c)
    own = memory.states
    own.times, own.room, own.starts = address(paths.times), len(paths.times) - 1, address(starts)
    own.states = address(states)
    memory.call.carried, memory.call.sources = address(carried), address(driven)
    MARCH_BATCHED(memory.call.address)
    spare.append(memory)
    return states, carried.transpose(0, 2, 1, 3).reshape(m, n, blocks * width)[..., :q].copy()


def _blocks(columns: np.ndarray, blocks: int) -> np.ndarray:
    """Columns in blocks, shape (blocks, rows, width of a block), contiguous."""
    rows = len(columns)
    return np.ascontiguousarray(columns.reshape(rows, blocks, -1).transpose(1, 0, 2))
