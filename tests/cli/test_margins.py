"""`contwalk margins` on machines whose borders are known in closed form."""

from __future__ import annotations

import contextlib
import csv
import math
import shutil
import subprocess
import sys

import numpy as np
import pytest

from contwalk.cli.entry import run
from contwalk.storage.trajectory import read_margins
from contwalk.studies.margins import survival
from contwalk.workflow import margin_rays
from contwalk.workflow.tradeoff import measuring

# A damped oscillator that has fallen beyond x = wall, and a ball in one of the wells of x'' = x - x^3.
PLUGIN = """\
from contwalk.system import Mode, Parameter, Start, State, System

def damped(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = -x[0] - 2.0 * p.zeta * x[1]

def well(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = x[0] - x[0] ** 3 + p.tilt

OSCILLATOR = System(
    name="oscillator",
    states=(State("x", "m"), State("v", "m/s")),
    parameters=(Parameter("zeta", 0.1), Parameter("wall", 1.0)),
    modes=(Mode("free", damped),),
    starts=(Start("rest", lambda p: [[0.0, 0.0]]),),
    fallen=lambda t, x, p: x[0] - p.wall,
)
WELL = System(
    name="well",
    states=(State("x"), State("v")),
    parameters=(Parameter("tilt", 0.0),),
    modes=(Mode("free", well),),
    starts=(Start("right", lambda p: [[1.0, 0.0]]), Start("both", lambda p: [[1.0, 0.0], [-1.0, 0.0]])),
    fallen=lambda t, x, p: -x[0],
)
SYSTEM = {which}
"""

RUN = """\
system: ./{name}.py
start: {{equilibrium: {start}}}
continue: {{parameter: {free}, range: {range}, max_points: 4, direction: up}}
diagram: none
margins:
  of: {{from: {name}.h5, point: b1/0}}
  survive: {{time: {time}}}
  accuracy: 1e-7
  scan: 0
output: {name}.h5
"""


def prepared(folder, name, **given):
    (folder / f"{name}.py").write_text(PLUGIN.replace("{which}", name.upper()), encoding="utf-8")
    (folder / f"{name}.yaml").write_text(RUN.format(name=name, **given), encoding="utf-8")
    assert run(("continue", f"{name}.yaml", "--no-figures", "--quiet")) == 0


@pytest.fixture(scope="session")
def made_oscillator(tmp_path_factory):
    """The oscillator's files with its database."""
    made = tmp_path_factory.mktemp("oscillator")
    with contextlib.chdir(made):
        prepared(made, "oscillator", start="rest", free="zeta", range="[0.1, 0.3]", time=40)
    return made


@pytest.fixture
def oscillator(folder, made_oscillator):
    shutil.copytree(made_oscillator, folder, dirs_exist_ok=True)
    return folder


def borders(name):
    return {(r["state"], r["sign"]): r["border"] for r in read_margins(f"{name}_margins.h5").rows}


def test_a_linear_oscillator_beside_a_wall(contwalk, oscillator):
    done = contwalk("margins", "oscillator.yaml")
    assert done.code == 0
    zeta = 0.1
    omega = math.sqrt(1.0 - zeta**2)
    top, half = math.atan2(omega, zeta) / omega, math.pi / omega
    exact = {
        ("x", 1): 1.0,
        ("x", -1): math.exp(zeta * half),
        ("v", 1): math.exp(zeta * top),
        ("v", -1): math.exp(zeta * (top + half)),
    }
    assert borders("oscillator") == pytest.approx(exact, rel=1e-6)
    assert "fallen" in done.out
    with open("oscillator_margins.csv", newline="", encoding="utf-8") as file:
        table = list(csv.DictReader(file))
    assert {(r["state"], int(r["sign"])): float(r["border"]) for r in table} == borders("oscillator")


def test_what_a_tolerance_costs_and_what_it_does_to_borders(contwalk, oscillator, monkeypatch):
    """The borders do not depend on the tolerance to more than it, and so the times of few digits are free."""
    monkeypatch.setattr(measuring, "REPEATS", measuring.LEAST)
    given = ["--accuracies", "1e-6,1e-10", "--methods", "dop853", "--set", "margins.accuracy=0.001"]
    done = contwalk("tradeoff", "oscillator.yaml", "--of", "margins", *given)
    assert (done.code, done.err) == (0, "")
    with open("oscillator_tradeoff.csv", newline="", encoding="utf-8") as file:
        table = list(csv.DictReader(file))
    assert [row["tolerance"] for row in table] == ["1e-06", "1e-10"]
    assert {"error x+ at 0", "error x- at 0", "error v+ at 0", "error v- at 0"} <= set(table[0])
    assert all(float(row["worst_error"]) <= 0.001 for row in table)
    assert "4 borders to 1e-05 by verner98" in done.out
    assert "margins: {tolerance: 1e-" in done.out


def test_a_well_by_its_energy(contwalk, folder):
    prepared(folder, "well", start="right", free="tilt", range="[0, 0.1]", time=60)
    assert contwalk("margins", "well.yaml", "--no-figures").code == 0
    found = read_margins("well_margins.h5")
    tilt, rest = found.header["parameters"]["tilt"], found.instants[0]["state"][0]
    # It is lost where its energy is that of rest at x = 0: V(x) = x^4/4 - x^2/2 - tilt x = V(0) = 0.
    far = float(max(np.roots([0.25, 0.0, -0.5, -tilt]).real))
    speed = math.sqrt(-2.0 * (rest**4 / 4.0 - rest**2 / 2.0 - tilt * rest))
    exact = {("x", 1): far - rest, ("x", -1): rest, ("v", 1): speed, ("v", -1): speed}
    assert borders("well") == pytest.approx(exact, rel=1e-6)


def test_the_machine_is_made_once(contwalk, oscillator, monkeypatch):
    made, make = [], survival.hybrid_machine

    def counted(*given):
        made.append(given)
        return make(*given)

    monkeypatch.setattr(survival, "hybrid_machine", counted)
    monkeypatch.setattr(margin_rays, "_TESTS", {})
    assert contwalk("margins", "oscillator.yaml", "--no-figures").code == 0
    assert len(made) == 1


def test_given_and_drawn_directions_of_a_linear_oscillator(contwalk, oscillator):
    """A push along d is lost where the largest x that follows from it passes the wall."""
    changes = ("directions={slanting: {x: 2.0, v: -1.0}}", "random={count: 3, seed: 7}", "modes=1")
    sets = [word for change in changes for word in ("--set", f"margins.{change}")]
    assert contwalk("margins", "oscillator.yaml", "--no-figures", *sets).code == 0
    found = read_margins("oscillator_margins.h5")
    assert [r["state"] for r in found.rows[::2]] == [
        "slanting", "mode1_re", "mode1_im", "random1", "random2", "random3",
    ]  # fmt: skip
    zeta = 0.1
    omega = math.sqrt(1.0 - zeta**2)
    times = np.linspace(0.0, 2.5 * math.pi, 200001)

    def reach(vector):
        x, v = vector
        swing = x * np.cos(omega * times) + (v + zeta * x) / omega * np.sin(omega * times)
        return float(np.max(np.exp(-zeta * times) * swing))

    for row in found.rows:
        exact = 1.0 / reach(row["sign"] * np.array(row["vector"]))
        assert row["border"] == pytest.approx(exact, rel=1e-6)
    # The eigenvectors of the matrix [[0, 1], [-1, -2 zeta]] are (1, lambda).
    real, imaginary = (np.array(found.rows[k]["vector"]) for k in (2, 4))
    turned = np.linalg.lstsq(np.stack([real, imaginary], 1), [[1.0, -zeta], [0.0, omega]], rcond=None)
    assert turned[2] == 2
    assert np.abs(found.rows[6]["vector"]).max() <= 1.0
    again = contwalk(
        "margins", "oscillator.yaml", "--no-figures", "--force", "--set", "margins.random={count: 1, seed: 7}"
    )
    assert again.code == 0
    assert read_margins("oscillator_margins.h5").rows[0]["border"] == found.rows[6]["border"]


def test_the_basin_of_a_well_is_where_its_energy_says(contwalk, folder):
    """Without damping a ball stays in its well where V(x) + v^2 / 2 < V(0), and passes x = 0 elsewhere."""
    prepared(folder, "well", start="right", free="tilt", range="[0, 0.1]", time=60)
    basin = "margins.basin={states: {x: [0.1, 1.7], v: [-0.9, 0.9]}, cells: 6, levels: 2}"
    done = contwalk("margins", "well.yaml", "--set", basin, "--set", "margins.survive={time: 40, returns: 3}")
    assert done.code == 0
    found = read_margins("well_margins.h5").basin
    x, v = found["places"].T
    energy = x**4 / 4.0 - x**2 / 2.0 + v**2 / 2.0
    sure = np.abs(energy) > 1e-6
    fallen = np.array(found["labels"]) == "fallen"
    np.testing.assert_array_equal(fallen[sure], energy[sure] > 0.0)
    assert set(found["labels"]) == {"fallen", "b1/0"}
    whole = [(folder / f"well_{name}").read_bytes() for name in ("margins.h5", "basin.csv", "basin.png")]
    again = ("--set", basin, "--set", "margins.survive={time: 40, returns: 3}", "--force", "--jobs", "2")
    assert contwalk("margins", "well.yaml", *again).code == 0
    assert [(folder / f"well_{n}").read_bytes() for n in ("margins.h5", "basin.csv", "basin.png")] == whole


def test_a_basin_whose_database_has_gained_a_solution_is_another_study(contwalk, folder, monkeypatch):
    """Motions of the first part would be `new1` that the second part calls `b2/0`."""
    import contwalk.workflow.margins as module

    prepared(folder, "well", start="right", free="tilt", range="[0, 0.1]", time=1)
    basin = "margins.basin={states: {x: [0.5, 1.5], v: [-0.1, 0.1]}, cells: 2, levels: 0}"
    computed, left = module.reached, [3]

    def stopped(study, push):
        left[0] -= 1
        if left[0] < 0:
            raise KeyboardInterrupt
        return computed(study, push)

    monkeypatch.setattr(module, "reached", stopped)
    assert contwalk("margins", "well.yaml", "--set", basin).code == 130
    monkeypatch.setattr(module, "reached", computed)
    both = ("--set", "start.equilibrium=both", "--force", "--no-figures", "--quiet")
    assert contwalk("continue", "well.yaml", *both).code == 0
    done = contwalk("margins", "well.yaml", "--set", basin, "--resume")
    assert done.code == 2
    assert "what differs: solutions known to the basin." in " ".join(done.err.split())
    assert contwalk("margins", "well.yaml", "--set", basin, "--force").code == 0


def test_two_processes_and_a_run_that_was_killed_leave_the_same_bytes(contwalk, oscillator):
    contwalk("margins", "oscillator.yaml", "--no-figures")
    files = [oscillator / f"oscillator_margins.{suffix}" for suffix in ("h5", "csv")]
    whole = [file.read_bytes() for file in files]
    assert contwalk("margins", "oscillator.yaml", "--no-figures", "--force", "--jobs", "2").code == 0
    assert [file.read_bytes() for file in files] == whole
    journal = oscillator / "oscillator_margins.journal"
    assert not journal.exists()


@pytest.mark.parametrize("elsewhere", [False, True])
def test_a_study_that_was_stopped_goes_on(contwalk, oscillator, monkeypatch, elsewhere):
    import contwalk.workflow.margins as module

    contwalk("margins", "oscillator.yaml", "--no-figures")
    file = oscillator / "oscillator_margins.h5"
    whole, computed = file.read_bytes(), module.row_of
    file.unlink()
    (oscillator / "oscillator_margins.csv").unlink()

    def stopped(study, ray):
        if ray.number == 2:
            raise KeyboardInterrupt
        return computed(study, ray)

    monkeypatch.setattr(module, "row_of", stopped)
    with monkeypatch.context() as patched:
        if elsewhere:
            patched.setattr(module, "versions_and_processor", lambda: {"processor": "another"})
        assert contwalk("margins", "oscillator.yaml", "--no-figures").code == 130
    again = contwalk("margins", "oscillator.yaml", "--no-figures")
    assert again.code == 2
    assert "--resume" in again.err

    def counted(study, ray):
        assert ray.number >= 2
        return computed(study, ray)

    monkeypatch.setattr(module, "row_of", counted)
    done = contwalk("margins", "oscillator.yaml", "--no-figures", "--resume")
    assert done.code == 0
    said = "note: What is stored was made elsewhere (processor another, now " in done.out.replace("\n", " ")
    assert said == elsewhere
    assert (file.read_bytes() == whole) == (not elsewhere)  # which keeps the note


def test_a_study_that_was_stopped_while_it_wrote_its_files_goes_on(contwalk, oscillator, monkeypatch):
    import contwalk.workflow.margins as module

    names = "oscillator_margins.h5", "oscillator_margins.csv"

    def stopped(rows, path):
        raise KeyboardInterrupt

    with monkeypatch.context() as patched:
        patched.setattr(module, "_write_table", stopped)
        assert contwalk("margins", "oscillator.yaml", "--no-figures").code == 130
    assert [(oscillator / name).exists() for name in names] == [True, False]
    assert contwalk("margins", "oscillator.yaml", "--no-figures").code == 2
    assert contwalk("margins", "oscillator.yaml", "--no-figures", "--resume").code == 0
    resumed = [(oscillator / name).read_bytes() for name in names]
    assert contwalk("margins", "oscillator.yaml", "--no-figures", "--force").code == 0
    assert [(oscillator / name).read_bytes() for name in names] == resumed


@pytest.mark.parametrize("kept", [0, 3])
def test_a_study_that_was_killed_while_it_wrote_a_row_goes_on(contwalk, oscillator, kept):
    """What the kill leaves: the rows before, and a part of the one that was being written."""
    contwalk("margins", "oscillator.yaml", "--no-figures")
    files = [oscillator / f"oscillator_margins.{suffix}" for suffix in ("h5", "csv")]
    whole, journal = [file.read_bytes() for file in files], oscillator / "oscillator_margins.journal"
    for file in files:
        file.unlink()
    ending = (
        "import os, sys\n"
        "from contwalk.storage.journal import Journal\n"
        "add, left = Journal.add, [int(sys.argv[1])]\n"
        "def adds(self, row):\n"
        "    if left[0] < 0:\n"
        "        self._file.write(b'00000000 {'); self._file.flush(); os.kill(os.getpid(), 9)\n"
        "    left[0] -= 1; add(self, row)\n"
        "Journal.add = adds\n"
        "from contwalk.cli.entry import run; run(('margins', 'oscillator.yaml', '--no-figures'))"
    )
    killed = subprocess.run([sys.executable, "-c", ending, str(kept)], cwd=oscillator, check=False)
    assert killed.returncode == -9
    assert len(journal.read_bytes().splitlines()) == kept + 2
    assert contwalk("margins", "oscillator.yaml", "--no-figures", "--resume").code == 0
    assert [file.read_bytes() for file in files] == whole
    assert not journal.exists()


def test_what_is_unstable_is_refused(contwalk, folder):
    """The saddle between the wells."""
    prepared(folder, "well", start="right", free="tilt", range="[0, 0.1]", time=20)
    text = (folder / "well.yaml").read_text(encoding="utf-8")
    (folder / "top.yaml").write_text(
        text.replace("{equilibrium: right}", "{state: {x: 0.0, v: 0.0}}").replace("well.h5", "top.h5"),
        encoding="utf-8",
    )
    assert contwalk("continue", "top.yaml", "--no-figures", "--quiet").code == 0
    done = contwalk("margins", "top.yaml")
    assert done.code == 2
    assert "b1/0 is unstable in 1 direction" in done.err


@pytest.mark.parametrize(
    ("change", "key", "said"),
    [
        ("margins.of.point=b1", "of.point", "a branch and a point"),
        ("margins.of.point=b1/-1", "of.point", "a branch and a point"),
        ("margins.of.point=b7/0", "of.point", "b7"),
        ("margins.of.point=b1/99", "of.point", "4 points, numbered from 0"),
        ("margins.of.point=b1/HB3", "of.point", "no special point 'HB3'"),
        ("margins.of.from=missing.h5", "of.from", "missing.h5"),
        ("margins.of.from=oscillator.py", "of.from", "not a contwalk database"),
        ("margins.of.from=.", "of.from", "a directory"),
        ("margins.states=[y]", "states", "not a state of 'oscillator'"),
        ("margins.states=[]", "states", "is empty"),
        ("margins.states=[x, v, x]", "states", "has x twice"),
        ("margins.instants=[0.1, 0.3, 0.1]", "instants", "has 0.1 twice"),
        ("margins.instants=0", "instants", "a whole number from 1 to 1000"),
        ("margins.instants=[0.5, 1.0]", "instants", "has 1."),
        ("margins.instants=[.nan]", "instants", "not finite"),
        ("margins.survive={periods: 3}", "survive", "which has no period"),
        ("margins.survive={periods: 3, time: 4}", "survive", "both periods and time"),
        ("margins.survive={periods: 0}", "survive.periods", "a positive number"),
        ("margins.accuracy=0", "accuracy", "from 1e-12 to 0.5"),
        ("margins.accuracy=2", "accuracy", "from 1e-12 to 0.5"),
        ("margins.directions={x: {v: 1}}", "directions.x", "the name of a state"),
        ("margins.directions={out: {y: 1}}", "directions.out.y", "not a state of 'oscillator'"),
        ("margins.directions={out: {x: 0}}", "directions.out", "pushes nothing"),
        ("margins.random={count: 0}", "random.count", "from 1 to 100000"),
        ("margins.basin={states: {x: [0, 1]}}", "basin.states", "names 1 states"),
        ("margins.basin={states: {x: [1, 0], v: [0, 1]}}", "basin.states.x", "is [1, 0]. Give"),
        ("margins.basin={states: {x: [0, 1], y: [0, 1]}}", "basin.states.y", "not a state"),
        ("margins.basin={states: {x: [0, 1], v: [0, 1]}, instant: 5}", "basin.instant", "there are 5"),
        ("margins.basin={states: {x: [0, 1], v: [0, 1]}, instant: 2}", "basin.instant", "at all instants"),
        ("margins.modes=3", "modes", "there are 2 eigenvalues"),
        ("margins.scan=-1", "scan", "a whole number from 0 up"),
        ("margins.farthest=0", "farthest", "a positive number"),
        ("margins.tolerance=0", "tolerance", "1e-14"),
        ("parameters.wall=2", "parameters.wall", "at b1/0 of oscillator.h5 it is 1"),
        ("parameters.walls=2", "parameters.walls", "not a parameter of 'oscillator'"),
    ],
)
def test_what_is_wrong_is_told_with_its_key_and_nothing_is_written(contwalk, oscillator, change, key, said):
    done = contwalk("margins", "oscillator.yaml", "--set", change)
    assert done.code == 2
    told = " ".join(done.err.split())
    assert said in told
    path = key if key.startswith("parameters") else f"margins.{key}"
    assert f"oscillator.yaml with --set {change}, key {path}:" in told
    assert not list(oscillator.glob("*_margins.*"))


def test_what_is_wrong_in_the_file_itself_is_told_with_its_line(contwalk, oscillator):
    lines = (oscillator / "oscillator.yaml").read_text(encoding="utf-8").splitlines()
    number = next(k for k, line in enumerate(lines, start=1) if "of: {" in line)
    done = contwalk("margins", "oscillator.yaml", "--set", "margins.accuracy=0.1", "--output", "other.h5")
    assert done.code == 0
    (oscillator / "oscillator.h5").unlink()
    done = contwalk("margins", "oscillator.yaml")
    assert done.code == 2
    assert f"oscillator.yaml, line {number}, key margins.of.from:" in " ".join(done.err.split())


def test_how_far_was_looked_without_a_border_is_told(contwalk, folder):
    """A ball in a well is not lost by pushes of v that do not carry it over the hill, 2^-1/2 high."""
    prepared(folder, "well", start="right", free="tilt", range="[0, 0.1]", time=5)
    done = contwalk("margins", "well.yaml", "--set", "margins.farthest=0.5", "--set", "margins.states=[v]")
    rows = read_margins("well_margins.h5").rows
    assert [(row["border"], row["farthest"]) for row in rows] == [(None, 0.5)] * 2
    assert "none to 0.5" in done.out


def test_a_push_that_is_hardly_forgotten_when_the_motion_survives_is_told(contwalk, oscillator):
    """exp(-zeta t) is 0.61 after 5 s, and the borders of what is never lost are as far."""
    done = contwalk("margins", "oscillator.yaml", "--no-figures", "--set", "margins.survive.time=5")
    assert done.code == 0
    assert "0.61 is left" in " ".join(done.out.split())
    done = contwalk("margins", "oscillator.yaml", "--no-figures", "--force")
    assert "is left" not in done.out


DRAW = """
def draw(axes, t, x, p):
    axes.plot([0.0, x[0]], [0.0, 1.0 / WHOLE])

SYSTEM = dataclasses.replace(SYSTEM, draw=draw)
"""


def test_margins_are_drawn_from_their_file_as_by_the_study(contwalk, oscillator):
    assert contwalk("margins", "oscillator.yaml").code == 0
    study, figure = oscillator / "oscillator_margins.png", oscillator / "again.png"
    again = contwalk("plot", "oscillator_margins.h5", "-o", "again.png", "--trust")
    assert (again.code, again.err) == (0, "")
    assert figure.read_bytes() == study.read_bytes()
    without = contwalk("plot", "oscillator_margins.h5", "-o", "again.png", "--force")
    assert without.code == 0
    assert "Not shown: the machine where it is pushed." in without.err
    for given, said in (
        (("oscillator_margins.h5", "--branch", "b1"), "Margins have no branches."),
        (("oscillator_margins.h5", "-x", "x"), "has no -x and -y"),
        (("oscillator.h5", "--kind", "margins"), "holds no margins: it is a database of branches."),
    ):
        refused = contwalk("plot", *given, "-o", "other.png")
        assert refused.code == 2
        assert said in refused.err
    assert not (oscillator / "other.png").exists()


@pytest.mark.parametrize(("whole", "notes"), [("1.0", 0), ("0.0", 1)])
def test_a_machine_that_cannot_be_drawn_is_told_beside_its_margins(contwalk, oscillator, whole, notes):
    plugin = oscillator / "oscillator.py"
    plugin.write_text(f"import dataclasses\n{plugin.read_text()}{DRAW.replace('WHOLE', whole)}")
    done = contwalk("margins", "oscillator.yaml")
    assert done.code == 0
    said = " ".join(done.out.split())
    assert said.count("The machine is not drawn above its margins.") == notes
    assert (oscillator / "oscillator_margins.png").exists()
