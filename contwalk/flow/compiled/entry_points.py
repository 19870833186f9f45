"""Functions written for numba as object code: compiled once, and loaded afterwards without numba."""

from __future__ import annotations

import ctypes
import re
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache, cached_property
from importlib import import_module, metadata
from importlib.util import find_spec
from pathlib import Path
from threading import RLock
from typing import Any

from contwalk.fields.llvm import Code, cached_code

_CTYPES = {"d": ctypes.c_double, "q": ctypes.c_int64}
_LOCK = RLock()
# An import of this package that begins its line: what is imported for type checks alone is indented.
_IMPORT = re.compile(r"^from (contwalk[\w.]*) import (\([^)]*\)|.*)", re.MULTILINE)


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
        made_from = (self.name, self.result, self.arguments, *texts, metadata.version("numba"))
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


@cache
def modules_behind(module: str) -> tuple[str, ...]:
    """A module and what it imports of this package, directly or not, in alphabetical order.

    None of them is imported for it.
    """
    found, todo = set(), [module]
    while todo:
        name = todo.pop()
        if name not in found:
            found.add(name)
            todo += _imported(_text(name))
    return tuple(sorted(found))


def text_behind(module: str) -> list[str]:
    """Texts of `modules_behind`: what decides how something is made by them."""
    return [_text(name) for name in modules_behind(module)]


def _imported(text: str) -> Iterator[str]:
    """The modules that a text imports of this package; of a package, the modules in it that are named."""
    for module, names in _IMPORT.findall(text):
        found = find_spec(module)
        if found is None or found.submodule_search_locations is None:
            yield module
        else:
            inside = [f"{module}.{name}" for name in re.findall(r"\w+", names)]
            yield from [name for name in inside if find_spec(name)] or [module]


@cache
def _text(module: str) -> str:
    """The text of a module that is not imported for it."""
    found = find_spec(module)
    if found is None or found.origin is None:
        raise ModuleNotFoundError(module)
    return Path(found.origin).read_text(encoding="utf-8")
