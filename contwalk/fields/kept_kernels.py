"""Kernels that are derived from a program, kept on disk: for the same one nothing is derived again."""

from __future__ import annotations

import sys
from collections.abc import Callable
from functools import cache
from typing import Any

from contwalk import object_cache
from contwalk.fields.kernel import Kernel
from contwalk.fields.trace import Program
from contwalk.module_texts import text_behind
from contwalk.numerics import noise


class KeptKernels:
    """The kernels that are derived from one program.

    Parameters
    ----------
    program : Program
        As it was traced: later its graph grows by what is derived.
    made_by : str
        The module that derives them. A change of its text, or of what it imports, derives them anew.
    """

    def __init__(self, program: Program, made_by: str) -> None:
        graph = program.graph
        self._key = object_cache.key(
            "kernel", sys.version, generator(made_by), repr((graph.nodes, graph.tables, program.tree))
        )

    def kernel(self, described: object, derive: Callable[[], Kernel]) -> Kernel:
        """The one that an earlier process has derived from the same program, or what `derive` gives.

        Parameters
        ----------
        described : object
            Beside program and module all that decides what is derived: numbers, texts and tuples of them.
        """
        name = object_cache.key(self._key, repr(described))
        found = _read(object_cache.load_values(name))
        if found is None:
            found = derive()
            where = None if found.where is None else found.where.tolist()
            object_cache.store_values(name, (found.text, found.tables, found.shape, where))
        return found


def _read(values: list[Any] | None) -> Kernel | None:
    """An entry; None if it is none."""
    if values is None or len(values) != 4:
        return None
    text, tables, shape, where = values
    sound = isinstance(text, str) and isinstance(tables, list)
    return Kernel.of_text(text, tables, shape, where) if sound else None


@cache
def generator(module: str) -> str:
    """Hash of the text of all modules that what a module makes is derived by."""
    return object_cache.key(str(noise.SEED), *text_behind(module))
