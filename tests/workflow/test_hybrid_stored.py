"""Stored hybrid orbits: `verify`, `show --json`, `export`, and starts of new runs from their points."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import jsonschema
import numpy as np
import pytest
from hybrid_invariants import check_hybrid_branch

from contwalk.branch import Branch
from contwalk.cli.entry import run as command
from contwalk.errors import ContwalkError
from contwalk.storage import interface_schema, open_database
from contwalk.system import load_system
from contwalk.workflow.run_file.reading import read_run_file
from contwalk.workflow.runner import run

SLOPE = Path(__file__).resolve().parents[2] / "runs" / "planar_slope.yaml"
# From the gait of Table I down to the fold and round it, and up to the first doubled gait.
RANGE = "continue.range=[0.03, 0.1]"
LATER = """
contwalk: 1
system: planar_walker
accuracy: 1e-9
start: {from: planar_slope.h5, point: POINT}
continue: {parameter: alpha, range: [0.03, 0.1], max_points: MOST}
diagram: none
events: {GR: ignore, AZ: ignore}
report_at: {event: heel_strike, side: before}
"""
# Walked points are solved for to a hundred times the accuracy.
WALKED = 1e-7


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("slope")
    run_file = read_run_file(SLOPE, (RANGE, "diagram.depth=1"), str(folder / "planar_slope.h5"))
    assert len(run(run_file, figures=False).branches) == 2
    return folder


def first(folder: Path) -> list[Branch]:
    with open_database(folder / "planar_slope.h5") as db:
        return list(db.branches())


def later(folder: Path, point: str, most: int = 12, extra: str = "") -> list[Branch]:
    name = point.replace("/", "_")
    (folder / f"{name}.yaml").write_text(LATER.replace("POINT", point).replace("MOST", str(most)) + extra)
    run_file = read_run_file(folder / f"{name}.yaml", (), str(folder / f"{name}.h5"))
    return run(run_file, figures=False, force=True).branches


class TestRestarts:
    @pytest.mark.long
    def test_at_the_fold(self, folder):
        """The branch goes both ways from the fold, and finds it again."""
        fold = first(folder)[0].special("LP1")
        (branch,) = later(folder, "b1/LP1", most=60)
        assert branch.info.problem == "hybrid_orbit"
        assert branch.info.closure == "legs"
        assert branch.info.signature == ("heel_strike", "knee_strike")
        found = [p for p in branch.special_points if p.label == "LP"]
        assert len(found) == 1
        off = abs(found[0].parameters["alpha"] - fold.parameters["alpha"])
        assert off <= found[0].error + fold.error
        # Both sides of the fold: faster and slower gaits at one slope.
        assert branch["period"].max() > found[0].period > branch["period"].min()
        assert set(branch["unstable"][~branch["special"]]) == {0, 1}
        at_fold = np.arange(len(branch)) == found[0].index
        check_hybrid_branch(branch, load_system("planar_walker"), chosen=at_fold)

    @pytest.mark.drawn(1)
    @pytest.mark.parametrize("point", ["b1/GR2", "b1/AZ2", "b1/PD1", "b1/20"])
    def test_at_other_points(self, folder, point):
        parent = first(folder)[0]
        name = point.split("/")[1]
        index = int(name) if name.isdigit() else parent.special(name).index
        (branch,) = later(folder, point)
        (row,) = branch.points[branch["s"] == 0.0]
        assert row["free"][0] == pytest.approx(float(parent["alpha"][index]), rel=WALKED)
        np.testing.assert_allclose(row["state"], parent.points["state"][index], rtol=0, atol=100.0 * WALKED)
        assert row["period"] == pytest.approx(float(parent["period"][index]), rel=WALKED)
        assert branch.outcome.status != "failed"
        assert len(branch) > 5

    def test_at_a_terminal_grazing(self, folder):
        """No orbit beyond it is the walker's, GR: ignore or not: the branch goes one way only."""
        grazing = first(folder)[0].special("GR1")
        assert grazing.kind == "terminal"
        (branch,) = later(folder, "b1/GR1", most=20)
        assert branch["period"].max() <= grazing.period * (1.0 + WALKED)

    @pytest.mark.long
    def test_of_a_doubled_gait(self, folder):
        doubled = first(folder)[1]
        index = int(np.argmax(doubled["alpha"]))
        (branch,) = later(folder, f"b2/{index}")
        assert branch.info.signature == ("heel_strike", "knee_strike") * 2
        assert branch.info.closure == "full"
        (row,) = branch.points[branch["s"] == 0.0]
        assert row["period"] == pytest.approx(float(doubled["period"][index]), rel=WALKED)

    @pytest.mark.long
    def test_along_another_parameter(self, folder):
        """From the gait of Table I, over the radius of the feet."""
        parent = first(folder)[0]
        index = int(np.flatnonzero(parent["alpha"] == 0.09)[0])
        text = (
            LATER.replace("POINT", f"b1/{index}")
            .replace("MOST", "12")
            .replace("alpha, range: [0.03, 0.1]", "rf, range: [0.1, 0.13]")
        )
        (folder / "feet.yaml").write_text(text)
        (branch,) = run(
            read_run_file(folder / "feet.yaml", (), str(folder / "feet.h5")), figures=False, force=True
        ).branches
        (row,) = branch.points[branch["s"] == 0.0]
        assert row["free"][0] == 0.12
        assert branch.info.parameters["alpha"] == 0.09
        np.testing.assert_allclose(row["state"], parent.points["state"][index], rtol=0, atol=100.0 * WALKED)
        assert branch.outcome.status != "failed"

    def test_of_a_point_that_is_not_there(self, folder):
        with pytest.raises(ContwalkError, match=r"LP7|Known|LP1"):
            later(folder, "b1/LP7")


class TestShown:
    def test_json(self, folder, capsys):
        assert command(["show", str(folder / "planar_slope.h5"), "--json", "--points"]) == 0
        shown = json.loads(capsys.readouterr().out)
        jsonschema.validate(shown, interface_schema())
        one, two = shown["branches"]
        stored = first(folder)
        assert (one["problem"], one["closure"], one["signature"]) == (
            "hybrid_orbit",
            "legs",
            ["heel_strike", "knee_strike"],
        )
        assert (two["parent"], two["closure"], two["subharmonic"]) == ("b1/PD1", "full", 1)
        for branch, own in zip(shown["branches"], stored, strict=True):
            assert branch["n_points"] == len(branch["points"]) == len(own)
            for point, record in zip(branch["special_points"], own.special_points, strict=True):
                assert point["name"] == record.name
                assert point["kind"] == record.kind
                assert point["period_full"] == (2.0 if branch is one else 1.0) * point["period"]
                assert point["margin"] == dict(record.margin)
                assert point["admissible"] == record.admissible
            for point, row in zip(branch["points"], own.points, strict=True):
                assert point["admissible"] == bool(row["admissible"])
                assert point["free"] == [float(row["free"][0])]

    @pytest.mark.parametrize("point", ["b1", "b1/LP1", "b1/GR1", "b1/AZ1", "b1/PD1", "b2/5"])
    def test_pages(self, folder, capsys, point):
        assert command(["show", str(folder / "planar_slope.h5"), point]) == 0
        said = capsys.readouterr()
        assert said.err == ""
        assert "alpha" in said.out

    def test_export(self, folder, capsys):
        assert command(["export", str(folder / "planar_slope.h5"), "--csv", str(folder / "tables")]) == 0
        capsys.readouterr()
        own = first(folder)
        with (folder / "tables" / "special_points.csv").open() as file:
            rows = list(csv.DictReader(file))
        assert len(rows) == sum(len(b.special_points) for b in own)
        assert {row["label"] for row in rows} >= {"LP", "PD", "GR", "AZ", "EP"}
        with (folder / "tables" / "b1.csv").open() as file:
            rows = list(csv.DictReader(file))
        assert [float(row["alpha"]) for row in rows] == own[0]["alpha"].tolist()
        assert [float(row["hind_dip"]) for row in rows] == own[0]["hind_dip"].tolist()
        assert {row["admissible"] for row in rows} <= {"True", "False", "true", "false", "1", "0"}


def test_verify(folder, capsys):
    """Every special point computed anew, fold, doublings, grazings and conditions."""
    assert command(["verify", str(folder / "planar_slope.h5"), "--json"]) == 0
    shown = json.loads(capsys.readouterr().out)
    assert shown["agree"]
    verdicts = {f"{entry['branch']}/{entry['point']}": entry["verdict"] for entry in shown["points"]}
    for branch in first(folder):
        for point in branch.special_points:
            if point.label != "EP":
                assert verdicts[f"{branch.name}/{point.name}"] == "AGREES"
