"""AUTO-07p with equations that are written from a plugin, for comparison; AUTO is no part of contwalk.

    git clone https://github.com/auto-07p/auto-07p && cd auto-07p && ./configure && make

builds it (a Fortran compiler is needed). Its equation file has the field and its exact derivatives,
parameters as constants, so that the compiler can fold them. AUTO's own object files are linked as they were
built, and what is started is the program that AUTO's front end would start, with one thread.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from cpu_time import seconds_of

from contwalk.fields.derivative import jacobian
from contwalk.fields.kernel import Kernel
from contwalk.fields.trace import Program
from contwalk.flow.compiled.traced import PARAMETER, STATE, TIME, field_program
from contwalk.system import System

NOTHING_TO_SAY = "\n".join(
    f"      SUBROUTINE {name}\n      END SUBROUTINE {name}" for name in ("BCND", "ICND", "FOPT", "PVLS")
)
# Functions of plugins that Fortran has under the same name.
FUNCTIONS = ("sinh", "cosh", "tanh", "sin", "cos", "exp")


@dataclass(frozen=True)
class Row:
    """A point in AUTO's output: its type, as a number, and its columns from the first parameter on."""

    label: str
    columns: tuple[str, ...]

    @property
    def value(self) -> float:
        """The first parameter."""
        return float(self.columns[0])


def built(home: Path, folder: Path, equations: str) -> None:
    """Compile the program `equations` in a folder, from an equation file and AUTO's objects."""
    objects = sorted((home / "lib").glob("*.o"))
    if not objects:
        raise SystemExit(f"CONTWALK_AUTO: no object files in {home / 'lib'}; run ./configure and make there.")
    (folder / "equations.f90").write_text(equations)
    flags = ["-O3", "-march=native", "-fopenmp"]
    given = ["gfortran", *flags, "equations.f90", *map(str, objects), "-o", "equations"]
    subprocess.run(given, cwd=folder, check=True)


def run(folder: Path, constants: str, solution: Path | None = None) -> tuple[float, list[Row]]:
    """CPU seconds of one start, and its points; what it stores is in `fort.8` of the folder."""
    for old in folder.glob("fort.*"):
        old.unlink()
    if solution is not None:
        shutil.copy(solution, folder / "fort.3")
    (folder / "fort.2").write_text(constants)
    alone = {**os.environ, "OMP_NUM_THREADS": "1"}
    with (folder / "fort.2").open() as given:
        seconds = seconds_of(["./equations"], cwd=folder, stdin=given, env=alone)
    rows = [line.split() for line in (folder / "fort.7").read_text().splitlines()]
    return seconds, [Row(row[2], tuple(row[4:])) for row in rows if row and row[0] != "0"]


def equation_file(system: System, values: Mapping[str, float], free: Sequence[str], start: np.ndarray) -> str:
    """AUTO's equation file of a system's first mode; PAR(1) and so on are the parameters `free`."""
    n, program = len(system.states), field_program(system)
    names, value = _fortran(program, n)
    moved = [system.parameter_names.index(name) for name in free]
    more, derivatives = _fortran(_with_derivatives(program, n, moved), n)
    # AUTO passes no room for the derivatives by parameters where it asks only for the Jacobian.
    derivatives = derivatives.replace("        DFDP(", "        IF (IJAC == 2) DFDP(")
    numbers = {name: f"({_double(repr(float(values[name])))})" for name in system.parameter_names}
    fixed = [f"free{free.index(name)}" if name in free else number for name, number in numbers.items()]
    given = "\n".join(f"      free{k} = PAR({k + 1})" for k in range(len(free)))
    begun = "\n".join(f"      PAR({k + 1}) = {numbers[name][1:-1]}" for k, name in enumerate(free))
    local = sorted({*names, *more, *(f"free{k}" for k in range(len(free)))})
    declared = "\n".join(f"      DOUBLE PRECISION {name}" for name in local)
    texts = [re.sub(r"\bp\((\d+)\)", lambda m: fixed[int(m[1]) - 1], text) for text in (value, derivatives)]
    states = "\n".join(f"      U({i + 1}) = {_double(repr(float(x)))}" for i, x in enumerate(start))
    return f"""      SUBROUTINE FUNC(NDIM, x, ICP, PAR, IJAC, F, DFDU, DFDP)
      IMPLICIT NONE
      INTEGER, INTENT(IN) :: NDIM, ICP(*), IJAC
      DOUBLE PRECISION, INTENT(IN) :: x(NDIM), PAR(*)
      DOUBLE PRECISION, INTENT(OUT) :: F(NDIM)
      DOUBLE PRECISION, INTENT(INOUT) :: DFDU(NDIM, NDIM), DFDP(NDIM, *)
{declared}
{given}
      IF (IJAC == 0) THEN
{texts[0]}
      ELSE
{texts[1]}
      END IF
      END SUBROUTINE FUNC

      SUBROUTINE STPNT(NDIM, U, PAR, T)
      IMPLICIT NONE
      INTEGER, INTENT(IN) :: NDIM
      DOUBLE PRECISION, INTENT(INOUT) :: U(NDIM), PAR(*)
      DOUBLE PRECISION, INTENT(IN) :: T
{begun}
{states}
      END SUBROUTINE STPNT

{NOTHING_TO_SAY}
"""


def _with_derivatives(program: Program, n: int, parameters: Sequence[int]) -> Program:
    """The field, its Jacobian column by column, and its derivatives by some parameters."""
    graph = program.graph
    along = [*(graph.input(STATE, i) for i in range(n)), *(graph.input(PARAMETER, k) for k in parameters)]

    def change(outputs: tuple[int, ...]) -> Sequence[int]:
        rows = jacobian(graph, outputs, along)
        return [*outputs, *(row.get(k, graph.zero) for k in range(len(along)) for row in rows)]

    return program.transformed(change)


def _fortran(program: Program, n: int) -> tuple[list[str], str]:
    """Names and statements of a program without conditions, from its Python text."""
    lines = Kernel(program, [TIME, STATE, PARAMETER]).text.splitlines()[1:]
    *statements, last = (line.strip() for line in lines)
    places = range(1, n + 1)
    targets = [f"F({i})" for i in places] + [f"DFDU({i},{k})" for k in places for i in places]
    targets += [f"DFDP({i},{k})" for k in (1, 2) for i in places]
    results = last.removeprefix("return [").removesuffix("]").split(", ")
    statements += [f"{target} = {result}" for target, result in zip(targets, results, strict=False)]
    return [line.split(" = ")[0] for line in statements if line.startswith("t")], "\n".join(
        "        " + _statement(line) for line in statements
    )


def _statement(line: str) -> str:
    line = re.sub(r"\b([xp])\[(\d+)\]", lambda m: f"{m[1]}({int(m[2]) + 1})", line).replace("number_(", "(")
    for name in FUNCTIONS:
        line = line.replace(f"{name}_(", f"{name.upper()}(")
    return _double(line)


def _double(text: str) -> str:
    """Python's numbers as Fortran's of double precision."""
    number = r"(?<![\w.])(\d+\.\d*)(?:e([+-]?\d+))?"
    return re.sub(number, lambda m: f"{m[1]}d{m[2] or 0}", re.sub(r"(?<![\w.])(\d+)e", r"\1.0e", text))
