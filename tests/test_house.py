"""The shape of the code: no circles, small classes and files, calls that can be read.

What is over a bound stands in a list with its size. The lists may only shrink: who makes one of these smaller
lowers its number, and takes it off where it is within the bound; a number is never raised.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

import contwalk
from contwalk.problems.problem import Problem
from tools.house.imports import PACKAGE, House, circles

ROOT = Path(contwalk.__file__).parent
FILES = sorted(ROOT.rglob("*.py"))

MOST_METHODS, MOST_LINES, MOST_ARGUMENTS, MOST_MEMBERS = 30, 400, 8, 15

Function = ast.FunctionDef | ast.AsyncFunctionDef

# Methods, and lines, of classes.
METHODS_OVER: dict[str, int] = {}
LINES_OVER: dict[str, int] = {}
# Lines of files.
FILES_OVER: dict[str, int] = {
    "contwalk.flow.explicit.runge_kutta": 441,
}
# Arguments of functions that may be given by position; what is given by name alone explains itself.
ARGUMENTS_OVER: dict[str, int] = {}


def module_name(path: Path) -> str:
    """`contwalk.problems.problem`."""
    parts = path.relative_to(ROOT.parent).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


TREES = {module_name(path): ast.parse(path.read_text(encoding="utf-8")) for path in FILES}


def classes() -> Iterator[tuple[str, ast.ClassDef]]:
    for name, tree in TREES.items():
        yield from ((f"{name}.{c.name}", c) for c in ast.walk(tree) if isinstance(c, ast.ClassDef))


def positional(function: Function) -> int:
    """How many arguments may be given by position."""
    arguments = [*function.args.posonlyargs, *function.args.args]
    return len([a for a in arguments if a.arg not in ("self", "cls")])


def functions(
    body: list[ast.stmt], owner: str
) -> Iterator[tuple[str, ast.FunctionDef | ast.AsyncFunctionDef]]:
    """All functions below some statements, by the names of what they stand in."""
    for node in body:
        for child in ast.walk(node) if not isinstance(node, ast.ClassDef) else [node]:
            if isinstance(child, Function):
                yield f"{owner}.{child.name}", child
            elif isinstance(child, ast.ClassDef):
                yield from functions(child.body, f"{owner}.{child.name}")


def over(sizes: Iterator[tuple[str, int]], bound: int) -> dict[str, int]:
    return {name: size for name, size in sizes if size > bound}


def only_shrinks(found: dict[str, int], listed: dict[str, int]) -> None:
    grown = {name: size for name, size in found.items() if size > listed.get(name, 0)}
    assert grown == {}, "over the bound, or more than is listed: split by idea"
    within = [name for name in listed if name not in found]
    assert within == [], "within the bound now: take them off the list"


def test_no_files_import_each_other_in_a_circle():
    house = House.read()
    # The package itself names the public interface, each name imported when it is first used.
    imports = {name: found - {PACKAGE} for name, found in house.imports.items() if name != PACKAGE}
    assert {tuple(sorted(group)) for group in circles(imports).values() if len(group) > 1} == set()


def test_a_circle_over_an_annotation_and_a_lazy_import_is_seen(tmp_path):
    folder = tmp_path / PACKAGE
    folder.mkdir()
    (tmp_path / "pyproject.toml").write_text(
        '[[tool.importlinter.contracts]]\nname = "Layers import downwards only"\nlayers = ["contwalk.a"]\n',
        encoding="utf-8",
    )
    texts = {
        "__init__": '"""All."""\n',
        "a": '"""A."""\nfrom typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    from contwalk.b import B\n',
        "b": '"""B."""\nfrom contwalk import c\n',
        "c": '"""C."""\ndef f():\n    import contwalk.a\n',
    }
    for name, text in texts.items():
        (folder / f"{name}.py").write_text(text, encoding="utf-8")
    house = House.read(tmp_path)
    assert circles(house.imports)["contwalk.a"] == {"contwalk.a", "contwalk.b", "contwalk.c"}


def test_a_problem_has_about_a_dozen_members():
    members = {name for name in (*vars(Problem), *Problem.__annotations__) if not name.startswith("_")}
    assert len(members) <= MOST_MEMBERS, sorted(members)


def test_classes_have_few_methods():
    sizes = ((name, sum(isinstance(b, ast.FunctionDef) for b in c.body)) for name, c in classes())
    only_shrinks(over(sizes, MOST_METHODS), METHODS_OVER)


def test_classes_are_short():
    sizes = ((name, (c.end_lineno or 0) - c.lineno + 1) for name, c in classes())
    only_shrinks(over(sizes, MOST_LINES), LINES_OVER)


def test_files_are_short():
    sizes = ((module_name(path), len(path.read_text(encoding="utf-8").splitlines())) for path in FILES)
    only_shrinks(over(sizes, MOST_LINES), FILES_OVER)


def test_functions_have_few_arguments():
    found = ((name, f) for module, tree in TREES.items() for name, f in functions(tree.body, module))
    only_shrinks(over(((name, positional(f)) for name, f in found), MOST_ARGUMENTS), ARGUMENTS_OVER)


@pytest.mark.parametrize(("found", "listed"), [({"a": 31}, {}), ({"a": 32}, {"a": 31}), ({}, {"a": 31})])
def test_lists_of_what_is_over_only_shrink(found, listed):
    with pytest.raises(AssertionError):
        only_shrinks(found, listed)


def test_methods_and_inner_functions_are_counted_without_self():
    source = "class A:\n    def f(self, a, b, *, c): ...\n\ndef g(x):\n    def h(a, b, c): ...\n"
    found = {name: positional(f) for name, f in functions(ast.parse(source).body, "m")}
    assert found == {"m.A.f": 2, "m.g": 1, "m.h": 3}
