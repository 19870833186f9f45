"""Which files a plugin consists of, and their hashes, told without running any of them.

The files of a plugin are its own file and those of its folder (of an installed system: of its package) that
it imports, found by reading the import statements, those of imported files included. What a plugin loads in
other ways, from other folders or from installed packages, is not among them.
"""

from __future__ import annotations

import ast
import hashlib
import marshal
import os
import sys
from collections.abc import Iterator, Mapping
from functools import lru_cache
from importlib.util import find_spec
from pathlib import Path
from typing import NamedTuple

from contwalk import object_cache
from contwalk.system.installed import Installed

# What `ast.parse` raises for text that is no Python, or is nested beyond its means.
_UNREADABLE = (SyntaxError, ValueError, RecursionError, MemoryError)
# Where statements have others in them.
_BLOCKS = ("body", "orelse", "finalbody", "handlers", "cases")


def hashes_of_file(path: Path) -> dict[str, str]:
    """SHA-256 of each file of a plugin, by its path in the plugin's folder; empty where it is missing."""
    path = Path(os.path.abspath(path))
    return _hashes(path.parent, _closure(path.parent, "", [path]))


def hashes_of_installed(point: Installed) -> dict[str, str]:
    """The same for an installed system, by paths in its package; empty where it cannot be found."""
    top, *rest = point.module.split(".")
    spec = find_spec(top) if top.isidentifier() else None  # imports nothing: the name has no dot
    if spec is None:
        return {}
    if not spec.submodule_search_locations:
        return hashes_of_file(Path(spec.origin)) if spec.origin else {}
    folder = Path(next(iter(spec.submodule_search_locations))).resolve()
    return _hashes(folder, _closure(folder, top, [folder / "__init__.py", *_files_of(folder, rest)]))


def hash_of(files: Mapping[str, str]) -> str:
    """One hash for all files; empty where there is none."""
    text = "\n".join(f"{name} {digest}" for name, digest in sorted(files.items()))
    return hashlib.sha256(text.encode()).hexdigest() if files else ""


def _hashes(folder: Path, files: Mapping[Path, bytes]) -> dict[str, str]:
    return {
        path.relative_to(folder).as_posix(): hashlib.sha256(content).hexdigest()
        for path, content in sorted(files.items())
    }


def _closure(folder: Path, package: str, first: list[Path]) -> dict[Path, bytes]:
    """Contents of some files and of all that they import of `folder`, which is the folder of `package`."""
    found: dict[Path, bytes] = {}
    waiting = list(first)
    while waiting:
        path = waiting.pop()
        if path in found or not path.is_file():
            continue
        found[path] = path.read_bytes()
        for parts in _imports(found[path], path, folder, package):
            waiting += _files_of(folder, parts)
    return found


class Import(NamedTuple):
    """An import statement: `from ..a.b import c, d` has two dots, `origin` a.b and `names` c and d.

    `import a.b, c` has names only, and an `origin` of None; that of `from . import c` is empty.
    """

    dots: int
    origin: str | None
    names: tuple[str, ...]


def _imports(content: bytes, path: Path, folder: Path, package: str) -> Iterator[list[str]]:
    """Names that a file imports, split at their dots, as seen from `folder`."""
    for statement in _import_statements(content):
        if statement.origin is None:
            absolute = [name.split(".") for name in statement.names]
        else:
            base = statement.origin.split(".") if statement.origin else []
            # What is imported from a package may be a module of it.
            absolute = [base, *([*base, name] for name in statement.names)]
        if statement.dots:
            yield from _relative(absolute, statement.dots, path, folder)
        elif not package:
            yield from absolute
        else:
            yield from (parts[1:] for parts in absolute if parts[:1] == [package])


@lru_cache(maxsize=256)
def _import_statements(content: bytes) -> tuple[Import, ...]:
    """Import statements of a text wherever they stand; none of one that is no Python.

    They are kept on disk under the text: to read a plugin takes ten times as long.
    """
    name = object_cache.key("imports", sys.version, hashlib.sha256(content).hexdigest())
    kept = object_cache.load(name)
    if kept is not None:
        return tuple(Import(*statement) for statement in marshal.loads(kept))
    try:
        found = tuple(_read(ast.parse(content)))
    except _UNREADABLE:
        return ()
    object_cache.store(name, marshal.dumps([tuple(statement) for statement in found]))
    return found


def _read(tree: ast.AST) -> Iterator[Import]:
    """The import statements of a parsed text."""
    waiting = [tree]
    while waiting:
        node = waiting.pop()
        if isinstance(node, ast.Import):
            yield Import(0, None, tuple(alias.name for alias in node.names))
        elif isinstance(node, ast.ImportFrom):
            yield Import(node.level, node.module or "", tuple(alias.name for alias in node.names))
        # Statements stand in statements only: expressions, most of a text, need not be looked at.
        waiting += [child for block in _BLOCKS for child in getattr(node, block, ())]


def _relative(names: list[list[str]], level: int, path: Path, folder: Path) -> Iterator[list[str]]:
    """Names with leading dots, as seen from `folder`; none that lead out of it."""
    here = list(path.parent.relative_to(folder).parts)
    if level - 1 <= len(here):
        yield from ([*here[: len(here) - (level - 1)], *parts] for parts in names)


def _files_of(folder: Path, parts: list[str]) -> list[Path]:
    """Files that importing a name of `folder` runs: the packages on the way, and the module."""
    files = []
    place = folder
    for part in parts:
        files += [place / part / "__init__.py", place / f"{part}.py"]
        place = place / part
    return [file for file in files if file.is_file()]
