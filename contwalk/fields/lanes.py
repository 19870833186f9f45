"""A program for several arguments at once: in its LLVM IR a vector takes the place of each number.

What is computed in a lane is what the program computes, operation by operation, and so the same, bitwise.
Functions of the C library are called lane by lane.
"""

from __future__ import annotations

import re

# Arguments at once: the doubles of the widest registers there are. Narrower ones take several.
LANES = 8

_DOUBLES, _BITS = f"<{LANES} x double>", f"<{LANES} x i1>"
# What other texts hold than straight lines of operations on doubles: branches, arrays, tables and noise.
_OTHER = ("\n  br ", " = alloca ", "fptosi", "@table_", "call void", "@contwalk_noise")
_ADDRESS = re.compile(r"  (%\w+) = getelementptr double, ptr (%\w+), i64 (\d+)")
_LOAD = re.compile(r"  (%\w+) = load double, ptr (%\w+)")
_STORE = re.compile(r"  store double (\S+), ptr (%\w+)")
_CALL = re.compile(r"  (%\w+) = call double @([\w.]+)\((.*)\) #0")
_CHOICE = re.compile(r"  (%\w+) = select i1 (\S+), double (\S+), double (\S+)")
_DECLARED = re.compile(r"declare double @([\w.]+)\((.*)\) #0")


def has_lanes(text: str) -> bool:
    """Whether a module of one function (see `machine_code.function`) is a straight line of operations."""
    return not any(part in text for part in _OTHER)


def lanes_text(text: str, name: str, states: int, skipped: int) -> str:
    """LLVM IR of `void name(ptr x, ptr c, ptr out)` from that of one `(t, x, c, out)`.

    Row i of `x` is state i of all lanes, the last row is the time; row j of `out` is output `skipped` + j.

    Parameters
    ----------
    text : str
        A module of one function that `has_lanes`.
    name : str
        What the function is called.
    states : int
        Length of x.
    skipped : int
        Leading outputs that are not wanted.
    """
    body = text[text.index("{\n") + 2 : text.index("  ret void")].splitlines()
    read, written = "ptr noalias nocapture readonly", "ptr noalias nocapture writeonly"
    lines = [
        f"define void @{name}({read} %x, {read} %c, {written} %out) nounwind {{",
        f"  %t_at = getelementptr double, ptr %x, i64 {LANES * states}",
        f"  %t = load {_DOUBLES}, ptr %t_at, align 8",
    ]
    addresses: dict[str, tuple[str, int]] = {}
    for line in body:
        lines += _translated(line, addresses, skipped)
    declared = {
        _declaration(called, len(arguments.split(",")))
        for called, arguments in _DECLARED.findall(text[text.index("  ret void") :])
    }
    attribute = "attributes #0 = { nounwind willreturn readnone }"
    return "\n".join([*lines, "  ret void", "}", *sorted(declared), attribute, ""])


def _translated(line: str, addresses: dict[str, tuple[str, int]], skipped: int) -> list[str]:
    """A statement for all lanes."""
    if found := _ADDRESS.fullmatch(line):
        addresses[found[1]] = found[2], int(found[3])
        return []
    if found := _LOAD.fullmatch(line):
        return _loaded(found[1], *addresses[found[2]])
    if found := _STORE.fullmatch(line):
        _, place = addresses[found[2]]
        return [] if place < skipped else _stored(_operand(found[1]), place - skipped)
    if found := _CALL.fullmatch(line):
        arguments = [operand.removeprefix("double ") for operand in found[3].split(", ")]
        return _called(found[1], found[2], arguments)
    if found := _CHOICE.fullmatch(line):
        name, condition, first, second = found.groups()
        sides = f"{_DOUBLES} {_operand(first)}, {_DOUBLES} {_operand(second)}"
        return [f"  {name} = select {_BITS} {condition}, {sides}"]
    head, _, operands = line.rpartition(" double " if " double " in line else " i1 ")
    if not head:
        raise ValueError(f"no statement of a straight line: {line.strip()}")
    kind = _DOUBLES if " double " in line else _BITS
    given = ", ".join(_operand(operand) for operand in operands.split(", "))
    return [f"  {head.strip()} {kind} {given}"]


def _operand(text: str) -> str:
    """A name as it is; a number in all lanes."""
    if text.startswith("%"):
        return text
    return f"splat (i1 {text})" if text in ("true", "false") else f"splat (double {text})"


def _loaded(name: str, array: str, place: int) -> list[str]:
    own = LANES * place if array == "%x" else place
    address = f"  {name}_at = getelementptr double, ptr {array}, i64 {own}"
    if array == "%x":
        return [address, f"  {name} = load {_DOUBLES}, ptr {name}_at, align 8"]
    return [
        address,
        f"  {name}_one = load double, ptr {name}_at",
        f"  {name}_first = insertelement {_DOUBLES} poison, double {name}_one, i64 0",
        f"  {name} = shufflevector {_DOUBLES} {name}_first, {_DOUBLES} poison, "
        f"<{LANES} x i32> zeroinitializer",
    ]


def _stored(value: str, place: int) -> list[str]:
    return [
        f"  %out{place}_at = getelementptr double, ptr %out, i64 {LANES * place}",
        f"  store {_DOUBLES} {value}, ptr %out{place}_at, align 8",
    ]


def _called(name: str, function: str, operands: list[str]) -> list[str]:
    """A call of all lanes at once, of what is an operation of processors, or one for each."""
    if function.startswith("llvm."):
        all_lanes = ", ".join(f"{_DOUBLES} {_operand(operand)}" for operand in operands)
        return [f"  {name} = call {_DOUBLES} @{_of_lanes(function)}({all_lanes}) #0"]
    lines, whole = list[str](), "poison"
    for lane in range(LANES):
        given = list[str]()
        for k, operand in enumerate(operands):
            value = operand
            if operand.startswith("%"):
                value = f"{name}_{k}_{lane}"
                lines.append(f"  {value} = extractelement {_DOUBLES} {operand}, i64 {lane}")
            given.append(f"double {value}")
        lines.append(f"  {name}_of{lane} = call double @{function}({', '.join(given)}) #0")
        last = lane == LANES - 1
        joined = name if last else f"{name}_to{lane}"
        lines.append(f"  {joined} = insertelement {_DOUBLES} {whole}, double {name}_of{lane}, i64 {lane}")
        whole = joined
    return lines


def _of_lanes(function: str) -> str:
    return f"{function.removesuffix('.f64')}.v{LANES}f64"


def _declaration(function: str, arguments: int) -> str:
    if function.startswith("llvm."):
        return f"declare {_DOUBLES} @{_of_lanes(function)}({', '.join([_DOUBLES] * arguments)}) #0"
    return f"declare double @{function}({', '.join(['double'] * arguments)}) #0"
