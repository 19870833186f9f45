"""The tutorials and the plugin page: every block runs as written and gives what the text says."""

from __future__ import annotations

import csv
import json
import math
import re
from itertools import pairwise

import numpy as np
import pytest
from code_blocks import ROOT, blocks, commands, run_command, run_python

import contwalk as cw
from contwalk.system import load_system

pytestmark = pytest.mark.slow

TUTORIAL = "docs/tutorials/first_plugin.md"
ORBITS = "docs/tutorials/first_orbit.md"
PLUGINS = "docs/reference/plugin.md"
# Closed form: T = k X with k = B / (1 + beta) and Da = X / (1 - X) exp(-k X); folds where X (1 - X) = 1 / k,
# the Hopf point where 1 / (1 - X) + 1 + beta = B X. Evaluated with 40 digits.
POINTS = {"LP1": 0.10573897827165065101, "LP2": 0.088931846185772802594, "HB1": 0.13090004482004332464}


@pytest.fixture(scope="module")
def tutorial(tmp_path_factory):
    """The tutorial's directory after all its commands, and their outputs."""
    where = tmp_path_factory.mktemp("tutorial")
    (where / "stirred_tank.py").write_text(blocks(TUTORIAL, "python")[0], encoding="utf-8")
    (where / "ignition.yaml").write_text(blocks(TUTORIAL, "yaml")[0], encoding="utf-8")
    return where, {line: run_command(line, where) for line in commands(TUTORIAL)}


def test_check_finds_nothing_wrong(tutorial):
    _, outputs = tutorial
    assert "0 warnings, 0 errors" in outputs["contwalk systems check stirred_tank.py"]


def test_points_are_those_of_the_table(tutorial):
    where, _ = tutorial
    shown = json.loads(run_command("contwalk show ignition.h5 --json", where))
    found = {p["name"]: p for p in shown["branches"][0]["special_points"] if p["label"] != "EP"}
    assert set(found) == set(POINTS)
    text = (ROOT / TUTORIAL).read_text(encoding="utf-8")
    for name, value in POINTS.items():
        # the claimed error, plus the rounding of the value written here
        assert abs(found[name]["parameters"]["Da"] - value) <= found[name]["error"] + 2e-17
        row = re.search(rf"\| {name} \| ([0-9.]+) \| (\d) → (\d) \|", text)
        assert f"{value:.12g}".rstrip("0") == row[1].rstrip("0")
        assert (found[name]["unstable_before"], found[name]["unstable_after"]) == (int(row[2]), int(row[3]))


def test_the_pulsation_is_what_the_text_says(tutorial):
    where, _ = tutorial
    cycle = cw.open_database(where / "ignition.h5")["b2"]
    assert cycle.outcome.reason == "homoclinic"
    assert (cycle["stable"][~cycle["special"]] == 1).all()
    # the period at a Hopf point is 2 pi / omega; the text has three digits
    assert 2.0 * math.pi / 4.0077 == pytest.approx(1.57, abs=5e-3)
    assert cycle["period"].min() == pytest.approx(1.57, abs=5e-3)
    assert cycle["period"].max() > 30.0
    # the homoclinic orbit, to the digits of the text, a little below LP1
    assert cycle["Da"].min() == pytest.approx(0.105507, abs=5e-7)
    assert cycle["Da"].min() < POINTS["LP1"]


def test_more_cooling_does_what_the_text_says(tutorial):
    where, _ = tutorial
    database = cw.open_database(where / "cooled.h5")
    assert database.branch_names() == ["b1", "b2"]  # from the other Hopf point it would be the same family
    branch, cycle = database["b1"], database["b2"]
    found = [(p.label, round(p.parameters["Da"], 3), p.criticality) for p in branch.special_points]
    assert [f for f in found if f[0] != "EP"] == [
        ("HB", 0.165, "subcritical"),
        ("HB", 0.337, "supercritical"),
    ]
    (fold,) = [p for p in cycle.special_points if p.label != "EP"]
    assert (fold.label, round(fold.parameters["Da"], 4)) == ("LP", 0.1617)
    assert (fold.unstable_before, fold.unstable_after) == (1, 0)
    assert cycle.outcome.reason == "shrunk"


def test_every_file_the_tutorial_names_is_there(tutorial):
    where, _ = tutorial
    for name in ("ignition_bifurcation_diagram.png", "temperature.png", "eigenvalues.png", "cooled.h5"):
        assert (where / name).stat().st_size > 0
    assert list((where / "tables").glob("*.csv"))


def test_python_version_gives_the_same_points(tutorial):
    where, _ = tutorial
    output = run_python(blocks(TUTORIAL, "python")[1], where)
    for name, value in POINTS.items():
        printed = re.search(rf"^{name} (\S+) (\S+)", output, re.MULTILINE)
        # the claimed error, plus the rounding of the value written here
        assert abs(float(printed[1]) - value) <= float(printed[2]) + 2e-17


def test_mistake_that_the_tutorial_suggests_is_told(tutorial, tmp_path):
    text = blocks(TUTORIAL, "python")[0].replace("dx[TEMPERATURE] =", "dx[CONVERSION] =")
    (tmp_path / "stirred_tank.py").write_text(text, encoding="utf-8")
    with pytest.raises(AssertionError, match=r"does not write dx\[1\]"):
        run_command("contwalk systems check stirred_tank.py", tmp_path)


@pytest.fixture(scope="module")
def orbits(tmp_path_factory):
    """The directory of the tutorial on cycles after all its commands, and their outputs."""
    where = tmp_path_factory.mktemp("orbits")
    (where / "glycolysis.py").write_text(blocks(ORBITS, "python")[0], encoding="utf-8")
    for name, text in zip(("beats", "watch", "settled"), blocks(ORBITS, "yaml"), strict=True):
        (where / f"{name}.yaml").write_text(text, encoding="utf-8")
    return where, {line: run_command(line, where) for line in commands(ORBITS)}


def test_check_finds_nothing_wrong_with_the_yeast(orbits):
    _, outputs = orbits
    assert "0 warnings, 0 errors" in outputs["contwalk systems check glycolysis.py"]


def test_hopf_points_of_the_yeast_are_those_of_the_table(orbits):
    where, _ = orbits
    steady = cw.open_database(where / "beats.h5")["b1"]
    text = (ROOT / ORBITS).read_text(encoding="utf-8")
    # closed form: b^4 + (2 a - 1) b^2 + a + a^2 = 0 for a = 0.08
    for name, value, counts in (("HB1", math.sqrt(0.12), (0, 2)), ("HB2", math.sqrt(0.72), (2, 0))):
        point = steady.special(name)
        # the claimed error, plus what the rounding of a = 0.08 does
        assert abs(point.parameters["b"] - value) <= point.error + 4e-16
        assert (point.unstable_before, point.unstable_after) == counts
        assert point.criticality == "supercritical"
        assert f"| {name} | {value:.12f} | {counts[0]} → {counts[1]} |" in text


def test_the_family_of_cycles_joins_both_hopf_points(orbits):
    where, _ = orbits
    database = cw.open_database(where / "beats.h5")
    assert database.branch_names() == ["b1", "b2"]  # from HB2 it would be the same family
    cycles = database["b2"]
    assert [p.label for p in cycles.special_points if p.label != "EP"] == ["UZ"]
    assert (cycles["stable"][~cycles["special"]] == 1).all()
    assert cycles.outcome.reason == "shrunk"
    assert cycles.outcome.message.startswith(
        "The orbit shrinks onto an equilibrium, at a Hopf point near b = 0.84"
    )
    assert cycles["b"].min() == pytest.approx(math.sqrt(0.12), abs=1e-6)
    # the last orbit is at most a step, a 64th of the range, before the other one
    assert cycles["b"].max() == pytest.approx(math.sqrt(0.72), abs=0.8 / 64)


def test_the_motion_settles_on_the_cycle_as_the_text_says(orbits):
    where, outputs = orbits
    cycles = cw.open_database(where / "beats.h5")["b2"]
    point = cycles.special("UZ1")
    text = (ROOT / ORBITS).read_text(encoding="utf-8")
    assert f"`period: {point.period:.10f}`" in text
    assert "period: 9.62260777" in outputs["contwalk show beats.h5 b2/UZ1"]
    (multiplier,) = point.spectrum
    assert f"*multiplier* {multiplier.real:.7f}" in text
    with (where / "watch_events.csv").open(encoding="utf-8") as file:
        times = [float(row["t"]) for row in csv.DictReader(file)]
    off = [b - a - point.period for a, b in pairwise(times)]
    # what is left shrinks by the multiplier, up to the square of what is left and the motion's 1e-10
    for before, after in pairwise(off[5:]):
        assert after / before == pytest.approx(multiplier.real, rel=3e-3)
    for row in range(6, 10):
        known = re.search(rf"\| {row} \| {row + 1} \| ([0-9.]+) \| (\S+) \|", text)
        assert f"{off[row - 1] + point.period:.8f}" == known[1]
        assert off[row - 1] == pytest.approx(float(known[2]), rel=0.02)  # two digits are given


def test_a_settled_motion_begins_the_branch(orbits):
    where, _ = orbits
    (branch,) = cw.open_database(where / "settled.h5").branches()
    assert branch.info.problem == "periodic_orbit"
    assert (branch["b"].min(), branch["b"].max()) == (0.5, 0.7)
    # the start is the cycle on b2 of the other run, to the accuracy of steps along a branch
    cycles = cw.open_database(where / "beats.h5")["b2"]
    (start,) = branch["period"][branch["s"] == 0.0]
    assert start == pytest.approx(cycles.special("UZ1").period, rel=1e-6)


def test_every_file_the_tutorial_on_cycles_names_is_there(orbits):
    where, outputs = orbits
    names = re.findall(r"`(\w+\.(?:png|csv))`", (ROOT / ORBITS).read_text(encoding="utf-8"))
    assert len(names) >= 4
    for name in [*names, "cycle.png", "multipliers.png"]:
        assert (where / name).stat().st_size > 0
    assert re.search(r"^(\d+) of \1 numbers agree", outputs["contwalk verify beats.h5 --trust"], re.MULTILINE)


def test_python_version_of_the_tutorial_on_cycles(orbits):
    where, _ = orbits
    output = run_python(blocks(ORBITS, "python")[1], where)
    # at the Hopf point the period is 2 pi / sqrt(a + b^2); within the range it falls
    low, high = map(float, re.search(r"periods from (\S+) to (\S+)", output).groups())
    assert high == pytest.approx(2.0 * math.pi / math.sqrt(0.2), rel=1e-3)
    assert low < 9.0
    assert "stable: True closed up to: full" in output


@pytest.mark.parametrize("number", range(1, len(blocks(PLUGINS, "python"))))
def test_plugins_of_the_reference_pass_the_check(number, tmp_path):
    (tmp_path / "plugin.py").write_text(blocks(PLUGINS, "python")[number], encoding="utf-8")
    assert "0 errors" in run_command("contwalk systems check plugin.py", tmp_path)


def test_imports_of_the_reference(tmp_path):
    run_python(blocks(PLUGINS, "python")[0], tmp_path)


def test_bead_on_a_hoop_has_its_pitchfork(tmp_path):
    (bead,) = [text for text in blocks(PLUGINS, "python") if 'name="bead"' in text]
    (tmp_path / "bead.py").write_text(bead, encoding="utf-8")
    system = load_system("bead.py", base=tmp_path)
    problem = cw.Equilibrium(system, system.defaults(), free="omega")
    branch = cw.continue_branch(problem, "lowest", range=(0.5, 6.0))
    (point,) = [p for p in branch.special_points if p.label == "BP"]
    # closed form: omega^2 = g / radius
    assert abs(point.parameters["omega"] - 9.81**0.5) <= 2.0 * point.error
    assert point.criticality == "supercritical"


def test_the_trampoline_throws_once_in_a_period(tmp_path):
    (text,) = [text for text in blocks(PLUGINS, "python") if 'name="trampoline"' in text]
    (tmp_path / "trampoline.py").write_text(text, encoding="utf-8")
    study = """
contwalk: 1
system: ./trampoline.py
start: {simulate: {state: {ball: 0.3, speed: 0.0}, until: settled}}
continue: {parameter: drive, range: [25, 125], direction: backward}
output: trampoline.h5
"""
    (tmp_path / "trampoline.yaml").write_text(study, encoding="utf-8")
    run_command("contwalk continue trampoline.yaml", tmp_path)
    (branch,) = cw.open_database(tmp_path / "trampoline.h5").branches()
    assert set(branch.info.signature) == {"landing", "takeoff"}
    # two modes of two states each, and time: two multipliers
    assert branch.info.spectrum == 2
    assert [p.label for p in branch.special_points if p.label != "EP"] == ["LP"]


def test_family_of_the_reference_builds_each_machine(tmp_path):
    (chain,) = [text for text in blocks(PLUGINS, "python") if 'name="chain"' in text]
    (tmp_path / "chain.py").write_text(chain, encoding="utf-8")
    for links in (1, 5):
        assert len(load_system("chain.py", {"links": links}, base=tmp_path).states) == links


# -- a machine that hits something -------------------------------------------------------------------------

IMPACTS = "docs/tutorials/impact_oscillator.md"


@pytest.fixture(scope="module")
def hammer(tmp_path_factory):
    """The tutorial's directory after all its commands, and their outputs."""
    where = tmp_path_factory.mktemp("hammer")
    (where / "hammer.py").write_text(blocks(IMPACTS, "python")[0], encoding="utf-8")
    for name, text in zip(("knock", "graze"), blocks(IMPACTS, "yaml"), strict=True):
        (where / f"{name}.yaml").write_text(text, encoding="utf-8")
    return where, {line: run_command(line, where) for line in commands(IMPACTS)}


def test_the_hammer_is_checked_and_knocks(hammer):
    where, outputs = hammer
    assert "0 warnings, 0 errors" in outputs["contwalk systems check hammer.py"]
    with (where / "knock_events.csv").open(encoding="utf-8", newline="") as file:
        times = [float(row["t"]) for row in csv.DictReader(file)]
    assert len(times) == 12
    # once in a period, to what the transient has left after eight of them
    assert times[-1] - times[-2] == pytest.approx(2.0 * math.pi / 1.3, abs=2e-3)


def test_the_grazing_is_where_the_closed_form_has_it(hammer):
    where, outputs = hammer
    silent, hammering = cw.open_database(where / "graze.h5").branches()
    exact = math.sqrt((1.0 - 1.3**2) ** 2 + (2.0 * 0.1 * 1.3) ** 2)
    graze = silent.special("GR1")
    assert abs(graze.parameters["force"] - exact) <= graze.error + 2e-16
    assert (graze.kind, silent.outcome.reason) == ("interior", "grazing")
    assert "[impact] leave there" in silent.outcome.message
    assert "0.737360156233" in outputs["contwalk continue graze.yaml"]
    assert hammering.info.signature == ("impact",)
    assert hammering.info.parent[0] == silent.name


def test_the_hammering_is_what_the_text_says(hammer):
    where, _ = hammer
    _, hammering = cw.open_database(where / "graze.h5").branches()
    text = (ROOT / IMPACTS).read_text(encoding="utf-8")
    for name in ("LP1", "AZ1"):
        assert f"{hammering.special(name).parameters['force']:.12g}" in text
    fold = hammering.special("LP1")
    assert (fold.unstable_before, fold.unstable_after) == (1, 0)
    assert fold.state["speed"] == pytest.approx(0.87163, abs=5e-6)
    # the product of the multipliers, to their own rounding, away from where the first is infinite
    product = np.prod(hammering.points["spectrum"][5:], axis=1)
    assert np.all(product.imag == 0.0)
    assert product.real == pytest.approx(0.64 * math.exp(-0.2 * 2.0 * math.pi / 1.3), rel=1e-8)
    beyond = hammering["force"] > hammering.special("AZ1").parameters["force"] + 1e-9
    stable = hammering["stable"] == 1
    assert not hammering.points["admissible"][beyond & stable].any()
    assert hammering.points["admissible"][~beyond & stable].all()


def test_from_the_other_side_the_grazing_is_terminal(hammer):
    where, _ = hammer
    hammering, silent = cw.open_database(where / "back.h5").branches()
    exact = math.sqrt((1.0 - 1.3**2) ** 2 + (2.0 * 0.1 * 1.3) ** 2)
    graze = hammering.special("GR1")
    assert abs(graze.parameters["force"] - exact) <= graze.error + 2e-16
    assert graze.kind == "terminal"
    assert silent.info.signature == ()
    assert (silent["stable"] == 1).all()
