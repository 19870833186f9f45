"""Jacobians at many stages of known steps, in the lanes of vector registers.

A batch of stages is an array of vectors of `LANES` doubles: row i holds state i of all its stages, the last
row the times. Jacobians come out alike, a row for each entry.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from contwalk.fields.lanes import LANES, lanes_text
from contwalk.fields.llvm import Code, code_derived_from, code_of
from contwalk.flow.compiled.entry_points import text_behind
from contwalk.flow.compiled.products import product_text

__all__ = ["LANES", "BatchedJacobian", "batched_product", "jacobians_in_lanes"]


@dataclass(frozen=True, eq=False)
class BatchedJacobian:
    """Machine code for the Jacobians of a batch, and for what they do to tangents.

    Parameters
    ----------
    jacobians : Code
        ``jacobians(x, c, out)``, of one batch.
    product : Code
        As `products`, with entries `LANES` doubles apart.
    rows, entries : int
        Rows of a batch of stages but for that of the times, and of one of Jacobians.
    places : ndarray of int64, shape (n,)
        Rows of the states; the others stay zero.
    """

    jacobians: Code
    product: Code
    rows: int
    entries: int
    places: np.ndarray


def jacobians_in_lanes(text: str, states: int, skipped: int) -> Code:
    """``jacobians`` from the text of a field with its Jacobian: its first `skipped` outputs are the field."""
    version = "\n".join(text_behind("contwalk.fields.lanes"))
    return code_derived_from(
        text, ("jacobians",), version, lambda: lanes_text(text, "jacobians", states, skipped)
    )


def batched_product(
    rows: Sequence[Sequence[int]], states: int, ones: Sequence[int], places: Sequence[int] | None = None
) -> Code:
    """``product`` of Jacobians in lanes; arguments as of `products.product_text`."""
    return code_of(product_text(rows, states, ones, places, LANES), ("product",))
