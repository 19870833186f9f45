"""A small machine and a run file for it, shared by the tests of the run file."""

from __future__ import annotations

from pathlib import Path

import pytest

from contwalk.errors import RunFileError
from contwalk.workflow.run_file.reading import RunFile, read_run_file

PLUGIN = """
from contwalk.system import (
    Choice, Family, Mode, Observable, Parameter, Start, State, System, Transition
)

def field(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = -p.stiffness * x[0] - p.damping * x[1]

def height(t, x, p):
    return x[0]

def rebound(t, x, p, x_plus):
    x_plus[0] = 0.0
    x_plus[1] = -x[1]

def build(masses, suspension):
    return System(
        name="rotor",
        states=(State("angle", unit="rad"), State("speed", unit="rad/s")),
        parameters=(
            Parameter("stiffness", 2.0, unit="N m", bounds=(0.0, None), about="of the\\n shaft: all"),
            Parameter("damping", 0.5, unit="N m s", bounds=(0.0, 1.0)),
            Parameter("load", 0.0, unit="N"),
        ),
        modes=(Mode("free", field),),
        transitions=(Transition("touch_down", "free", "free", height, reset=rebound),),
        observables=(Observable("swing", lambda t, x, p: x[:, 0].max(), unit="rad"),),
        starts=(
            Start("balanced", lambda p: [[0.0, 0.0]]),
            Start("tilted", lambda p: [[1.0, 0.0]] if p.load else [], exists="where load is not zero"),
        ),
        presets={"heavy": {"load": 3.0, "damping": 0.25}, "light": {"load": 1.0}},
    )

SYSTEM = Family(
    "rotor",
    choices=(
        Choice("masses", 2, minimum=1),
        Choice("suspension", "isotropic", allowed=("isotropic", "soft")),
    ),
    build=build,
)
"""

GOOD = """\
contwalk: 1
system: ./rotor.py
parameters: {stiffness: 2.0}
start: {equilibrium: balanced}
continue:
  parameter: stiffness
  range: [1.0, 3.0]
"""


def write_run(folder: Path, text: str) -> Path:
    """The plugin and a run file beside it; gives the run file's path."""
    (folder / "rotor.py").write_text(PLUGIN, encoding="utf-8")
    path = folder / "run.yaml"
    path.write_text(text, encoding="utf-8")
    return path


def read(folder: Path, text: str, *overrides: str) -> RunFile:
    """The run file of this text."""
    return read_run_file(write_run(folder, text), overrides)


def message(folder: Path, text: str, *overrides: str) -> str:
    """What is said of a run file that cannot be used."""
    path = write_run(folder, text)
    with pytest.raises(RunFileError) as caught:
        read_run_file(path, overrides)
    assert caught.value.exit_code == 2
    said = str(caught.value)
    assert "run.yaml" in said or "--set" in said
    return said
