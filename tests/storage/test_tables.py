"""Tables, over both databases."""

import csv
import json
import sys
from types import SimpleNamespace

import pytest

from contwalk.branch import Outcome
from contwalk.errors import ContwalkError, DatabaseError
from contwalk.storage import write_tables


@pytest.fixture
def run(db, make_info, make_row, make_special):
    info = make_info(states=("q1", "period"), observables=("max_re", "delta"))
    db.start_branch(info)
    for s in (0.0, 0.2, -0.1):
        db.append("b1", make_row(info, s, special=s == 0.2))
    db.append_special("b1", make_special("HB", 0.2))
    db.append_special("b1", make_special("UZ", 0.2, kind="parameter"))
    message = 'Stopped, "here".\nTry --resume.'
    db.finish("b1", Outcome("stopped", "stop_at", message), {"seconds": 0.5, "rhs": 10})
    return db


def read(path):
    with path.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def test_tables(run, tmp_path):
    directory = tmp_path / "new" / "tables"
    written = write_tables(run, directory)
    assert sorted(path.name for path in written) == ["b1.csv", "branches.csv", "special_points.csv"]
    assert sorted(directory.iterdir()) == sorted(written)

    points = read(directory / "b1.csv")
    branch = run.branch("b1")
    assert [float(row["s"]) for row in points] == [-0.1, 0.0, 0.2]
    assert [row["special_point"] for row in points] == ["", "", "HB1 UZ1"]
    # read back exactly, and under names of their own where names collide
    assert [float(row["delta"]) for row in points] == branch["delta"].tolist()
    assert [float(row["q1"]) for row in points] == branch["q1"].tolist()
    assert [float(row["state_period"]) for row in points] == branch.points["state"][:, 1].tolist()
    assert [float(row["observables_delta"]) for row in points] == branch.points["observables"][:, 1].tolist()
    assert [float(row["re_2"]) for row in points] == branch.points["spectrum"][:, 1].real.tolist()
    assert points[0]["period"] == "nan"
    assert [row["special"] for row in points] == ["false", "false", "true"]

    (entry,) = read(directory / "branches.csv")
    assert entry["message"] == 'Stopped, "here".\nTry --resume.'
    assert (entry["free"], entry["n_points"], entry["seconds"], entry["rhs"]) == ("delta", "3", "0.5", "10")
    first, second = read(directory / "special_points.csv")
    assert (first["branch"], first["name"], second["name"], second["kind"]) == (
        "b1",
        "HB1",
        "UZ1",
        "parameter",
    )
    assert float(first["parameters.omega"]) == 5.0
    assert float(first["state.q2"]) == -0.2
    assert json.loads(first["spectrum"]) == [[0.0, 5.0], ["nan", "-inf"]]
    assert first["index"] == "2"


def test_tables_of_an_empty_run(db, tmp_path):
    write_tables(db, tmp_path)
    assert read(tmp_path / "branches.csv") == []


def test_directory_that_cannot_be_made(run, tmp_path):
    (tmp_path / "file").write_text("x")
    with pytest.raises(DatabaseError, match="is a file: tables are written into a directory"):
        write_tables(run, tmp_path / "file")
    (tmp_path / "out" / "b1.csv").mkdir(parents=True)
    with pytest.raises(DatabaseError, match=r"b1\.csv is a directory"):
        write_tables(run, tmp_path / "out")


@pytest.mark.parametrize("library", ["pandas", "xarray"])
def test_a_library_that_is_missing(run, monkeypatch, library):
    monkeypatch.setitem(sys.modules, library, None)
    with pytest.raises(ContwalkError, match="not installed") as caught:
        getattr(run["b1"], f"to_{library}")()
    assert f"pip install {library}" in caught.value.remedy


def test_columns_reach_pandas(run, monkeypatch):
    monkeypatch.setitem(sys.modules, "pandas", SimpleNamespace(DataFrame=dict))
    table = run["b1"].to_pandas()
    assert table["q1"].tolist() == run.branch("b1")["q1"].tolist()


def test_columns_and_spectra_reach_xarray(run, monkeypatch):
    branch, given = run["b1"], {}
    monkeypatch.setitem(
        sys.modules, "xarray", SimpleNamespace(Dataset=lambda data, **rest: given.update(data=data, **rest))
    )
    branch.to_xarray()
    assert given["data"]["q1"][0] == "point"
    assert given["data"]["q1"][1].tolist() == branch["q1"].tolist()
    assert given["data"]["spectrum"][0] == ("point", "number")
    assert set(given["coords"]) == {"s", "special_point"}
    assert not set(given["coords"]) & set(given["data"])
    assert given["attrs"]["problem"] == branch.info.problem_by_name
    assert {f"parameter_{name}" for name in branch.info.parameters} <= set(given["attrs"])


def test_real_xarray(run):
    xarray = pytest.importorskip("xarray")
    made = run["b1"].to_xarray()
    assert isinstance(made, xarray.Dataset)
    assert dict(made.sizes) == {"point": 3, "number": run["b1"].info.spectrum}


def test_real_pandas(run):
    pandas = pytest.importorskip("pandas")
    table = run["b1"].to_pandas()
    assert isinstance(table, pandas.DataFrame)
    assert len(table) == 3


def test_a_database_shows_itself_by_its_line_and_its_branches(run):
    """In notebooks as a table of HTML: the line without its angle brackets is the caption."""
    line = repr(run)
    assert (line[0], line[-1]) == ("<", ">")
    shown = run._repr_html_()
    assert line[1:-1].replace("&", "&amp;") in shown
    assert "b1" in shown
