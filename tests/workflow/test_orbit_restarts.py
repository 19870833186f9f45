"""Stored orbits: starts of new runs, `contwalk show --json`, `contwalk export`."""

import csv
import json
from pathlib import Path

import jsonschema
import numpy as np
import pytest

from contwalk.cli.entry import run as command
from contwalk.errors import ContwalkError
from contwalk.storage import interface_schema, open_database
from contwalk.workflow.run_file.reading import read_run_file
from contwalk.workflow.runner import run

PLUGIN = """
from contwalk.system import Mode, Observable, Parameter, State, System

def field(t, x, p, dx):
    g = (p.lam - 0.3) ** 2 - 0.01
    square, q = x[0] ** 2 + x[1] ** 2, x[2] ** 2 + x[3] ** 2
    mean, spread = 0.5 * (g - 1.0) - q, 0.5 * (g + 1.0)
    dx[0] = p.size * x[0] - x[1] - x[0] * square / p.size
    dx[1] = x[0] + p.size * x[1] - x[1] * square / p.size
    dx[2] = mean * x[2] + spread * (x[0] * x[2] + x[1] * x[3]) - 0.5 * x[3]
    dx[3] = mean * x[3] + spread * (x[1] * x[2] - x[0] * x[3]) + 0.5 * x[2]

SYSTEM = System(
    name="strip",
    states=(State("x"), State("y"), State("u"), State("v")),
    parameters=(Parameter("lam", 0.3), Parameter("size", 1.0)),
    modes=(Mode("smooth", field),),
    observables=(Observable("lift", lambda t, x, p: abs(x[:, 2]).max()),),
)
"""
# The cycle of radius 1 loses its stability at lam = 0.2 and 0.4, where the doubled one is born.
FIRST = """
contwalk: 1
system: ./strip.py
start: {simulate: {state: {x: 0.5, y: 0.1, u: 0.0, v: 0.0}, until: settled}}
continue: {parameter: lam, range: [0.1, 0.5]}
diagram: {follow: [PD], depth: 1}
mark: {lam: [0.35]}
"""
LATER = """
contwalk: 1
system: ./strip.py
start: {from: first.h5, point: POINT}
continue: {parameter: lam, range: [0.05, 0.55]}
diagram: none
"""
# Points of a walk are this well known at the default accuracy of 1e-8: 100 of it a step, ten steps a period.
WALKED = 1e-5


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("strip")
    (folder / "strip.py").write_text(PLUGIN)
    (folder / "first.yaml").write_text(FIRST)
    run(read_run_file(folder / "first.yaml", output=str(folder / "first.h5")), figures=False)
    return folder


def later(folder: Path, point: str, *overrides: str):
    """The branches of a run that starts at a stored point."""
    (folder / "later.yaml").write_text(LATER.replace("POINT", point))
    run_file = read_run_file(folder / "later.yaml", overrides, output=str(folder / "later.h5"))
    return run(run_file, figures=False, force=True).branches


def first(folder: Path):
    with open_database(folder / "first.h5") as db:
        return db.branches()


def test_the_first_run_has_two_doublings_and_their_branches(folder):
    cycle, *doubled = first(folder)
    points = [p for p in cycle.special_points if p.label == "PD"]
    assert [p.parameters["lam"] for p in points] == pytest.approx([0.2, 0.4], rel=1e-8)
    assert len(doubled) == 2
    for branch in doubled:
        regular = ~branch["special"] & (branch["s"] > 0.0)
        # 2 q^2 = g + ..: the lift grows from zero at the doubling; the period is twice that of the cycle.
        assert branch["period"][regular] == pytest.approx(4.0 * np.pi, rel=WALKED)
        assert np.all(branch["lift"][regular] > 0.0)


@pytest.mark.drawn(1)
@pytest.mark.parametrize("row", [0, 5, -1])
def test_a_plain_row_of_a_cycle_continues_the_cycle(folder, row):
    cycle = first(folder)[0]
    (branch,) = later(folder, f"b1/{row % len(cycle)}")
    assert branch.info.problem == "periodic_orbit"
    assert branch.outcome.reason == "bound"
    assert branch["lam"].min() == 0.05
    assert branch["lam"].max() == 0.55
    assert branch["period"] == pytest.approx(2.0 * np.pi, rel=WALKED)
    assert np.all(branch["lift"] <= WALKED)
    points = [p for p in branch.special_points if p.label not in ("EP", "UZ")]
    assert [(p.label, p.status) for p in points] == [("PD", "located")] * 2
    assert [p.parameters["lam"] for p in points] == pytest.approx([0.2, 0.4], rel=1e-8)


@pytest.mark.drawn(1)
@pytest.mark.parametrize("row", [3, -2, -1])
def test_a_plain_row_of_a_doubled_orbit_continues_the_doubled_orbit(folder, row):
    doubled = first(folder)[1]
    stored = doubled.points[row]
    (branch,) = later(folder, f"{doubled.name}/{row % len(doubled)}")
    assert branch.info.problem == "periodic_orbit"
    start = branch.points[branch["s"] == 0.0][0]
    assert start["free"][0] == stored["free"][0]
    assert start["period"] == pytest.approx(stored["period"], rel=WALKED)
    assert start["period"] == pytest.approx(4.0 * np.pi, rel=WALKED)
    assert branch["lift"][branch["s"] == 0.0][0] == pytest.approx(doubled["lift"][row], rel=1e-3)
    assert branch["unstable"][branch["s"] == 0.0][0] == stored["unstable"]


@pytest.mark.drawn(1)
@pytest.mark.parametrize("point", ["PD1", "PD2"])
def test_a_period_doubling_is_a_start(folder, point):
    """The orbit of the parent, which is special itself: found on the way back, as at equilibria."""
    cycle = first(folder)[0]
    (branch,) = later(folder, f"b1/{point}")
    assert branch.outcome.reason == "bound"
    assert branch["period"] == pytest.approx(2.0 * np.pi, rel=WALKED)
    points = [p for p in branch.special_points if p.label not in ("EP", "UZ")]
    assert [(p.label, p.status) for p in points] == [("PD", "located")] * 2
    for found, expected in zip(points, [p for p in cycle.special_points if p.label == "PD"], strict=True):
        assert found.parameters["lam"] == pytest.approx(expected.parameters["lam"], rel=1e-8)
        assert (found.unstable_before, found.unstable_after) == (
            expected.unstable_before,
            expected.unstable_after,
        )


def test_marks_and_end_points_are_starts(folder):
    for point in ("UZ1", "EP1", "EP2"):
        (branch,) = later(folder, f"b1/{point}")
        assert branch.outcome.reason == "bound"
        assert branch["period"] == pytest.approx(2.0 * np.pi, rel=WALKED)


def test_another_parameter_may_be_continued_from_it(folder):
    (branch,) = later(folder, "b1/UZ1", "continue={parameter: size, range: [0.5, 1.5]}")
    assert branch.outcome.reason == "bound"
    assert branch.info.parameters["lam"] == 0.35
    # The radius is `size`.
    assert np.hypot(branch["x"], branch["y"]) == pytest.approx(branch["size"], rel=WALKED)


@pytest.mark.parametrize("point", ["b1/9999", "b9/PD1", "b1/PD7"])
def test_a_point_that_is_not_there_is_refused(folder, point):
    with pytest.raises(ContwalkError) as caught:
        later(folder, point)
    assert "Traceback" not in str(caught.value)
    assert "first.h5" in str(caught.value)


def test_show_obeys_the_schema_and_tells_the_orbits(folder, capsys):
    assert command(["show", str(folder / "first.h5"), "--json", "--points"]) == 0
    text = capsys.readouterr().out
    document = json.loads(text)
    jsonschema.validate(document, interface_schema())
    assert "NaN" not in text
    assert {branch["problem"] for branch in document["branches"]} == {"periodic_orbit"}
    stored = [p for p in first(folder)[0].special_points if p.label == "PD"]
    shown = [p for p in document["branches"][0]["special_points"] if p["label"] == "PD"]
    assert [p["parameters"]["lam"] for p in shown] == [p.parameters["lam"] for p in stored]
    assert [p["period"] for p in shown] == [p.period for p in stored]


@pytest.mark.parametrize("point", ["b1", "b1/PD1", "b2/3"])
def test_show_of_a_branch_or_a_point(folder, point, capsys):
    assert command(["show", str(folder / "first.h5"), point]) == 0
    text = capsys.readouterr().out
    assert "period" in text.lower()
    assert "nan" not in text.lower().split()


def test_export_writes_all_points_of_orbits(folder, tmp_path, capsys):
    assert command(["export", str(folder / "first.h5"), "--csv", str(tmp_path / "tables")]) == 0
    branches = first(folder)
    names = {"branches.csv", "special_points.csv", *(f"{branch.name}.csv" for branch in branches)}
    assert {path.name for path in (tmp_path / "tables").iterdir()} == names
    for branch in branches:
        with (tmp_path / "tables" / f"{branch.name}.csv").open() as stream:
            rows = list(csv.DictReader(stream))
        assert len(rows) == len(branch)
        for column in ("lam", "period", "lift", "x", "u"):
            assert [float(row[column]) for row in rows] == branch[column].tolist()
    with (tmp_path / "tables" / "special_points.csv").open() as stream:
        rows = list(csv.DictReader(stream))
    assert len(rows) == sum(len(branch.special_points) for branch in branches)
