"""The engine knows special points by their kinds: what is written in it names no label."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

import contwalk.continuation
import contwalk.studies
from contwalk.labels import MEANINGS

PACKAGES = (contwalk.continuation, contwalk.studies)
FILES = [path for package in PACKAGES for path in sorted(Path(package.__file__).parent.glob("*.py"))]
# Those that are stored, and what equations of two kinds of points were once called.
LABELS = re.compile(rf"\b({'|'.join([*MEANINGS, 'SB', 'FLAT', 'MULTIPLE'])})\b")


def strings(tree: ast.Module) -> Iterator[ast.Constant]:
    """The strings of a module but for its docstrings."""
    told = {
        id(node.body[0].value)
        for node in ast.walk(tree)
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef)
        and node.body
        and isinstance(node.body[0], ast.Expr)
    }
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in told:
            yield node


@pytest.mark.parametrize("path", FILES, ids=lambda path: f"{path.parent.name}/{path.name}")
def test_no_label_is_written_in_the_engine(path):
    found = strings(ast.parse(path.read_text(encoding="utf-8")))
    named = [(node.lineno, node.value) for node in found if LABELS.search(node.value)]
    assert named == []


def test_the_search_finds_a_label():
    tree = ast.parse('"""LP."""\nif label == "LP":\n    raise Error(f"no point {label} (BP) there")\n')
    assert [node.value for node in strings(tree) if LABELS.search(node.value)] == ["LP", " (BP) there"]
