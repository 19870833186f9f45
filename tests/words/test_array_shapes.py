"""Public functions, methods and classes have docstrings, and those of arrays tell their shapes."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
CODE = ROOT / "contwalk"
# How many definitions of a package have no docstring, or one that tells no shape of an array. The numbers may
# only fall; a package that is not here has none.
LEFT = {
    "continuation": 2,
    "contwalk": 5,
    "fields": 1,
    "flow": 8,
    "numerics": 4,
    "plotting": 4,
    "plugin_check": 10,
    "problems": 75,
    "system": 5,
    "workflow": 4,
}
PARTS_OF_PROBLEMS = tuple(("problems", name) for name in ("equilibrium", "initial", "locus"))
LENGTH = r"(?:(?:\d+ ?)?[A-Za-z]\w?|\d+|\.\.)"
TERMS = rf"{LENGTH}(?: ?[-+*] ?{LENGTH})*"
# `shape (n,)`, `(s + 1, n)`, `length n`; or another function's docstring, by its name.
SHAPES = re.compile(
    rf"\b[Ss]hapes?\b|\blength\b|\({TERMS},(?: {TERMS}(?:, {TERMS})*)?\)|\b[Aa]s (?:for )?`|[Aa]rguments as "
)


def public(tree: ast.Module | ast.ClassDef) -> Iterator[ast.FunctionDef | ast.ClassDef]:
    """Definitions without an underscore, methods of public classes included; of several forms the last."""
    for node in tree.body:
        if isinstance(node, ast.FunctionDef | ast.ClassDef) and not node.name.startswith("_"):
            if any(ast.unparse(decorator) == "overload" for decorator in node.decorator_list):
                continue
            yield node
            if isinstance(node, ast.ClassDef):
                yield from public(node)


def annotations(node: ast.FunctionDef | ast.ClassDef) -> Iterator[ast.expr | None]:
    """Of arguments and of what is returned; of a class, those of its fields or of its `__init__`."""
    if isinstance(node, ast.FunctionDef):
        arguments = [*node.args.posonlyargs, *node.args.args, *node.args.kwonlyargs]
        yield from (argument.annotation for argument in arguments)
        yield node.returns
        return
    for part in node.body:
        if isinstance(part, ast.AnnAssign) and not ast.unparse(part.target).startswith("_"):
            yield part.annotation
        elif isinstance(part, ast.FunctionDef) and part.name == "__init__":
            yield from annotations(part)


def of_arrays(node: ast.FunctionDef | ast.ClassDef) -> bool:
    """Whether an array is taken, held or returned, by the annotations."""
    return any(re.search(r"\bndarray\b|\bVector\b", ast.unparse(each)) for each in annotations(node) if each)


def for_numba(node: ast.FunctionDef | ast.ClassDef) -> bool:
    """Parts of compiled entries take flat arrays; what these are stands with their records."""
    return any(ast.unparse(each) == "inlined" for each in node.decorator_list)


def fault(node: ast.FunctionDef | ast.ClassDef) -> str:
    """What is missing; empty where nothing is."""
    text = ast.get_docstring(node) or ""
    if not text:
        return "has no docstring"
    if for_numba(node) or not of_arrays(node) or SHAPES.search(text):
        return ""
    return "takes, holds or returns an array and tells no shape"


def package_of(path: Path) -> str:
    """The package of a file; files beside the packages go together, and so do those of all orbits."""
    folders = path.relative_to(CODE).parts[:-1]
    own = folders[:2] in PARTS_OF_PROBLEMS
    return "/".join(folders[: 2 if own else 1]) or "contwalk"


PACKAGES = sorted({package_of(path) for path in CODE.rglob("*.py")})


def faults(package: str) -> Iterator[str]:
    for path in sorted(CODE.rglob("*.py")):
        if package_of(path) != package:
            continue
        for node in public(ast.parse(path.read_text(encoding="utf-8"))):
            if missing := fault(node):
                yield f"{path.relative_to(ROOT)}:{node.lineno}: {node.name} {missing}"


@pytest.mark.parametrize("package", PACKAGES)
def test_docstrings_tell_the_shapes_of_arrays(package):
    found, left = list(faults(package)), LEFT.get(package, 0)
    assert len(found) <= left, "\n".join(
        [*found, f"{len(found)} definitions, {left} of them known: see LEFT"]
    )


def test_the_table_has_no_package_that_is_done():
    assert [package for package in LEFT if package not in PACKAGES or not any(faults(package))] == []


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
