"""Where a line of code can be changed so that it computes something else, and how."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

SWAPPED_OPERATORS: dict[type[ast.operator], str] = {
    ast.Add: "-",
    ast.Sub: "+",
    ast.Mult: "/",
    ast.Div: "*",
    ast.Pow: "*",
    ast.FloorDiv: "/",
    ast.MatMult: "*",
    ast.BitAnd: "|",
    ast.BitOr: "&",
}
SWAPPED_COMPARISONS: dict[type[ast.cmpop], str] = {
    ast.Lt: "<=",
    ast.LtE: "<",
    ast.Gt: ">=",
    ast.GtE: ">",
    ast.Eq: "!=",
    ast.NotEq: "==",
    ast.In: "not in",
    ast.NotIn: "in",
    ast.Is: "is not",
    ast.IsNot: "is",
}
REVERSED_COMPARISONS: dict[type[ast.cmpop], str] = {ast.Lt: ">", ast.LtE: ">", ast.Gt: "<", ast.GtE: "<"}
# Calls whose counterpart computes something else from the same arguments.
SWAPPED_NAMES = {
    "min": "max",
    "max": "min",
    "argmin": "argmax",
    "argmax": "argmin",
    "minimum": "maximum",
    "maximum": "minimum",
    "any": "all",
    "all": "any",
    "ceil": "floor",
    "floor": "ceil",
    "zeros": "ones",
    "sin": "cos",
    "cos": "sin",
    "real": "imag",
    "imag": "real",
}


@dataclass(frozen=True)
class Mutant:
    """One line of one file, changed. `line` counts from 1; `old` and `new` are that whole line."""

    file: str
    line: int
    kind: str
    old: str
    new: str

    @property
    def key(self) -> str:
        """What it is known by in the file of results, wherever the line has moved to."""
        return f"{self.file}|{self.kind}|{self.old.strip()}|{self.new.strip()}"


def mutants_of(root: Path, file: str) -> list[Mutant]:
    """All mutants of a file, in its order; each is one line that still parses.

    Parameters
    ----------
    root : Path
        The folder that `file` is relative to.
    file : str
    """
    text = (root / file).read_text()
    lines = text.splitlines()
    found: dict[str, Mutant] = {}
    for node, kind, start, end, replacement in _edits(ast.parse(text), lines):
        row = node - 1
        line = lines[row]
        changed = line.encode()[:start].decode() + replacement + line.encode()[end:].decode()
        if changed == line or not _parses([*lines[:row], changed, *lines[row + 1 :]]):
            continue
        mutant = Mutant(file, node, kind, line, changed)
        found.setdefault(mutant.key, mutant)
    return list(found.values())


def _parses(lines: list[str]) -> bool:
    try:
        ast.parse("\n".join(lines))
    except SyntaxError:
        return False
    return True


Edit = tuple[int, str, int, int, str]


def _edits(tree: ast.Module, lines: list[str]) -> Iterator[Edit]:
    """Line, kind, first and last byte of the line, and what to put there instead."""
    for node in _computing(tree):
        if isinstance(node, ast.BinOp):
            yield from _operator(node, lines)
        elif isinstance(node, ast.Compare):
            yield from _comparison(node, lines)
        elif isinstance(node, ast.BoolOp):
            yield from _between(node.values[0], node.values[1], _word(node.op), lines, "logic")
        elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub | ast.Not):
            if _one_line(node):
                yield node.lineno, "sign", node.col_offset, node.operand.col_offset, ""
        elif isinstance(node, ast.Constant):
            yield from _constant(node)
        elif isinstance(node, ast.Attribute | ast.Name):
            yield from _name(node)


def _computing(tree: ast.AST) -> Iterator[ast.AST]:
    """Nodes that compute: no annotations, no docstrings, nothing that only words a message."""
    for field, value in ast.iter_fields(tree):
        if field in ("annotation", "returns", "decorator_list", "type_params"):
            continue
        for child in value if isinstance(value, list) else [value]:
            if not isinstance(child, ast.AST) or _only_words(child):
                continue
            yield child
            yield from _computing(child)


def _only_words(node: ast.AST) -> bool:
    if isinstance(node, ast.Raise | ast.Assert | ast.JoinedStr | ast.Import | ast.ImportFrom):
        return True
    if isinstance(node, ast.If) and isinstance(node.test, ast.Name) and node.test.id == "TYPE_CHECKING":
        return True
    return isinstance(node, ast.Constant) and isinstance(node.value, str)


def _one_line(node: ast.expr) -> bool:
    return node.lineno == node.end_lineno


def _operator(node: ast.BinOp, lines: list[str]) -> Iterator[Edit]:
    swapped = SWAPPED_OPERATORS.get(type(node.op))
    if swapped is None or _is_text(node.left) or _is_text(node.right):
        return
    yield from _between(node.left, node.right, swapped, lines, "operator")
    if isinstance(node.op, ast.Add | ast.Sub) and _one_line(node) and node.end_col_offset is not None:
        assert node.left.end_col_offset is not None
        yield node.lineno, "dropped term", node.left.end_col_offset, node.end_col_offset, ""


def _is_text(node: ast.expr) -> bool:
    return isinstance(node, ast.JoinedStr) or (isinstance(node, ast.Constant) and isinstance(node.value, str))


def _comparison(node: ast.Compare, lines: list[str]) -> Iterator[Edit]:
    sides = [node.left, *node.comparators]
    for left, op, right in zip(sides, node.ops, sides[1:], strict=False):
        swapped, reversed_ = SWAPPED_COMPARISONS.get(type(op)), REVERSED_COMPARISONS.get(type(op))
        # Of numbers with a fraction, < and <= are one but for a coincidence.
        if swapped and (reversed_ is None or _counts(left) or _counts(right)):
            yield from _between(left, right, swapped, lines, "comparison")
        if reversed_:
            yield from _between(left, right, reversed_, lines, "reversed")


def _counts(node: ast.expr) -> bool:
    """Whether an expression is a whole number at sight."""
    if isinstance(node, ast.Call):
        return isinstance(node.func, ast.Name) and node.func.id == "len"
    return isinstance(node, ast.Constant) and type(node.value) is int


def _word(op: ast.boolop) -> str:
    return "or" if isinstance(op, ast.And) else "and"


def _between(left: ast.expr, right: ast.expr, new: str, lines: list[str], kind: str) -> Iterator[Edit]:
    """What stands between two operands of one line, replaced, with their parentheses kept."""
    if left.end_lineno != right.lineno or left.end_col_offset is None:
        return
    start, end = left.end_col_offset, right.col_offset
    middle = lines[right.lineno - 1].encode()[start:end].decode()
    closing = middle[: len(middle) - len(middle.lstrip(") "))].count(")")
    opening = middle[len(middle.rstrip("( ")) :].count("(")
    yield right.lineno, kind, start, end, f"{')' * closing} {new} {'(' * opening}"


def _constant(node: ast.Constant) -> Iterator[Edit]:
    assert node.end_col_offset is not None
    place = node.lineno, "constant", node.col_offset, node.end_col_offset
    if isinstance(node.value, bool):
        yield (*place, str(not node.value))
    elif isinstance(node.value, int):
        yield (*place, str(node.value + 1))
    elif isinstance(node.value, float):
        # Tolerances are meant to be generous: only what is a hundred times off computes something else.
        yield (*place, repr(node.value * 100.0 if 0.0 < abs(node.value) < 1e-3 else node.value + 0.5))


def _name(node: ast.Attribute | ast.Name) -> Iterator[Edit]:
    name = node.attr if isinstance(node, ast.Attribute) else node.id
    if name not in SWAPPED_NAMES or not _one_line(node) or node.end_col_offset is None:
        return
    start = node.end_col_offset - len(name)
    yield node.lineno, "function", start, node.end_col_offset, SWAPPED_NAMES[name]
