"""Texts of modules of this package, without importing them: what decides how something is made by them."""

from __future__ import annotations

import re
from collections.abc import Iterator
from functools import cache
from importlib.util import find_spec
from pathlib import Path

# An import of this package that begins its line: what is imported for type checks alone is indented.
_IMPORT = re.compile(r"^from (contwalk[\w.]*) import (\([^)]*\)|.*)", re.MULTILINE)


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
