"""Three numbers that may only fall: constants, code of the core, and Python calls a regular step.

Who lowers one writes the new number here; none is ever raised.
"""

from __future__ import annotations

import ast
import io
import statistics
import sys
import tokenize
from collections.abc import Iterator
from pathlib import Path

import pytest

import contwalk
import contwalk as cw
from contwalk.branch import BranchInfo
from contwalk.workflow.runner import Reporter

ROOT = Path(contwalk.__file__).parent
# What computes; storage, studies and what users see may grow by what they give.
CORE = ("continuation", "diagram", "problems", "flow", "fields", "numerics")

# Names bound to numbers in modules; lines of the core but comments, docstrings, blanks and imports.
CONSTANTS, CORE_LINES = 1198, 36961
# Python calls of a regular step, as the median over the steps of the first branch of its kind.
CALLS = {"autobalancer_load": 1010, "pitchfork": 720, "fitzhugh_nagumo": 2840, "planar_slope": 7420}
# Another NumPy calls itself otherwise, and another processor iterates otherwise by one in some steps.
SAME = 1.02

PITCHFORK = """
from contwalk.system import Mode, Parameter, State, System

def field(t, x, p, dx):
    dx[0] = p.r * x[0] - x[0] ** 3
    dx[1] = p.a - x[1]

SYSTEM = System(
    "fork",
    states=(State("x"), State("y")),
    parameters=(Parameter("r", -0.5), Parameter("a", 0.25)),
    modes=(Mode("free", field),),
)
"""
FITZHUGH_NAGUMO = """
from contwalk.system import Mode, Parameter, State, System

def field(t, x, p, dx):
    dx[0] = x[0] - x[0] ** 3 / 3.0 - x[1] + p.i
    dx[1] = 0.08 * (x[0] + 0.7 - 0.8 * x[1])

SYSTEM = System(
    "fhn",
    states=(State("v"), State("w")),
    parameters=(Parameter("i", 0.5),),
    modes=(Mode("only", field),),
)
"""
STUDIES = {
    "pitchfork": (
        PITCHFORK,
        "{start: {state: {x: 0.0, y: 0.25}}, continue: {parameter: r, range: [-1, -0.1]}}",
    ),
    "fitzhugh_nagumo": (
        FITZHUGH_NAGUMO,
        "{start: {simulate: {state: {v: 1.0, w: 0.0}, until: settled}}, "
        "continue: {parameter: i, range: [0.5, 1.2], max_points: 40}}",
    ),
}
SHORTER = {
    "autobalancer_load": ["diagram.follow=none"],
    "planar_slope": ["diagram.follow=none", "continue.max_points=12"],
}


def statements(tree: ast.Module) -> Iterator[ast.expr]:
    """What module-level names are bound to, tuples unpacked."""
    for node in tree.body:
        if not isinstance(node, ast.Assign | ast.AnnAssign) or node.value is None:
            continue
        for target in node.targets if isinstance(node, ast.Assign) else [node.target]:
            pair = isinstance(target, ast.Tuple) and isinstance(node.value, ast.Tuple)
            yield from node.value.elts if pair else [node.value]


def constants(tree: ast.Module) -> int:
    """How many module-level names are bound to a number, or to an expression with one."""
    kept = (ast.Dict, ast.List, ast.Call, ast.Set, ast.Tuple)
    return sum(
        any(isinstance(part, ast.Constant) and type(part.value) in (int, float) for part in ast.walk(value))
        for value in statements(tree)
        if not isinstance(value, kept)
    )


def lines_of_code(text: str, tree: ast.Module) -> int:
    """How many lines are neither comment, docstring, blank nor import."""
    nothing = (
        tokenize.COMMENT,
        tokenize.NL,
        tokenize.NEWLINE,
        tokenize.INDENT,
        tokenize.DEDENT,
        tokenize.ENDMARKER,
    )
    tokens = tokenize.generate_tokens(io.StringIO(text).readline)
    code = {line for t in tokens if t.type not in nothing for line in range(t.start[0], t.end[0] + 1)}
    for node in ast.walk(tree):
        if isinstance(node, ast.Import | ast.ImportFrom):
            code -= set(range(node.lineno, (node.end_lineno or 0) + 1))
        told = isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef)
        if told and ast.get_docstring(node, clean=False) is not None:  # type: ignore[arg-type]
            code -= set(range(node.body[0].lineno, (node.body[0].end_lineno or 0) + 1))  # type: ignore[attr-defined]
    return len(code)


def test_constants_and_code_of_the_core_only_fall():
    found = core = 0
    for path in ROOT.rglob("*.py"):
        text = path.read_text(encoding="utf-8")
        tree = ast.parse(text)
        found += constants(tree)
        core += lines_of_code(text, tree) if path.relative_to(ROOT).parts[0] in CORE else 0
    assert found <= CONSTANTS
    assert core <= CORE_LINES


class _Calls(Reporter):
    """Counts Python calls between the points of each kind of branch."""

    def __init__(self) -> None:
        self.calls, self.last = 0, 0
        self.between: dict[str, list[int]] = {}

    def __call__(self, frame: object, event: str, argument: object) -> None:
        self.calls += event == "call"

    def point(self, info: BranchInfo, parameter: float, step: float, unstable: int, number: int) -> None:
        self.between.setdefault(info.problem, []).append(self.calls - self.last)
        self.last = self.calls


def median_of_calls(run_file: cw.RunFile) -> int:
    """Python calls of a regular step of the first kind of branches, as the median over all its steps."""
    counted = _Calls()
    cw.run(run_file, figures=False)  # whatever is made once is made
    sys.setprofile(counted)
    try:
        cw.run(run_file, figures=False, force=True, reporter=counted)
    finally:
        sys.setprofile(None)
    return int(statistics.median(next(iter(counted.between.values()))))


@pytest.mark.parametrize("study", CALLS)
def test_python_calls_of_a_step_only_fall(study, tmp_path):
    path, overrides = ROOT.parent / "runs" / f"{study}.yaml", SHORTER.get(study, [])
    if study in STUDIES:
        plugin, text = STUDIES[study]
        (tmp_path / "plugin.py").write_text(plugin, encoding="utf-8")
        path = tmp_path / "study.yaml"
        path.write_text("{system: ./plugin.py, " + text[1:], encoding="utf-8")
    run_file = cw.read_run_file(path, overrides, output=str(tmp_path / "run.h5"))
    calls = median_of_calls(run_file)
    assert calls <= SAME * CALLS[study], f"{calls} calls, at most {CALLS[study]} before"
