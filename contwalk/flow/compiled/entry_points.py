"""Functions written for numba as object code: compiled once, and loaded afterwards without numba."""

from __future__ import annotations

import ctypes
from dataclasses import dataclass
from functools import cached_property
from importlib import import_module
from threading import RLock
from typing import Any

from contwalk.fields.llvm import Code, cached_code
from contwalk.module_texts import text_behind
from contwalk.version import version_of

_CTYPES = {"d": ctypes.c_double, "q": ctypes.c_int64}
_LOCK = RLock()


@dataclass(frozen=True)
class Entry:
    """A compiled function of one module; a change of anything that this module imports compiles it anew.

    Parameters
    ----------
    module : str
        Module that defines the function for numba; imported only in order to compile it.
    name : str
        The function.
    result, arguments : str
        A letter each: "d" double, "q" 64-bit integer or address.
    """

    module: str
    name: str
    result: str
    arguments: str

    @cached_property
    def code(self) -> Code:
        """The function in memory; compiled if no earlier process has kept it."""
        texts = text_behind(self.module)
        made_from = (self.name, self.result, self.arguments, *texts, version_of("numba"))
        with _LOCK:
            return cached_code(made_from, (self.name,), self._compiled)

    def _compiled(self) -> bytes:
        from contwalk.flow.compiled.calling import (
            object_code,  # numba: half a second that a warm process saves
        )

        function = getattr(import_module(self.module), self.name)
        return object_code(function, self.name, self.result, self.arguments)

    @cached_property
    def address(self) -> int:
        """Where it is, for other compiled functions."""
        return self.code.addresses[self.name]

    @cached_property
    def _call(self) -> Any:
        return self.code.function(self.name, _CTYPES[self.result], *(_CTYPES[a] for a in self.arguments))

    def __call__(self, *arguments: float) -> Any:
        """Call it; the interpreter's lock is released meanwhile."""
        return self._call(*arguments)
