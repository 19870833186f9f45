"""Which files a plugin consists of, and their hashes, told without running any of them.

The files of a plugin are its own file and those of its folder (of an installed system: of its package) that
it imports, found by reading the import statements, those of imported files included. What a plugin loads in
other ways, from other folders or from installed packages, is not among them.
"""

from __future__ import annotations

import ast
import hashlib
import os
from collections.abc import Iterator, Mapping
from functools import lru_cache
from importlib.metadata import EntryPoint
from importlib.util import find_spec
from pathlib import Path

# What `ast.parse` raises for text that is no Python, or is nested beyond its means.
_UNREADABLE = (SyntaxError, ValueError, RecursionError, MemoryError)
# Where statements have others in them.
_BLOCKS = ("body", "orelse", "finalbody", "handlers", "cases")


def hashes_of_file(path: Path) -> dict[str, str]:
    """SHA-256 of each file of a plugin, by its path in the plugin's folder; empty where it is missing."""
    path = Path(os.path.abspath(path))
    return _hashes(path.parent, _closure(path.parent, "", [path]))


def hashes_of_installed(point: EntryPoint) -> dict[str, str]:
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


def _imports(content: bytes, path: Path, folder: Path, package: str) -> Iterator[list[str]]:
    """Names that a file imports, split at their dots, as seen from `folder`."""
    for node in _import_statements(content):
        if isinstance(node, ast.Import):
            absolute = [alias.name.split(".") for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            base = node.module.split(".") if node.module else []
            # What is imported from a package may be a module of it.
            absolute = [base, *([*base, alias.name] for alias in node.names)]
        else:
            continue
        if isinstance(node, ast.ImportFrom) and node.level:
            yield from _relative(absolute, node.level, path, folder)
        elif not package:
            yield from absolute
        else:
            yield from (parts[1:] for parts in absolute if parts[:1] == [package])


@lru_cache(maxsize=256)
def _import_statements(content: bytes) -> tuple[ast.Import | ast.ImportFrom, ...]:
    """Import statements of a text wherever they stand; none of one that is no Python."""
    try:
        waiting: list[ast.AST] = [ast.parse(content)]
        found = []
        while waiting:
            node = waiting.pop()
            if isinstance(node, ast.Import | ast.ImportFrom):
                found.append(node)
            # Statements stand in statements only: expressions, most of a text, need not be looked at.
            waiting += [child for name in _BLOCKS for child in getattr(node, name, ())]
        return tuple(found)
    except _UNREADABLE:
        return ()


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
