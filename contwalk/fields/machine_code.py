"""Writing programs as LLVM IR: straight lines of operations on doubles.

What is undefined is NaN: an operation that has no finite result where its arguments are finite (a division by
zero, the logarithm of zero, an overflowing exponential) gives NaN rather than infinity, a condition between
numbers of which one is NaN has no outcome (`a & b` and `a | b` have one where one side decides, whatever the
other is), and NaN passes through everything that is computed from it. No
operation traps. So operations may be executed whether or not their results will be used, both sides of a
`select` are computed without a branch, and whatever depends on parameters alone is computed once beforehand.
"""

from __future__ import annotations

import hashlib
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

from contwalk.fields import elimination_code
from contwalk.fields.elimination_code import factor_width, literal
from contwalk.fields.graph import BUNDLES, CONDITIONS, FACTORS, RELATIONS, ROUNDING, Graph
from contwalk.fields.hoisting import width_of
from contwalk.fields.special_functions import POLYGAMMA
from contwalk.fields.trace import Fork, Outputs, Program, Raises, Tree, roots
from contwalk.numerics import noise

Input = tuple[str, int]

_NAN = "0x7FF8000000000000"
_INFINITY = "0x7FF0000000000000"
_ARITHMETIC = {"add": "fadd", "sub": "fsub", "mul": "fmul", "div": "fdiv"}
_RELATION = {"lt": "olt", "le": "ole", "eq": "oeq"}
_LIBRARY = {
    **{name: name for name in ("sin", "cos", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh", "asinh")},
    **{
        name: name
        for name in ("acosh", "atanh", "exp", "expm1", "log", "log1p", "log2", "log10", "cbrt", "erf", "erfc")
    },
    **{name: name for name in ("atan2", "pow", "hypot", "fmod")},
    "gamma": "tgamma",
    "lgamma": "lgamma",
    "polygamma": POLYGAMMA,
    "sqrt": "llvm.sqrt.f64",
    "abs": "llvm.fabs.f64",
    "floor": "llvm.floor.f64",
    "trunc": "llvm.trunc.f64",
}
# Infinite or overflowing at some finite arguments; the others are finite or NaN.
_UNBOUNDED = frozenset(
    ("sinh", "cosh", "atanh", "exp", "expm1", "log", "log1p", "log2", "log10", "pow", "hypot", "tan")
) | {"gamma", "lgamma", "polygamma"}
# NaN with some arguments, yet finite: pow(NaN, 0), pow(1, NaN).
_FORGIVING = frozenset(("pow",))
# Most operations there are.
_PLAIN = frozenset({"add", "sub", "mul", "div", "neg"})
# Among declarations: a function that the module is to define.
_SYSTEM = "system "
# What noise in the last bits is called, if there is any; see `numerics.noise`.
_NOISE = "contwalk_noise"


@dataclass
class _Body:
    """Statements of one function, and what the nodes computed so far are called in it."""

    graph: Graph
    inputs: Mapping[int, tuple[str, int]]  # nodes that are loaded: array and position
    lines: list[str] = field(default_factory=list)
    called: set[str] = field(default_factory=set)
    allocated: list[str] = field(default_factory=list)
    systems: set[str] = field(default_factory=set)  # functions of `elimination_code`
    count: int = 0

    def statement(self, operation: str) -> str:
        """A new value, and its name."""
        self.count += 1
        name = f"%v{self.count}"
        self.lines.append(f"  {name} = {operation}")
        return name

    def label(self, what: str) -> str:
        """A new name of a block."""
        self.count += 1
        return f"{what}{self.count}"

    def call(self, function: str, *operands: str) -> str:
        """A function of doubles."""
        self.called.add(f"declare double @{function}({', '.join('double' for _ in operands)}) #0")
        return self.statement(f"call double @{function}({', '.join(f'double {o}' for o in operands)}) #0")

    def choose(self, condition: str, first: str, second: str) -> str:
        """One of two doubles."""
        return self.statement(f"select i1 {condition}, double {first}, double {second}")

    def address(self, array: str, position: int) -> str:
        """Where an entry of an array stands."""
        return self.statement(f"getelementptr double, ptr {array}, i64 {position}")

    def load(self, array: str, position: int) -> str:
        """An entry of an array."""
        return self.statement(f"load double, ptr {self.address(array, position)}")

    def store(self, value: str, array: str, position: int) -> None:
        """Write an entry of an array."""
        address = self.address(array, position)
        self.lines.append(f"  store double {value}, ptr {address}")

    def table(self, values: tuple[float, ...]) -> tuple[str, int]:
        """A constant array, and its length, which is 2^k - 1: filled up with NaN, which no number reaches."""
        length = 2 ** len(values).bit_length() - 1
        entries = [literal(v) for v in (*values, *[math.nan] * (length - len(values)))]
        name = f"@table_{hashlib.sha256(' '.join(entries).encode()).hexdigest()[:20]}"
        text = ", ".join(f"double {entry}" for entry in entries)
        self.called.add(f"{name} = private unnamed_addr constant [{length} x double] [{text}]")
        return name, length

    def array(self, values: Sequence[str], length: int) -> str:
        """A new array that begins with these values."""
        self.count += 1
        name = f"%a{self.count}"
        self.allocated.append(f"  {name} = alloca [{length} x double], align 16")
        for i, value in enumerate(values):
            self.store(value, name, i)
        return name

    def eliminate(self, kind: str, n: int, *arrays: str) -> None:
        """A step of a linear system of n rows; see `elimination_code`."""
        name = elimination_code.called(kind, n)
        self.systems.add(name)
        rows = [] if name.endswith(f"_{n}") else [f"i64 {n}"]
        arguments = ", ".join([*rows, *(f"ptr {array}" for array in arrays)])
        self.lines.append(f"  call void @{name}({arguments})")


class _Names(dict[int, str]):
    """What nodes are called; for conditions, `undefined` names what tells that they have no outcome."""

    def __init__(self) -> None:
        super().__init__()
        self.undefined: dict[int, str] = {}

    def copy(self) -> _Names:
        """For a branch, in which more will be defined."""
        other = _Names()
        other.update(self)
        other.undefined.update(self.undefined)
        return other


def function(
    name: str, program: Program, arrays: Sequence[str], inputs: Mapping[int, tuple[str, int]], *, time: bool
) -> tuple[str, set[str]]:
    """IR of `void name([double t,] ptr array, ..., ptr out)`, and the declarations that it needs.

    Parameters
    ----------
    name : str
    program : Program
    arrays : sequence of str
        Names of the arrays that are read.
    inputs : mapping
        Nodes that are not computed but loaded: node -> (array, position), or ("t", 0) for the time.
    time : bool
        Whether the first argument is the time.
    """
    body = _Body(program.graph, inputs)
    width = max((len(leaf.nodes) for leaf in program.leaves() if isinstance(leaf, Outputs)), default=0)
    _tree(body, program.tree, _Names(), width)
    arguments = ["double %t"] if time else []
    arguments += [f"ptr noalias nocapture readonly %{array}" for array in arrays]
    arguments.append("ptr noalias nocapture writeonly %out")
    body.lines.append("undefined:")
    _write(body, [_NAN] * width)
    head = f"define void @{name}({', '.join(arguments)}) nounwind {{"
    text = "\n".join([head, *body.allocated, *body.lines, "}", ""])
    return text, body.called | {f"{_SYSTEM}{name}" for name in body.systems}


def module(functions: Iterable[tuple[str, set[str]]]) -> str:
    """One module of several functions."""
    texts, declared = [], set[str]()
    for text, needed in functions:
        texts.append(text)
        declared |= needed
    systems = {name.removeprefix(_SYSTEM) for name in declared if name.startswith(_SYSTEM)}
    declared = {name for name in declared if not name.startswith(_SYSTEM)}
    if (noise_declared := f"declare double @{_NOISE}(double) #0") in declared:
        declared.remove(noise_declared)
        texts.append(noise.rounding_code(_NOISE))
    if systems:
        declared.add("declare double @llvm.fabs.f64(double) #0")
        texts += elimination_code.texts(systems)
    attributes = "attributes #0 = { nounwind willreturn readnone }"
    return "\n".join([*texts, *sorted(declared), attributes, ""])


def _write(body: _Body, values: Sequence[str]) -> None:
    for i, value in enumerate(values):
        body.store(value, "%out", i)
    body.lines.append("  ret void")


def _results(body: _Body, nodes: Sequence[int], names: _Names) -> list[str]:
    """Values of the outputs; all those of a bundle."""
    found = []
    for node in nodes:
        if body.graph.is_bundle(node):
            found += [body.load(names[node], i) for i in range(width_of(body.graph, node))]
        elif noise.SEED is not None and body.graph.nodes[node][0] in ROUNDING:
            found.append(body.call(_NOISE, names[node]))
        else:
            found.append(_operand(body, node, names))
    return found


def _tree(body: _Body, tree: Tree, names: _Names, width: int) -> None:
    if isinstance(tree, Raises):
        body.lines.append("  br label %undefined")
    elif isinstance(tree, Outputs):
        _define(body, tree.nodes, names)
        _write(body, _results(body, tree.nodes, names))
    else:
        _define(body, [tree.condition, *_shared(body, tree)], names)
        _fork(body, tree, names, width)


def _fork(body: _Body, tree: Fork, names: _Names, width: int) -> None:
    known, then, otherwise = body.label("known"), body.label("then"), body.label("otherwise")
    body.lines.append(f"  br i1 {names.undefined[tree.condition]}, label %undefined, label %{known}")
    body.lines.append(f"{known}:")
    body.lines.append(f"  br i1 {names[tree.condition]}, label %{then}, label %{otherwise}")
    for label, side in ((then, tree.then), (otherwise, tree.otherwise)):
        body.lines.append(f"{label}:")
        _tree(body, side, names.copy(), width)


def _shared(body: _Body, tree: Fork) -> list[int]:
    """Nodes that both sides of a fork need."""
    then, otherwise = (
        set(_needed(body.graph, roots(side), body.inputs)) for side in (tree.then, tree.otherwise)
    )
    return sorted(then & otherwise)


def _needed(graph: Graph, nodes: Iterable[int], known: Mapping[int, object]) -> list[int]:
    """Nodes to be computed for `nodes`, in an order of evaluation; loaded ones included, constants not."""
    needed: set[int] = set()
    keys, stack = graph.nodes, list(nodes)
    while stack:
        node = stack.pop()
        if node in needed or keys[node][0] == "const":
            continue
        needed.add(node)
        if node not in known and keys[node][0] != "input":
            stack += keys[node][1:]
    return sorted(needed)


def _define(body: _Body, nodes: Iterable[int], names: _Names) -> None:
    loaded = {**body.inputs, **names}
    for node in _needed(body.graph, nodes, loaded):
        if node in names:
            continue
        if node in body.inputs:
            array, position = body.inputs[node]
            names[node] = "%t" if array == "t" else _loaded(body, node, f"%{array}", position)
        elif (kind := body.graph.nodes[node][0]) in _PLAIN:
            names[node] = _operation(body, node, names)
        elif kind in BUNDLES:
            names[node] = _bundle(body, node, names)
        elif kind in CONDITIONS:
            _condition(body, node, names)
        else:
            names[node] = _operation(body, node, names)


def _loaded(body: _Body, node: int, array: str, position: int) -> str:
    return (body.address if body.graph.is_bundle(node) else body.load)(array, position)


def _bundle(body: _Body, node: int, names: _Names) -> str:
    """An array: a matrix eliminated, or the solution for a right-hand side."""
    kind, *arguments = body.graph.nodes[node]
    if kind in FACTORS:
        n = math.isqrt(len(arguments))
        by_columns = [arguments[i * n + j] for j in range(n) for i in range(n)]
        array = body.array([_operand(body, a, names) for a in by_columns], width_of(body.graph, node))
        body.eliminate(kind, n, array)
        return array
    factor, *right = arguments
    array = body.array([_operand(body, b, names) for b in right], len(right))
    body.eliminate(kind, len(right), names[factor], array)
    return array


def _looked_up(body: _Body, name: str, x: str, table: str, length: int) -> str:
    """A number of a table; or how many of its rising numbers x has reached, by halving."""
    if name == "entry":
        place = body.statement(f"fptosi double {x} to i64")
        address = body.statement(f"getelementptr double, ptr {table}, i64 {place}")
        return body.statement(f"load double, ptr {address}")
    count, step = "0", (length + 1) // 2
    while step:
        last = body.statement(f"add i64 {count}, {step - 1}")
        address = body.statement(f"getelementptr double, ptr {table}, i64 {last}")
        value = body.statement(f"load double, ptr {address}")
        reached = body.statement(f"fcmp ole double {value}, {x}")
        more = body.statement(f"add i64 {count}, {step}")
        count = body.statement(f"select i1 {reached}, i64 {more}, i64 {count}")
        step //= 2
    return body.statement(f"sitofp i64 {count} to double")


def _operand(body: _Body, node: int, names: _Names) -> str:
    value = body.graph.value(node)
    return names[node] if value is None else literal(value)


def _condition(body: _Body, node: int, names: _Names) -> None:
    """A comparison or a combination: whether it holds, and whether that is undefined."""
    name, *arguments = body.graph.nodes[node]
    if name in RELATIONS:
        a, b = (_operand(body, argument, names) for argument in arguments)
        names[node] = body.statement(f"fcmp {_RELATION[name]} double {a}, {b}")
        names.undefined[node] = body.statement(f"fcmp uno double {a}, {b}")
        return
    holds, undefined = names[arguments[0]], names.undefined[arguments[0]]
    if name == "not":
        names[node] = body.statement(f"xor i1 {holds}, true")
        names.undefined[node] = undefined
        return
    # `and` is decided by a side that does not hold, `or` by one that does, whatever the other one is
    second, second_undefined = names[arguments[1]], names.undefined[arguments[1]]
    names[node] = body.statement(f"{name} i1 {holds}, {second}")
    either = body.statement(f"or i1 {undefined}, {second_undefined}")
    for side, unknown in ((holds, undefined), (second, second_undefined)):
        open_ = side if name == "and" else body.statement(f"xor i1 {side}, true")
        leaves_open = body.statement(f"or i1 {unknown}, {open_}")
        either = body.statement(f"and i1 {either}, {leaves_open}")
    names.undefined[node] = either


def _operation(body: _Body, node: int, names: _Names) -> str:
    name, *arguments = body.graph.nodes[node]
    if name == "select":
        condition, *sides = arguments
        chosen = body.choose(names[condition], *(_operand(body, side, names) for side in sides))
        return body.choose(names.undefined[condition], _NAN, chosen)
    if name == "item":
        return body.load(names[arguments[0]], int(body.graph.nodes[arguments[1]][1]))
    if name in ("piece", "entry"):
        table = body.table(body.graph.tables[int(body.graph.nodes[arguments[1]][1])])
        return _looked_up(body, name, _operand(body, arguments[0], names), *table)
    if name == "determinant":
        n = math.isqrt(len(body.graph.nodes[arguments[0]]) - 1)
        return body.load(names[arguments[0]], factor_width(n) - 1)
    operands = [_operand(body, argument, names) for argument in arguments]
    if name == "neg":
        return body.statement(f"fneg double {operands[0]}")
    if name in _ARITHMETIC:
        result = body.statement(f"{_ARITHMETIC[name]} double {operands[0]}, {operands[1]}")
        return _finite(body, result) if name == "div" and not body.graph.value(arguments[1]) else result
    if name in ("min", "max"):
        first, second = operands if name == "max" else operands[::-1]
        below = body.statement(
            f"fcmp olt double {first}, {second}"
        )  # the first argument where they are equal
        return _unless_nan(body, operands, body.choose(below, operands[1], operands[0]))
    if name == "sign":
        unit = body.call("llvm.copysign.f64", "0x3FF0000000000000", operands[0])
        nonzero = body.statement(f"fcmp one double {operands[0]}, 0.0")
        return _unless_nan(body, operands, body.choose(nonzero, unit, "0.0"))
    return _library(body, name, operands)


def _library(body: _Body, name: str, operands: list[str]) -> str:
    result = body.call(_LIBRARY[name], *operands)
    if name in ("floor", "trunc"):
        return body.statement(f"fadd double {result}, 0.0")  # whole numbers have no negative zero
    if name in _FORGIVING:
        result = _unless_nan(body, operands, result)
    return _finite(body, result) if name in _UNBOUNDED else result


def _finite(body: _Body, value: str) -> str:
    size = body.call("llvm.fabs.f64", value)
    finite = body.statement(f"fcmp olt double {size}, {_INFINITY}")
    return body.choose(finite, value, _NAN)


def _unless_nan(body: _Body, operands: Sequence[str], value: str) -> str:
    first, last = operands[0], operands[-1]
    undefined = body.statement(f"fcmp uno double {first}, {last}")
    return body.choose(undefined, _NAN, value)
