"""What a user's own type checker says of the package, installed as any other."""

from __future__ import annotations

import os
import subprocess
import sys
import sysconfig
import venv
from pathlib import Path

import pytest

import contwalk

SCRIPT = """
from typing import Any

import contwalk as cw
from contwalk.system import Mode, Parameter, State, System


def field(t: float, x: list[float], p: Any, dx: list[float]) -> None:
    dx[0] = p.a - x[0]


made = System("one", states=(State("x"),), parameters=(Parameter("a", 1.0),), modes=(Mode("only", field),))
system = cw.load_system("autobalancer", {"masses": 2})
machine = cw.Equilibrium(system, system.defaults() | {"omega": 5.0, "m": 0.01}, free="m")
balanced = cw.continue_branch(machine, "balanced", range=(0.001, 0.024))
for point in balanced.special_points:
    print(point.name, point.kind, point.parameters["m"], point.criticality, point.error)
unbalanced = cw.switch_branch(machine, balanced, "BP1", range=(0.001, 0.024))
print((unbalanced["stable"] == 1).sum(), len(unbalanced), unbalanced["m"].max())
cw.save(cw.plot_bifurcation_diagram([balanced, unbalanced], x="m", y="max_re"), "autobalancer.png")


@cw.model(A=1.0, B=1.5)
def brusselator(x: float, y: float, *, A: float, B: float) -> tuple[float, float]:
    return A - (B + 1) * x + x**2 * y, B * x - x**2 * y


@cw.model
def decay(x: float, *, a: float = 1.0) -> float:
    return -a * x


found = cw.diagram(brusselator, "B", (1, 4))
found.plot("x")
found.save("brusselator.png")
for branch in cw.open_database("x.h5"):
    print(branch.name, branch.to_pandas())
reveal_type(brusselator)
reveal_type(decay)
reveal_type(found)
"""


@pytest.mark.slow
def test_strict_types_of_a_script(tmp_path):
    pytest.importorskip("mypy")
    if os.name != "posix":
        pytest.skip("links to folders")
    venv.create(tmp_path / "env", with_pip=False, symlinks=True)
    (packages,) = (tmp_path / "env").rglob("site-packages")
    for folder in (Path(contwalk.__file__).parent, Path(sysconfig.get_path("purelib"), "numpy")):
        (packages / folder.name).symlink_to(folder)
    (tmp_path / "script.py").write_text(SCRIPT, encoding="utf-8")
    python = tmp_path / "env" / "bin" / "python"
    told = subprocess.run(
        [sys.executable, "-m", "mypy", "--strict", "--python-executable", str(python), "script.py"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert "error" not in told.stdout + told.stderr, told.stdout
    revealed = [line.split('"')[1].rpartition(".")[2] for line in told.stdout.splitlines() if '"' in line]
    assert revealed == ["System", "System", "DiagramFound"]
