"""Explicit methods as LLVM IR: the stages of one step, for a field that is known by its address.

All vectors have a length that is a multiple of four, and are handled four entries at a time. One vector holds
a state, or a state with its tangents: the same sums of stages serve both, and the state part comes out the
same, bitwise. The coefficients are constants of the code, and those that are zero leave no trace.

The memory of a method is a sequence of vectors: the state `Y`, the state at the end of the step `NEXT`, the
state of the stage evaluated last `STAGE`, then one vector for each stage. The caller gives the first stage.

    void step(t, h, m, work, evaluate, problem)
    double error(t, h, m, work, evaluate, problem, inverse_weights)      in units of sqrt(n) weights
    void extend(t, h, m, work, evaluate, problem)                        further stages for interpolation

`evaluate(problem, t, y, k)` is one of

    void plain(problem, t, y, k)        problem: rhs, c
    void tangent(problem, t, y, k)      problem: rhs_jac, c, product, blocks, sources, buffer, n, start

or, where Jacobians are evaluated between two passes over the same steps (see `batched_steps`), one of

    void recorded(problem, t, y, k)     problem: rhs, c, batches, places, n, rows, count
    void replayed(problem, t, y, k)     problem: product, blocks, sources, jacobians, entries, count
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

from contwalk.fields.elimination_code import literal
from contwalk.fields.lanes import LANES
from contwalk.fields.llvm import Code, code_of
from contwalk.flow.compiled.products import WIDTH
from contwalk.flow.tableaus.runge_kutta import DOP853, VERNER98, Combination, RungeKutta

TABLEAUS = {method.name: method for method in (DOP853, VERNER98)}

Y, NEXT, STAGE, FIRST = 0, 1, 2, 3

_VECTOR = f"<{WIDTH} x double>"


def vectors(method: RungeKutta) -> int:
    """How many vectors the memory of a method has."""
    return FIRST + method.stages + len(method.dense_nodes)


@cache
def code(name: str) -> Code:
    """The compiled functions of a method."""
    method = TABLEAUS[name]
    symbols = [
        "step",
        "error",
        "plain",
        "tangent",
        "recorded",
        "replayed",
        *(["extend"] if method.dense else []),
    ]
    return code_of(text(method), symbols)


def text(method: RungeKutta) -> str:
    """IR of the functions of a method."""
    return "\n".join([_step(method), _error(method), _extend(method), _EVALUATIONS, _BATCHES])


# -- sums of stages ------------------------------------------------------------------------------------------


def _splat(value: str) -> str:
    return f"splat (double {value})"


def _loop(body: Sequence[str], sums: Sequence[str] = ()) -> list[str]:
    """`body` for each block of a vector of length %m; of the sums, %s_next is %s in the next pass."""
    lines = ["entry:", "  br label %loop", "loop:", "  %i = phi i64 [ 0, %entry ], [ %i_next, %loop ]"]
    zero = _splat("0.0")
    lines += [f"  %{s} = phi {_VECTOR} [ {zero}, %entry ], [ %{s}_next, %loop ]" for s in sums]
    end = [f"  %i_next = add i64 %i, {WIDTH}", "  %more = icmp ult i64 %i_next, %m"]
    return [*lines, *body, *end, "  br i1 %more, label %loop, label %done", "done:"]


def _sum(name: str, terms: Combination) -> list[str]:
    """%name = the combination of the vectors %k0, %k1, .. at %i."""
    lines: list[str] = []
    total = ""
    for stage, coefficient in terms.items():
        lines += _load(f"{name}_{stage}", f"k{stage}")
        factor = _splat(literal(coefficient))
        lines.append(f"  %{name}_{stage}_term = fmul {_VECTOR} %{name}_{stage}, {factor}")
        if total:
            lines.append(f"  %{name}_{stage}_sum = fadd {_VECTOR} {total}, %{name}_{stage}_term")
        total = f"%{name}_{stage}_sum" if total else f"%{name}_{stage}_term"
    return [*lines, f"  %{name} = fadd {_VECTOR} {total}, {_splat(literal(-0.0))}"]


def _load(name: str, array: str) -> list[str]:
    address = f"  %{name}_at = getelementptr double, ptr %{array}, i64 %i"
    return [address, f"  %{name} = load {_VECTOR}, ptr %{name}_at, align 8"]


def _combination(name: str, terms: Combination) -> str:
    """IR of out = y + h (sum of stages)."""
    stages = "".join(f", ptr noalias readonly %k{stage}" for stage in terms)
    body = [
        *_sum("total", terms),
        *_load("old", "y"),
        f"  %change = fmul {_VECTOR} %total, %hs",
        f"  %new = fadd {_VECTOR} %old, %change",
        "  %out_at = getelementptr double, ptr %out, i64 %i",
        f"  store {_VECTOR} %new, ptr %out_at, align 8",
    ]
    lines = _loop(body)
    lines[1:1] = [
        f"  %h0 = insertelement {_VECTOR} poison, double %h, i64 0",
        f"  %hs = shufflevector {_VECTOR} %h0, {_VECTOR} poison, <{WIDTH} x i32> zeroinitializer",
    ]
    head = f"define internal void @{name}(double %h, i64 %m, ptr noalias readonly %y{stages}, "
    return "\n".join([head + "ptr noalias writeonly %out) alwaysinline {", *lines, "  ret void", "}"])


# -- functions of a method -----------------------------------------------------------------------------------

_ARGUMENTS = "double %t, double %h, i64 %m, ptr %work, ptr %evaluate, ptr %problem"


def _places(method: RungeKutta) -> list[str]:
    """Addresses of the vectors: %y, %next, %stage, %k0, .."""
    names = ["y", "next", "stage", *(f"k{i}" for i in range(vectors(method) - FIRST))]
    lines = []
    for position, name in enumerate(names):
        lines.append(f"  %{name}_offset = mul i64 %m, {position}")
        lines.append(f"  %{name} = getelementptr double, ptr %work, i64 %{name}_offset")
    return lines


def _call(name: str, terms: Combination, out: str) -> str:
    stages = "".join(f", ptr %k{stage}" for stage in terms)
    return f"  call void @{name}(double %h, i64 %m, ptr %y{stages}, ptr %{out})"


def _stage(i: int, node: float, row: Combination, name: str) -> list[str]:
    """Statements of one stage: its state, its time, the field there."""
    return [
        _call(name, row, "stage"),
        f"  %d{i} = fmul double %h, {literal(node)}",
        f"  %t{i} = fadd double %t, %d{i}",
        f"  call void %evaluate(ptr %problem, double %t{i}, ptr %stage, ptr %k{i})",
    ]


def _step(method: RungeKutta) -> str:
    combinations, lines = [], _places(method)
    for i in range(1, method.stages_of_step):
        combinations.append(_combination(f"stage{i}", method.rows[i]))
        lines += _stage(i, method.nodes[i], method.rows[i], f"stage{i}")
    combinations.append(_combination("advance", method.weights))
    lines.append(_call("advance", method.weights, "next"))
    head = f"define void @step({_ARGUMENTS}) nounwind {{"
    return "\n".join([*combinations, head, *lines, "  ret void", "}"])


def _error(method: RungeKutta) -> str:
    combinations, lines = [], _places(method)
    for i in range(method.stages_of_step, method.stages):
        combinations.append(_combination(f"stage{i}", method.rows[i]))
        lines += _stage(i, method.nodes[i], method.rows[i], f"stage{i}")
    squares = []
    for e, terms in enumerate(method.errors):
        combinations.append(_square(f"square{e}", terms))
        stages = "".join(f", ptr %k{stage}" for stage in terms)
        lines.append(f"  %e{e} = call double @square{e}(i64 %m, ptr %inverse_weights{stages})")
        squares.append(f"%e{e}")
    lines += _joined(squares)
    head = f"define double @error({_ARGUMENTS}, ptr %inverse_weights) nounwind {{"
    declarations = [
        "declare double @llvm.sqrt.f64(double)",
        "declare double @llvm.fabs.f64(double)",
        f"declare double @llvm.vector.reduce.fadd.v{WIDTH}f64(double, {_VECTOR})",
    ]
    return "\n".join([*combinations, head, *lines, "}", *declarations])


def _joined(squares: Sequence[str]) -> list[str]:
    """|h| times the estimate, from the squares of its parts."""
    lines = ["  %size = call double @llvm.fabs.f64(double %h)"]
    if len(squares) == 1:
        lines.append(f"  %root = call double @llvm.sqrt.f64(double {squares[0]})")
        return [*lines, "  %estimate = fmul double %size, %root", "  ret double %estimate"]
    fine, crude = squares
    return [
        *lines,
        f"  %share = fmul double {crude}, {literal(0.01)}",
        f"  %sum = fadd double {fine}, %share",
        "  %root = call double @llvm.sqrt.f64(double %sum)",
        f"  %quotient = fdiv double {fine}, %root",
        "  %estimate = fmul double %size, %quotient",
        "  %none = fcmp oeq double %sum, 0.0",  # not where it is NaN
        "  %answer = select i1 %none, double 0.0, double %estimate",
        "  ret double %answer",
    ]


def _square(name: str, terms: Combination) -> str:
    """IR of the sum of squares of a combination in units of the weights."""
    stages = "".join(f", ptr noalias readonly %k{stage}" for stage in terms)
    body = [
        *_sum("total", terms),
        *_load("inverse", "inverse_weights"),
        f"  %part = fmul {_VECTOR} %total, %inverse",
        f"  %part2 = fmul {_VECTOR} %part, %part",
        f"  %sum_next = fadd {_VECTOR} %sum, %part2",
    ]
    arguments = f"i64 %m, ptr noalias readonly %inverse_weights{stages}"
    head = f"define internal double @{name}({arguments}) alwaysinline {{"
    reduce = f"@llvm.vector.reduce.fadd.v{WIDTH}f64(double 0.0, {_VECTOR} %sum_next)"
    return "\n".join([head, *_loop(body, ["sum"]), f"  %r = call double {reduce}", "  ret double %r", "}"])


def _extend(method: RungeKutta) -> str:
    if not method.dense:
        return ""
    combinations, lines = [], _places(method)
    pairs = zip(method.dense_nodes, method.dense_rows, strict=True)
    for i, (node, row) in enumerate(pairs, start=method.stages):
        combinations.append(_combination(f"dense{i}", row))
        lines += _stage(i, node, row, f"dense{i}")
    return "\n".join(
        [*combinations, f"define void @extend({_ARGUMENTS}) nounwind {{", *lines, "  ret void", "}"]
    )


# -- what a stage evaluates ----------------------------------------------------------------------------------


def _entry(position: int, name: str, kind: str) -> str:
    at = f"  %{name}_at = getelementptr i64, ptr %problem, i64 {position}\n"
    return at + f"  %{name} = load {kind}, ptr %{name}_at"


_EVALUATIONS = "\n".join(
    [
        "define void @plain(ptr %problem, double %t, ptr %y, ptr %k) nounwind {",
        *[_entry(i, name, "ptr") for i, name in enumerate(("rhs", "c"))],
        "  tail call void %rhs(double %t, ptr %y, ptr %c, ptr %k)",
        "  ret void",
        "}",
        "define void @tangent(ptr %problem, double %t, ptr %y, ptr %k) nounwind {",
        *[_entry(i, name, "ptr") for i, name in enumerate(("rhs_jac", "c", "product"))],
        _entry(3, "blocks", "i64"),
        *[_entry(i, name, "ptr") for i, name in enumerate(("sources", "buffer"), start=4)],
        *[_entry(i, name, "i64") for i, name in enumerate(("n", "start"), start=6)],
        "  call void %rhs_jac(double %t, ptr %y, ptr %c, ptr %buffer)",
        "  %bytes = mul i64 %n, 8",
        "  call void @llvm.memcpy.p0.p0.i64(ptr %k, ptr %buffer, i64 %bytes, i1 false)",
        "  %entries = getelementptr double, ptr %buffer, i64 %n",
        "  %x = getelementptr double, ptr %y, i64 %start",
        "  %out = getelementptr double, ptr %k, i64 %start",
        "  tail call void %product(i64 %blocks, ptr %x, ptr %sources, ptr %entries, ptr %out)",
        "  ret void",
        "}",
        "declare void @llvm.memcpy.p0.p0.i64(ptr, ptr, i64, i1)",
    ]
)


def _place(array: str, rows: str) -> list[str]:
    """%place: where the next stage stands in batches of so many rows; it is counted."""
    return [
        f"  %batch = udiv i64 %count, {LANES}",
        f"  %lane = urem i64 %count, {LANES}",
        f"  %length = mul i64 {rows}, {LANES}",
        "  %batch_offset = mul i64 %batch, %length",
        "  %offset = add i64 %batch_offset, %lane",
        f"  %place = getelementptr double, ptr {array}, i64 %offset",
        "  %counted = add i64 %count, 1",
        "  store i64 %counted, ptr %count_at",
    ]


# Evaluations that stages are written down by, and that Jacobians are read by which were evaluated there.
_BATCHES = "\n".join(
    [
        "define void @recorded(ptr %problem, double %t, ptr %y, ptr %k) nounwind {",
        "entry:",
        *[_entry(i, name, "ptr") for i, name in enumerate(("rhs", "c", "batches", "places"))],
        *[_entry(i, name, "i64") for i, name in enumerate(("n", "rows", "count"), start=4)],
        "  %all = add i64 %rows, 1",
        *_place("%batches", "%all"),
        f"  %last = mul i64 %rows, {LANES}",
        "  %t_at = getelementptr double, ptr %place, i64 %last",
        "  store double %t, ptr %t_at",
        "  br label %loop",
        "loop:",
        "  %i = phi i64 [ 0, %entry ], [ %i_next, %write ]",
        "  %more = icmp ult i64 %i, %n",
        "  br i1 %more, label %write, label %done",
        "write:",
        "  %row_at = getelementptr i64, ptr %places, i64 %i",
        "  %row = load i64, ptr %row_at",
        f"  %row_offset = mul i64 %row, {LANES}",
        "  %state_at = getelementptr double, ptr %place, i64 %row_offset",
        "  %y_at = getelementptr double, ptr %y, i64 %i",
        "  %state = load double, ptr %y_at",
        "  store double %state, ptr %state_at",
        "  %i_next = add i64 %i, 1",
        "  br label %loop",
        "done:",
        "  tail call void %rhs(double %t, ptr %y, ptr %c, ptr %k)",
        "  ret void",
        "}",
        "define void @replayed(ptr %problem, double %t, ptr %y, ptr %k) nounwind {",
        _entry(0, "product", "ptr"),
        _entry(1, "blocks", "i64"),
        *[_entry(i, name, "ptr") for i, name in enumerate(("sources", "jacobians"), start=2)],
        *[_entry(i, name, "i64") for i, name in enumerate(("entries", "count"), start=4)],
        *_place("%jacobians", "%entries"),
        "  tail call void %product(i64 %blocks, ptr %y, ptr %sources, ptr %place, ptr %k)",
        "  ret void",
        "}",
    ]
)
