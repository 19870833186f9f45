"""Public functions, methods and classes have docstrings, and those of arrays tell their shapes."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PACKAGES = ("flow", "fields", "numerics")
# `shape (n,)`, `(s + 1, n)`, `length n`; or another function's docstring, by its name.
SHAPES = re.compile(r"\bshapes?\b|\blength\b|\([a-z0-9+ *.]+,[^()]*\)|\b[Aa]s (?:for )?`|[Aa]rguments as ")


def public(tree: ast.Module | ast.ClassDef) -> Iterator[ast.FunctionDef | ast.ClassDef]:
    """Definitions whose names have no underscore, methods of public classes included."""
    for node in tree.body:
        if isinstance(node, ast.FunctionDef | ast.ClassDef) and not node.name.startswith("_"):
            yield node
            if isinstance(node, ast.ClassDef):
                yield from public(node)


def arrays_of(node: ast.FunctionDef) -> bool:
    """Whether an array is taken or returned, by the annotations."""
    arguments = [*node.args.posonlyargs, *node.args.args, *node.args.kwonlyargs]
    given = [*(argument.annotation for argument in arguments), node.returns]
    return any(re.search(r"\bndarray\b|\bVector\b", ast.unparse(each)) for each in given if each)


def for_numba(node: ast.FunctionDef) -> bool:
    """Parts of compiled entries take flat arrays; what these are stands with their records."""
    return any(ast.unparse(each) == "inlined" for each in node.decorator_list)


def faults(package: str) -> Iterator[str]:
    for path in sorted((ROOT / "contwalk" / package).rglob("*.py")):
        for node in public(ast.parse(path.read_text(encoding="utf-8"))):
            text = ast.get_docstring(node) or ""
            where = f"{path.relative_to(ROOT)}:{node.lineno}: {node.name}"
            if not text:
                yield f"{where} has no docstring"
            elif isinstance(node, ast.ClassDef) or for_numba(node) or not arrays_of(node):
                continue
            elif not SHAPES.search(text):
                yield f"{where} takes or returns an array and tells no shape"


@pytest.mark.parametrize("package", PACKAGES)
def test_docstrings_tell_the_shapes_of_arrays(package):
    assert list(faults(package)) == []


def test_what_tells_no_shape_is_found():
    """The check itself."""
    said = [
        "f, shape (m,).",
        "The states at times, (s + 1, n).",
        "As `integrate.along`.",
        "Tangents of length n.",
    ]
    assert all(SHAPES.search(text) for text in said)
    assert not SHAPES.search("The rates of the states (all of them) at the instant.")
