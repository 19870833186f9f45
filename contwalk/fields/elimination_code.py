"""LLVM IR of `elimination`: the same operations in the same order, as loops over any number of rows.

A factor is an array of doubles: the matrix by columns, n pivots, the determinant. Up to `FEW_ROWS` rows there
is a text without loops or exchanges in memory, which LLVM keeps in registers.
"""

from __future__ import annotations

import struct
import sys
from collections.abc import Iterator
from contextlib import contextmanager

from contwalk.fields.elimination import FEW_ROWS, MARGIN

_NAN = "0x7FF8000000000000"


def factor_width(n: int) -> int:
    """Length of the array of a factor of n rows."""
    return n * n + n + 1


def called(kind: str, n: int) -> str:
    """The function that does `kind` ("factor", "factor_symmetric", "solved") for n rows."""
    return f"contwalk_{kind}_{n}" if n <= FEW_ROWS else f"contwalk_{kind}"


def texts(names: set[str]) -> list[str]:
    """Definitions of the functions of these names, and of those they call; in a fixed order."""
    found = []
    for name in sorted(names):
        kind, _, rows = name.removeprefix("contwalk_").rpartition("_")
        if rows.isdigit():
            found.append(_small_factor(int(rows)) if kind == "factor" else _small_solved(int(rows)))
    if names & {"contwalk_factor", "contwalk_factor_symmetric"}:
        found.append(_factor())
    if "contwalk_factor_symmetric" in names:
        found.append(_factor_symmetric())
        found.append("declare void @llvm.memcpy.p0.p0.i64(ptr, ptr, i64, i1)\n")
    if "contwalk_solved" in names:
        found.append(_solved())
    return found


def literal(value: float) -> str:
    """A number in IR, by its bits."""
    return f"0x{struct.unpack('<Q', struct.pack('<d', value))[0]:016X}"


class _Text:
    """Statements of one function."""

    def __init__(self) -> None:
        self.lines: list[str] = []
        self.variables: list[str] = []
        self.count = 0

    def say(self, statement: str) -> None:
        """A statement without a value."""
        self.lines.append(f"  {statement}")

    def let(self, operation: str) -> str:
        """A new value, and its name."""
        self.count += 1
        self.say(f"%v{self.count} = {operation}")
        return f"%v{self.count}"

    def label(self, what: str) -> str:
        """A new name of a block."""
        self.count += 1
        return f"{what}{self.count}"

    def block(self, name: str) -> None:
        """From here on another block; the one before ends with a jump of its own."""
        self.lines.append(f"{name}:")

    def variable(self, kind: str, value: str) -> str:
        """A variable with its first value."""
        self.count += 1
        self.variables.append(f"  %v{self.count} = alloca {kind}")
        self.say(f"store {kind} {value}, ptr %v{self.count}")
        return f"%v{self.count}"

    @contextmanager
    def loop(self, start: str, stop: str = "%n") -> Iterator[str]:
        """For whole numbers from `start` to below `stop`."""
        counter = self.variable("i64", start)
        head, body, out = self.label("head"), self.label("body"), self.label("out")
        self.say(f"br label %{head}")
        self.block(head)
        i = self.let(f"load i64, ptr {counter}")
        self.say(f"br i1 {self.let(f'icmp slt i64 {i}, {stop}')}, label %{body}, label %{out}")
        self.block(body)
        yield i
        self.say(f"store i64 {self.let(f'add nsw i64 {i}, 1')}, ptr {counter}")
        self.say(f"br label %{head}")
        self.block(out)

    def leave_if(self, condition: str, target: str) -> None:
        """Go to a block where a condition holds."""
        on = self.label("on")
        self.say(f"br i1 {condition}, label %{target}, label %{on}")
        self.block(on)

    def after(self, i: str) -> str:
        """i + 1."""
        return self.let(f"add nsw i64 {i}, 1")

    def place(self, i: str, j: str) -> str:
        """Address of entry (i, j) of the matrix."""
        start = self.let(f"mul nsw i64 {j}, %n")
        return self.let(f"getelementptr double, ptr %a, i64 {self.let(f'add nsw i64 {start}, {i}')}")

    def pivot_place(self, k: str) -> str:
        """Address of pivot k; behind the last one is the determinant."""
        return self.place(k, "%n")

    def at(self, i: str, j: str) -> str:
        """Entry (i, j) of the matrix."""
        return self.load(self.place(i, j))

    def load(self, address: str) -> str:
        """A double."""
        return self.let(f"load double, ptr {address}")

    def store(self, value: str, address: str) -> None:
        """Write a double."""
        self.say(f"store double {value}, ptr {address}")

    def size(self, value: str) -> str:
        """The absolute value."""
        return self.let(f"call double @llvm.fabs.f64(double {value})")

    def times(self, a: str, b: str) -> str:
        """a b."""
        return self.let(f"fmul double {a}, {b}")

    def over(self, a: str, b: str) -> str:
        """a / b."""
        return self.let(f"fdiv double {a}, {b}")

    def less(self, address: str, a: str, b: str) -> None:
        """Subtract a b from what stands at an address."""
        self.store(self.let(f"fsub double {self.load(address)}, {self.times(a, b)}"), address)

    def rounding(self, k: str, factor: str) -> str:
        """What of pivot k may be rounding."""
        total = self.variable("double", "0.0")
        with self.loop("0", k) as j:
            share = self.size(self.times(self.at(k, j), self.at(j, k)))
            self.store(self.let(f"fadd double {self.load(total)}, {share}"), total)
        return self.times(factor, self.load(total))

    def margin(self) -> str:
        """MARGIN n eps."""
        rows = self.times(literal(MARGIN), self.let("sitofp i64 %n to double"))
        return self.times(rows, literal(sys.float_info.epsilon))

    def multiply_determinant(self, factor: str) -> None:
        """The determinant so far, times a number."""
        address = self.pivot_place("%n")
        self.store(self.times(self.load(address), factor), address)

    def function(self, head: str) -> str:
        """The whole text."""
        return "\n".join([f"define internal void {head} nounwind {{", *self.variables, *self.lines, "}", ""])


def _factor() -> str:
    """`contwalk_factor(n, a)`: see `elimination.eliminated`. Of a singular matrix the pivots are NaN."""
    t = _Text()
    margin, bad = t.margin(), t.variable("i1", "0")
    t.store(literal(1.0), t.pivot_place("%n"))
    with t.loop("0") as k:
        p, best = t.variable("i64", k), t.variable("double", "0.0")
        t.store(t.size(t.at(k, k)), best)
        with t.loop(t.after(k)) as i:
            size, largest, so_far = t.size(t.at(i, k)), t.load(best), t.let(f"load i64, ptr {p}")
            larger = t.let(f"fcmp ogt double {size}, {largest}")
            t.store(t.let(f"select i1 {larger}, double {size}, double {largest}"), best)
            t.say(f"store i64 {t.let(f'select i1 {larger}, i64 {i}, i64 {so_far}')}, ptr {p}")
        row = t.let(f"load i64, ptr {p}")
        t.store(t.let(f"sitofp i64 {row} to double"), t.pivot_place(k))
        with t.loop("0") as j:
            _exchange(t, t.place(k, j), t.place(row, j))
        u = t.at(k, k)
        kept = t.let(f"icmp eq i64 {row}, {k}")
        t.multiply_determinant(t.let(f"select i1 {kept}, double {u}, double {t.let(f'fneg double {u}')}"))
        size = t.size(u)
        good = t.let(f"fcmp ogt double {size}, {t.rounding(k, margin)}")
        worse, before = t.let(f"xor i1 {good}, true"), t.let(f"load i1, ptr {bad}")
        t.say(f"store i1 {t.let(f'or i1 {worse}, {before}')}, ptr {bad}")
        nothing = t.let(f"fcmp ogt double {size}, 0.0")
        t.leave_if(t.let(f"xor i1 {nothing}, true"), "singular")
        with t.loop(t.after(k)) as i:
            below = t.place(i, k)
            t.store(t.over(t.load(below), u), below)
        with t.loop(t.after(k)) as j:
            above = t.at(k, j)
            with t.loop(t.after(k)) as i:
                t.less(t.place(i, j), t.at(i, k), above)
    t.leave_if(t.let(f"load i1, ptr {bad}"), "singular")
    t.say("ret void")
    t.block("singular")
    with t.loop("0") as k:
        t.store(_NAN, t.place(k, k))
        # Behind a pivot that is zero nothing was chosen, and `contwalk_solved` goes to these places.
        t.store(t.let(f"sitofp i64 {k} to double"), t.pivot_place(k))
    t.say("ret void")
    return t.function("@contwalk_factor(i64 %n, ptr %a)")


def _exchange(t: _Text, first: str, second: str) -> None:
    a, b = t.load(first), t.load(second)
    t.store(b, first)
    t.store(a, second)


def _factor_symmetric() -> str:
    """`contwalk_factor_symmetric(n, a)`: see `elimination.eliminated_symmetric`."""
    t = _Text()
    margin = t.margin()
    bytes_ = t.let(f"mul i64 {t.let('mul i64 %n, %n')}, 8")
    saved = t.let(f"alloca i8, i64 {bytes_}, align 16")
    t.say(f"call void @llvm.memcpy.p0.p0.i64(ptr {saved}, ptr %a, i64 {bytes_}, i1 false)")
    t.store(literal(1.0), t.pivot_place("%n"))
    with t.loop("0") as k:
        d = t.at(k, k)
        good = t.let(f"fcmp ogt double {d}, {t.rounding(k, margin)}")
        t.leave_if(t.let(f"xor i1 {good}, true"), "indefinite")
        t.store(t.let(f"sitofp i64 {k} to double"), t.pivot_place(k))
        t.multiply_determinant(d)
        with t.loop(t.after(k)) as j:
            t.store(t.over(t.at(j, k), d), t.place(k, j))
        with t.loop(t.after(k)) as j:
            share = t.at(k, j)
            with t.loop(j) as i:
                t.less(t.place(i, j), share, t.at(i, k))
        with t.loop(t.after(k)) as j:
            _exchange(t, t.place(j, k), t.place(k, j))
    t.say("ret void")
    t.block("indefinite")
    t.say(f"call void @llvm.memcpy.p0.p0.i64(ptr %a, ptr {saved}, i64 {bytes_}, i1 false)")
    t.say("call void @contwalk_factor(i64 %n, ptr %a)")
    t.say("ret void")
    return t.function("@contwalk_factor_symmetric(i64 %n, ptr %a)")


def _solved() -> str:
    """`contwalk_solved(n, a, b)`: b becomes the solution for the factor a."""
    t = _Text()
    with t.loop("0") as k:
        p = t.let(f"fptosi double {t.load(t.pivot_place(k))} to i64")
        _exchange(t, t.let(f"getelementptr double, ptr %b, i64 {k}"), f"{_entry(t, p)}")
    with t.loop("0") as j:
        known = t.load(_entry(t, j))
        with t.loop(t.after(j)) as i:
            t.less(_entry(t, i), t.at(i, j), known)
    with t.loop("0") as r:
        j = t.let(f"sub i64 {t.let('sub i64 %n, 1')}, {r}")
        known = t.over(t.load(_entry(t, j)), t.at(j, j))
        t.store(known, _entry(t, j))
        with t.loop("0", j) as i:
            t.less(_entry(t, i), t.at(i, j), known)
    t.say("ret void")
    return t.function("@contwalk_solved(i64 %n, ptr noalias readonly %a, ptr noalias %b)")


def _entry(t: _Text, i: str) -> str:
    return t.let(f"getelementptr double, ptr %b, i64 {i}")


# -- few rows: straight lines --------------------------------------------------------------------------------


def _small_factor(n: int) -> str:
    """`contwalk_factor_n(a)`."""
    t = _Text()
    a = [
        [t.load(t.let(f"getelementptr double, ptr %a, i64 {i + n * j}")) for j in range(n)] for i in range(n)
    ]
    margin = literal(MARGIN * n * sys.float_info.epsilon)
    pivots, determinant, bad, over = list[str](), literal(1.0), "0", "0"
    for k in range(n):
        p, best = literal(float(k)), t.size(a[k][k])
        for i in range(k + 1, n):
            size = t.size(a[i][k])
            larger = t.let(f"fcmp ogt double {size}, {best}")
            best = _chosen(t, larger, size, best)
            p = _chosen(t, larger, literal(float(i)), p)
        pivots.append(p)
        kept = t.let(f"fcmp oeq double {p}, {literal(float(k))}")
        for i in range(k + 1, n):
            a[k], a[i] = _exchanged(t, p, i, a[k], a[i])
        u = a[k][k]
        product = t.times(determinant, _chosen(t, kept, u, t.let(f"fneg double {u}")))
        # after a pivot that is zero, what follows is not finite; the determinant stays
        determinant = _chosen(t, over, determinant, product)
        total = "0.0"
        for j in range(k):
            total = t.let(f"fadd double {total}, {t.size(t.times(a[k][j], a[j][k]))}")
        size = t.size(u)
        good = t.let(f"fcmp ogt double {size}, {t.times(margin, total)}")
        bad = t.let(f"or i1 {bad}, {t.let(f'xor i1 {good}, true')}")
        zero = t.let(f"xor i1 {t.let(f'fcmp ogt double {size}, 0.0')}, true")
        over = t.let(f"or i1 {over}, {zero}")
        for i in range(k + 1, n):
            a[i][k] = t.over(a[i][k], u)
            for j in range(k + 1, n):
                a[i][j] = t.let(f"fsub double {a[i][j]}, {t.times(a[i][k], a[k][j])}")
    for k in range(n):
        a[k][k] = _chosen(t, bad, _NAN, a[k][k])
    values = [a[i][j] for j in range(n) for i in range(n)] + [*pivots, determinant]
    for place, value in enumerate(values):
        t.store(value, t.let(f"getelementptr double, ptr %a, i64 {place}"))
    t.say("ret void")
    return t.function(f"@contwalk_factor_{n}(ptr %a) alwaysinline")


def _chosen(t: _Text, condition: str, first: str, second: str) -> str:
    return t.let(f"select i1 {condition}, double {first}, double {second}")


def _exchanged(t: _Text, p: str, i: int, upper: list[str], lower: list[str]) -> tuple[list[str], list[str]]:
    """Two rows, exchanged where the lower one, row i, is the pivot's."""
    here = t.let(f"fcmp oeq double {p}, {literal(float(i))}")
    pairs = [(_chosen(t, here, b, a), _chosen(t, here, a, b)) for a, b in zip(upper, lower, strict=True)]
    return [first for first, _ in pairs], [second for _, second in pairs]


def _small_solved(n: int) -> str:
    """`contwalk_solved_n(a, b)`."""
    t = _Text()
    b = [t.load(_entry(t, str(i))) for i in range(n)]

    def at(place: int) -> str:
        return t.load(t.let(f"getelementptr double, ptr %a, i64 {place}"))

    for k in range(n):
        p = at(n * n + k)
        for i in range(k + 1, n):
            (b[k],), (b[i],) = _exchanged(t, p, i, [b[k]], [b[i]])
    for j in range(n):
        for i in range(j + 1, n):
            b[i] = t.let(f"fsub double {b[i]}, {t.times(at(i + n * j), b[j])}")
    for j in reversed(range(n)):
        b[j] = t.over(b[j], at(j + n * j))
        for i in range(j):
            b[i] = t.let(f"fsub double {b[i]}, {t.times(at(i + n * j), b[j])}")
    for i, value in enumerate(b):
        t.store(value, _entry(t, str(i)))
    t.say("ret void")
    return t.function(f"@contwalk_solved_{n}(ptr noalias readonly %a, ptr noalias %b) alwaysinline")
