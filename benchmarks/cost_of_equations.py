"""What a point of an equilibrium branch costs: generated Python, linear algebra, and numba for comparison.

Run with `.venv/bin/python benchmarks/cost_of_equations.py`; the comparison is made where numba is installed.
The numbers are quoted in docs/architecture.md.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from importlib.util import find_spec
from statistics import median
from typing import Any

import numpy as np

import contwalk as cw
from contwalk.fields.kernel import Kernel
from contwalk.numerics.linear import Factored
from contwalk.problems.equilibrium.equations import Equations

MASSES = 2  # 8 states


def microseconds(call: Callable[[], Any], calls: int = 2000, repetitions: int = 7) -> float:
    """Median time of a call."""
    times = []
    for _ in range(repetitions):
        begin = time.perf_counter()
        for _ in range(calls):
            call()
        times.append((time.perf_counter() - begin) / calls)
    return 1e6 * median(times)


def milliseconds(call: Callable[[], Any]) -> float:
    """Time of one call."""
    begin = time.perf_counter()
    call()
    return 1e3 * (time.perf_counter() - begin)


def compiled(kernel: Kernel) -> tuple[Callable[..., None], int]:
    """The kernel's own text as a numba function that writes its last argument, and its number of outputs."""
    import numba

    lines = kernel.text.replace("):", ", out):", 1).split("\n")
    at = next(k for k, line in enumerate(lines) if line.strip().startswith("return ["))
    outputs = lines[at].strip().removeprefix("return [").removesuffix("]").split(", ")
    lines[at : at + 1] = [f"    out[{k}] = {output}" for k, output in enumerate(outputs)]
    names: dict[str, Any] = {f"{name}_": getattr(math, name) for name in ("sin", "cos", "sqrt", "exp")}
    exec("\n".join(lines), names)
    return numba.njit(names["evaluate"]), len(outputs)


def main() -> None:
    system = cw.load_system("autobalancer", {"masses": MASSES})
    equations = Equations(system, "m")
    print(f"trace                        {milliseconds(lambda: equations.program):8.2f} ms, once")
    print(f"Jacobian and its text        {milliseconds(lambda: equations.linearization):8.2f} ms, once")
    kernel = equations.linearization
    values = [system.defaults()[name] for name in system.parameter_names]
    x = np.random.default_rng(0).normal(0.0, 0.3, len(system.states)).tolist()
    inputs = [x, [0.01], values, [0.0] * len(values), []]
    print(f"bytecode and first call      {milliseconds(lambda: kernel(*inputs)):8.2f} ms, once")
    print(f"residual                     {microseconds(lambda: equations.residual(*inputs)):8.1f} us")
    print(f"residual and Jacobian        {microseconds(lambda: kernel(*inputs)):8.1f} us")
    table = kernel(*inputs)[:, 1:]
    n, size = len(system.states), len(system.states) + 1
    bordered, one = np.vstack([table, np.ones(size)]), np.ones(size)
    solving = microseconds(lambda: Factored(bordered, one).solve(one))
    print(f"scaled solve, {size} unknowns     {solving:8.1f} us")
    print(f"eigenvalues and vectors      {microseconds(lambda: np.linalg.eig(table[:, :n])):8.1f} us")
    if find_spec("numba") is not None:
        function, outputs = compiled(kernel)
        arrays = [np.array(group if group else [0.0]) for group in inputs]
        out = np.empty(outputs)
        print(f"numba: compilation           {milliseconds(lambda: function(*arrays, out)):8.0f} ms, once")
        print(f"numba: residual and Jacobian {microseconds(lambda: function(*arrays, out)):8.1f} us")
    problem = cw.Equilibrium(system, system.defaults() | {"omega": 5.0, "m": 0.01}, free="m")
    begin = time.perf_counter()
    branch = cw.continue_branch(problem, "balanced", range=(0.001, 0.02))
    per_point = 1e3 * (time.perf_counter() - begin) / len(branch)
    print(f"a whole branch               {per_point:8.2f} ms a point, {len(branch)} points")


if __name__ == "__main__":
    main()
