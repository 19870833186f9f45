"""`contwalk show` and `contwalk export`."""

from __future__ import annotations

import csv
import json

import jsonschema
import pytest

from contwalk.storage import interface_schema


@pytest.fixture
def database(contwalk):
    assert contwalk("continue", "run.yaml", "--quiet").code == 0
    return "fork.h5"


def test_branches(contwalk, database):
    done = contwalk("show", database)
    assert done.code == 0
    assert "b1  equilibrium, r from -1 to 1" in done.out
    assert "branch point (pitchfork)" in done.out
    assert contwalk("show", database, "b1").out.splitlines()[:3] == done.out.splitlines()[:3]


def test_a_study_bears_its_author_and_what_it_is_of(contwalk, folder):
    text = (folder / "run.yaml").read_text(encoding="utf-8")
    told = "author: A. Walker\ndescription: a fork, for the first time\n"
    (folder / "run.yaml").write_text(told + text, encoding="utf-8")
    assert contwalk("continue", "run.yaml", "--quiet").code == 0
    shown = contwalk("show", "fork.h5").out.splitlines()
    assert shown[:3] == ["a fork, for the first time", "by A. Walker", "fork"]
    document = json.loads(contwalk("show", "fork.h5", "--json").out)
    assert (document["author"], document["description"]) == ("A. Walker", "a fork, for the first time")
    jsonschema.validate(document, interface_schema())
    # It is the same study, whoever signs it.
    (folder / "run.yaml").write_text(text, encoding="utf-8")
    assert contwalk("continue", "run.yaml", "--quiet", "--resume").code == 0
    assert contwalk("continue", "run.yaml", "--set", "author=3", "--force").code == 2


def test_json_obeys_the_schema(contwalk, database):
    for options in ((), ("--points",), ("b1",), ("b1/BP1",), ("b1/3", "--points")):
        done = contwalk("show", database, "--json", *options)
        assert done.code == 0
        jsonschema.validate(json.loads(done.out), interface_schema())


def test_json_of_a_point(contwalk, database):
    (branch,) = json.loads(contwalk("show", database, "b1/BP1", "--json").out)["branches"]
    assert [point["name"] for point in branch["special_points"]] == ["BP1"]
    assert "points" not in branch
    index = branch["special_points"][0]["index"]
    (by_number,) = json.loads(contwalk("show", database, f"b1/{index}", "--json").out)["branches"]
    assert [point["name"] for point in by_number["special_points"]] == ["BP1"]
    assert len(by_number["points"]) == 1
    assert by_number["points"][0]["special"]


def test_special_point(contwalk, database):
    lines = [line.split() for line in contwalk("show", database, "b1/BP1").out.splitlines()]
    assert ["b1/BP1", "branch", "point", "(pitchfork)"] in lines
    assert ["criticality:", "supercritical"] in lines
    assert ["unstable", "directions:", "0", "->", "1"] in lines
    assert ["a", "0.25"] in lines  # a parameter without a unit
    assert any(line[:1] == ["x"] and line[2:] == ["m"] for line in lines)  # a state with its unit
    eigenvalues = lines[lines.index(["eigenvalues:", "real", "imaginary"]) + 1 :]
    assert abs(float(eigenvalues[0][0])) < 1e-12  # the critical one
    assert eigenvalues[1] == ["-1.0", "0.0"]


def test_a_point_needs_no_system(contwalk, database, folder):
    before = contwalk("show", database, "b1/BP1")
    assert before.err == ""
    (folder / "fork.py").write_text("raise RuntimeError('gone')\n", encoding="utf-8")
    assert contwalk("show", database, "b1/BP1") == before
    (folder / "fork.py").unlink()
    assert contwalk("show", database, "b1/BP1") == before


def test_any_point(contwalk, database):
    lines = [line.split() for line in contwalk("show", database, "b1/0").out.splitlines()]
    assert ["r", "-1.0", "N"] in lines
    assert ["height", "0.0", "m"] in lines
    assert ["unstable", "directions:", "0", "(stable)"] in lines


def test_points(contwalk, database):
    shown = contwalk("show", database, "b1", "--points").out.splitlines()
    start = next(k for k, line in enumerate(shown) if line.startswith("b1 ") and "height" in line)
    assert shown[start].split() == ["b1", "r", "height", "max_re", "x", "y", "unstable"]
    count = json.loads(contwalk("show", database, "--json").out)["branches"][0]["n_points"]
    assert len(shown) - start - 1 == count
    assert shown[start + 1].split() == ["0", "EP1", "-1", "0", "-1", "0", "0.25", "0"]


@pytest.mark.parametrize(
    ("what", "said"),
    [
        ("b2", "has no branch 'b2'. Did you mean 'b1'?"),
        ("b1/BP2", "Known: EP1, BP1, EP2"),
        ("b1/100000", "Its points are 0 to"),
        ("/BP1", "has no branch ''"),
    ],
)
@pytest.mark.parametrize("options", [(), ("--json",)], ids=["text", "json"])
def test_what_is_not_there(contwalk, database, what, said, options):
    done = contwalk("show", database, what, *options)
    assert (done.code, done.out) == (2, "")
    assert said in done.err


def test_export(contwalk, database, folder):
    done = contwalk("export", database, "--csv", "tables")
    refused = contwalk("export", database, "--csv", "tables")
    assert (refused.code, "branches.csv exists. Replace it with --force" in refused.err) == (2, True)
    assert contwalk("export", database, "--csv", "tables", "--force").out == done.out
    assert done.code == 0
    assert [line.rsplit("/", 1)[-1] for line in done.out.split()] == [
        "branches.csv",
        "special_points.csv",
        "b1.csv",
    ]
    with (folder / "tables" / "special_points.csv").open(encoding="utf-8") as file:
        assert [row["name"] for row in csv.DictReader(file)] == ["EP1", "BP1", "EP2"]


def test_tables_are_not_written_into_a_file(contwalk, fork_with_branches):
    refused = contwalk("export", fork_with_branches, "--csv", "run.yaml")
    assert refused.code == 2
    assert "run.yaml is a file: tables are written into a directory" in refused.err
