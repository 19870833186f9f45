"""The word table of docs/theory.md against the code: its names exist, and words that it replaced are gone."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PACKAGE = ROOT / "contwalk"

# What the words of the table have replaced, in the packages that have been gone through.
REPLACED = {
    "flow": {"arc", "arcs", "course", "departure", "departures", "lap", "leg", "legs", "piece", "pieces"}
    | {"plan", "quiet", "told", "walk", "word", "here", "careful"},
    "fields": {"arc", "lap", "leg", "quiet", "plan", "told"},
    "storage": {"arc", "lap", "leg", "quiet", "plan", "told", "here"},
    "numerics": {"arc", "lap", "leg", "quiet", "plan", "told", "here"},
    "continuation": {"here", "told", "leg", "lap", "piece", "pieces", "quiet"},
    "diagram": {"here", "told", "leg", "lap", "piece", "pieces", "quiet"},
    "studies": {"here", "told", "piece", "pieces", "quiet", "lap", "laps", "word"},
    "problems": {"lap", "laps", "word"},
    "workflow": {"here", "told", "leg", "legs", "lap", "piece", "pieces", "quiet", "plan", "arc"},
    "plotting": {"here", "told", "leg", "legs", "lap", "piece", "pieces", "quiet", "plan", "arc"},
    # `quiet` is an option of the command line.
    "cli": {"here", "told", "leg", "legs", "lap", "piece", "pieces", "plan", "arc"},
}


def names_of(table: str) -> list[str]:
    """The names in the last column of a table's rows."""
    rows = [line.strip().strip("|").split("|")[-1] for line in table.splitlines() if line.startswith("| ")]
    return re.findall(r"`([A-Za-z_.]+)`", " ".join(rows[1:]))


def word_table() -> str:
    text = (ROOT / "docs" / "theory.md").read_text(encoding="utf-8")
    return text.split("\n## Words\n")[1].split("\n## ")[0]


def bound(tree: ast.AST) -> Iterator[str]:
    """The names that a module gives to something."""
    for node in ast.walk(tree):
        if isinstance(node, ast.FunctionDef | ast.ClassDef):
            yield node.name
        elif isinstance(node, ast.arg):
            yield node.arg
        elif isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            yield node.id
        elif isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Store):
            yield node.attr


def all_names(folder: Path) -> dict[Path, set[str]]:
    return {
        path: set(bound(ast.parse(path.read_text(encoding="utf-8")))) | {path.stem}
        for path in sorted(folder.rglob("*.py"))
    }


def test_each_name_of_the_word_table_is_one_of_the_code():
    known = set().union(*all_names(PACKAGE).values())
    names = names_of(word_table())
    assert len(names) >= 15
    assert [name for name in names if not set(name.split(".")) <= known] == []


@pytest.mark.parametrize("package", REPLACED)
def test_words_that_the_table_replaced_are_in_no_name(package):
    """Parts of names too: `_first_arc`, `ArcControl`."""
    found = [
        f"{path.relative_to(ROOT)}: {name}"
        for path, names in all_names(PACKAGE / package).items()
        for name in sorted(names)
        if {part.lower() for part in re.findall(r"[A-Z]?[a-z]+", name)} & REPLACED[package]
    ]
    assert found == []
