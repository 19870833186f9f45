"""The shape of the code: no circles, small classes and files, calls that can be read.

What is over a bound stands in a list with its size. The lists may only shrink: who makes one of these smaller
lowers its number, and takes it off where it is within the bound; a number is never raised.
"""

from __future__ import annotations

import ast
import io
import keyword
import tokenize
from collections import defaultdict
from collections.abc import Iterator
from functools import cache
from itertools import combinations, pairwise
from pathlib import Path
from typing import NamedTuple

import pytest

import contwalk
from contwalk.problems.problem import Problem
from tools.house.imports import PACKAGE, House, circles

ROOT = Path(contwalk.__file__).parent
FILES = sorted(ROOT.rglob("*.py"))

MOST_METHODS, MOST_LINES, MOST_ARGUMENTS, MOST_MEMBERS = 30, 400, 8, 15
# So many lines of functions in a row stand nowhere else, with other names neither.
SHARED = 10

Function = ast.FunctionDef | ast.AsyncFunctionDef

# A module, and which of its lines.
Place = tuple[str, int]

# Methods, and lines, of classes.
METHODS_OVER: dict[str, int] = {}
LINES_OVER: dict[str, int] = {}
# Lines of files.
FILES_OVER: dict[str, int] = {}
# Arguments of functions that may be given by position; what is given by name alone explains itself.
ARGUMENTS_OVER: dict[str, int] = {}


def module_name(path: Path) -> str:
    """`contwalk.problems.problem`."""
    parts = path.relative_to(ROOT.parent).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


class Sizes(NamedTuple):
    """By their names: methods and lines of classes, arguments of functions that may be given by position."""

    methods: dict[str, int]
    lines: dict[str, int]
    arguments: dict[str, int]


@cache
def sizes() -> Sizes:
    """Of all modules, one tree after another: the collector of cycles looks through all that are kept."""
    found = Sizes({}, {}, {})
    for path in FILES:
        module, tree = module_name(path), ast.parse(path.read_text(encoding="utf-8"))
        for node in ast.walk(tree):
            if isinstance(node, ast.ClassDef):
                name, methods = (
                    f"{module}.{node.name}",
                    sum(isinstance(n, ast.FunctionDef) for n in node.body),
                )
                larger(found.methods, name, methods)
                larger(found.lines, name, (node.end_lineno or 0) - node.lineno + 1)
        for name, function in functions(tree.body, module):
            larger(found.arguments, name, positional(function))
    return found


def larger(known: dict[str, int], name: str, size: int) -> None:
    """Of several that bear one name, the largest counts."""
    known[name] = max(size, known.get(name, 0))


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


def over(sizes: dict[str, int], bound: int) -> dict[str, int]:
    return {name: size for name, size in sizes.items() if size > bound}


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
    only_shrinks(over(sizes().methods, MOST_METHODS), METHODS_OVER)


def test_classes_are_short():
    only_shrinks(over(sizes().lines, MOST_LINES), LINES_OVER)


def test_files_are_short():
    lines = {module_name(path): len(path.read_text(encoding="utf-8").splitlines()) for path in FILES}
    only_shrinks(over(lines, MOST_LINES), FILES_OVER)


def test_functions_have_few_arguments():
    only_shrinks(over(sizes().arguments, MOST_ARGUMENTS), ARGUMENTS_OVER)


def written_out(node: ast.AST) -> bool:
    """Whether it is a docstring, or an import."""
    text = (
        isinstance(node, ast.Expr)
        and isinstance(node.value, ast.Constant)
        and isinstance(node.value.value, str)
    )
    return text or isinstance(node, ast.Import | ast.ImportFrom)


def lines_of_functions(source: str) -> Iterator[tuple[int, list[tuple[bool, str]]]]:
    """Lines of functions with their signatures: number, what stands in it, and whether that is a name.

    Docstrings, imports, comments and lines of signs alone are left out; strings and numbers are all alike.
    """
    inside, outside = set[int](), set[int]()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, Function):
            inside |= {*range(node.lineno, (node.end_lineno or 0) + 1)}
        elif isinstance(node, ast.stmt) and written_out(node):
            outside |= {*range(node.lineno, (node.end_lineno or 0) + 1)}
    words: dict[int, list[tuple[bool, str]]] = defaultdict(list)
    for token in tokenize.generate_tokens(io.StringIO(source).readline):
        if token.type in (tokenize.NAME, tokenize.OP, tokenize.NUMBER, tokenize.STRING):
            named = token.type == tokenize.NAME and not keyword.iskeyword(token.string)
            kept = token.type in (tokenize.NAME, tokenize.OP)
            words[token.start[0]].append((named, token.string if kept else "0"))
    for line in sorted(inside - outside):
        if any(word.isalnum() or named for named, word in words[line]):
            yield line, words[line]


def shape(lines: list[list[tuple[bool, str]]]) -> tuple[object, ...]:
    """Some lines with names told by the order in which they come."""
    numbers: dict[str, int] = {}
    return tuple(
        tuple(numbers.setdefault(word, len(numbers)) if named else word for named, word in line)
        for line in lines
    )


def alike(places: Iterator[tuple[object, Place]]) -> list[list[Place]]:
    """Places that are told to be alike, where there are several."""
    found: dict[object, list[Place]] = defaultdict(list)
    for key, place in places:
        found[key].append(place)
    return [group for group in found.values() if len(group) > 1]


def shared(sources: dict[str, str]) -> list[str]:
    """Pairs of places that share so many lines, names apart."""
    lines = {name: list(lines_of_functions(source)) for name, source in sources.items()}

    def shape_at(place: Place) -> tuple[object, ...]:
        name, k = place
        return shape([words for _, words in lines[name][k : k + SHARED]])

    def signs() -> Iterator[tuple[object, Place]]:
        for name, own in lines.items():
            each = [hash(tuple("" if named else word for named, word in words)) for _, words in own]
            yield from ((tuple(each[k : k + SHARED]), (name, k)) for k in range(len(own) - SHARED + 1))

    return [
        f"{a}:{lines[a][i][0]} ~ {b}:{lines[b][j][0]}"
        for group in alike(signs())
        for found in alike((shape_at(place), place) for place in group)
        for (a, i), (b, j) in combinations(found, 2)
        if a != b or j - i >= SHARED
    ]


def test_no_two_places_share_ten_lines():
    assert shared({module_name(path): path.read_text(encoding="utf-8") for path in FILES}) == []


PAIRS = ("xy", "ux", "vy", "uv", "xu", "yx", "vx", "uy", "xv")


def test_lines_that_are_shared_with_other_names_are_seen():
    body = "".join(f"    {a} = {b}({a}, {k})\n" for k, (a, b) in enumerate(PAIRS))
    first = f'def f(x, y, u, v):\n    """One."""\n{body}'
    second = "".join(
        {"x": "p", "y": "q", "u": "r", "v": "s"}.get(c, c) for c in f"def g(x, y, u, v):\n{body}"
    )
    assert shared({"one": first, "two": second}) == ["one:1 ~ two:1"]
    assert shared({"one": first, "two": second.replace("p = r", "p = q", 1)}) == []


@pytest.mark.parametrize(("found", "listed"), [({"a": 31}, {}), ({"a": 32}, {"a": 31}), ({}, {"a": 31})])
def test_lists_of_what_is_over_only_shrink(found, listed):
    with pytest.raises(AssertionError):
        only_shrinks(found, listed)


def test_methods_and_inner_functions_are_counted_without_self():
    source = "class A:\n    def f(self, a, b, *, c): ...\n\ndef g(x):\n    def h(a, b, c): ...\n"
    found = {name: positional(f) for name, f in functions(ast.parse(source).body, "m")}
    assert found == {"m.A.f": 2, "m.g": 1, "m.h": 3}


def test_files_of_tests_have_names_of_their_own():
    """pytest imports them by their names alone: of two alike in different folders it runs only one."""
    names = sorted(path.name for path in Path(__file__).parent.rglob("test_*.py"))
    assert [name for name, after in pairwise(names) if name == after] == []
