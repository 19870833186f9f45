"""The command line in a folder of its own, with a small machine that has a pitchfork at r = 0."""

from __future__ import annotations

import shutil
from dataclasses import dataclass
from pathlib import Path

import pytest

from contwalk.cli.entry import run

# x' = r x - x^3: pitchfork at r = 0. y' = a - y is a second direction that is always stable.
PLUGIN = """\
from contwalk.system import Mode, Observable, Parameter, Start, State, System

def field(t, x, p, dx):
    dx[0] = p.r * x[0] - x[0] ** 3
    dx[1] = p.a - x[1]

def draw(axes, t, x, p):
    axes.plot([0.0, x[0]], [0.0, 1.0])

SYSTEM = System(
    name="fork",
    states=(State("x", unit="m", about="deflection"), State("y", unit="1", about="level")),
    parameters=(
        Parameter("r", -0.5, unit="N", bounds=(-5.0, 5.0), about="load"),
        Parameter("a", 0.25, unit="1", about="supply"),
    ),
    modes=(Mode("free", field),),
    observables=(Observable("height", lambda t, x, p: x[:, 0].max(), unit="m", about="largest x"),),
    starts=(Start("upright", lambda p: [[0.0, p.a]]),),
    presets={"rich": {"a": 2.0}},
    draw=draw,
    reference="any textbook",
)
"""

RUN = """\
contwalk: 1
system: ./fork.py
start: {equilibrium: upright}
continue: {parameter: r, range: [-1.0, 1.0]}
diagram: none
output: fork.h5
"""


@dataclass
class Outcome:
    """What a command left behind."""

    code: int
    out: str
    err: str


@pytest.fixture
def folder(tmp_path, monkeypatch) -> Path:
    """The current directory, with the plugin and its run file."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "fork.py").write_text(PLUGIN, encoding="utf-8")
    (tmp_path / "run.yaml").write_text(RUN, encoding="utf-8")
    return tmp_path


@pytest.fixture(scope="module")
def left_behind() -> dict[str, Path]:
    """Folders with all that studies have left, by the name of each."""
    return {}


@pytest.fixture
def study_of(contwalk, folder):
    """Computes a study in the folder, of a plugin and its run file; gives the name of its database."""

    def computed(name: str, plugin: str, run_file: str) -> str:
        (folder / f"{name}.py").write_text(plugin, encoding="utf-8")
        (folder / f"{name}.yaml").write_text(run_file, encoding="utf-8")
        assert contwalk("continue", f"{name}.yaml", "--quiet").code == 0
        return f"{name}.h5"

    return computed


@pytest.fixture
def kept_study_of(study_of, folder, left_behind, tmp_path_factory):
    """As `study_of`, computed once for all tests of a file: its database names the plugin of the first."""

    def put(name: str, plugin: str, run_file: str) -> str:
        if name not in left_behind:
            study_of(name, plugin, run_file)
            left_behind[name] = tmp_path_factory.mktemp(name)
            shutil.copytree(folder, left_behind[name], dirs_exist_ok=True)
        shutil.copytree(left_behind[name], folder, dirs_exist_ok=True)
        return f"{name}.h5"

    return put


@pytest.fixture
def fork_with_branches(kept_study_of) -> str:
    """The database of a run that followed the branches at the pitchfork as well."""
    return kept_study_of("fork", PLUGIN, RUN.replace("diagram: none", "diagram: {follow: [BP]}"))


@pytest.fixture
def contwalk(folder, capsys):
    """Runs a command in the folder."""

    def call(*arguments: str) -> Outcome:
        capsys.readouterr()
        code = run(arguments)
        return Outcome(code, *capsys.readouterr())

    return call
