"""The JSON document, over both databases, against its schema."""

import json
import math

import jsonschema
import pytest

from contwalk.branch import Outcome
from contwalk.errors import DatabaseError
from contwalk.storage import document, interface_schema


@pytest.fixture
def run(db, make_info, make_row, make_special):
    """An equilibrium branch with two Hopf points, and an orbit branch from the second."""
    first = make_info()
    db.start_branch(first)
    for s in (0.0, 0.1, 0.2, 0.3):
        db.append("b1", make_row(first, s, special=s in (0.1, 0.3)))
    db.append_special("b1", make_special("HB", 0.3))
    db.append_special("b1", make_special("HB", 0.1, error=math.nan, period=math.inf, spectrum_full=None))
    db.finish("b1", Outcome("complete", "bound", "Widen the range."), {"seconds": 1.0, "rhs": 160})
    second = make_info(
        "b2",
        problem="hybrid_orbit",
        parent=("b1", 0.29999),
        closure="legs",
        signature=("knee_strike", "heel_strike"),
        subharmonic=2,
    )
    db.start_branch(second)
    db.append("b2", make_row(second, 0.0, period=1.25, stable=True, unstable=0, spectrum_error=math.nan))
    return db


def valid(content):
    """The document as another program reads it: strict JSON that obeys the schema."""
    text = json.dumps(content, allow_nan=False)
    jsonschema.Draft202012Validator(interface_schema()).validate(json.loads(text))
    return json.loads(text)


def test_document(run, header):
    content = valid(document(run))
    assert content["schema_version"] == 1
    assert content["contwalk_version"] == "0.1.0"
    assert (content["system"], content["model"], content["config"]) == (
        header.system,
        header.model,
        header.config,
    )
    first, second = content["branches"]
    assert (first["name"], first["parent"], first["n_points"], first["reason"]) == ("b1", None, 4, "bound")
    assert first["cost"] == {"seconds": 1.0, "rhs": 160}
    assert [(point["name"], point["index"]) for point in first["special_points"]] == [("HB1", 1), ("HB2", 3)]
    assert second["parent"] == "b1/HB2"
    assert second["signature"] == ["knee_strike", "heel_strike"]
    assert (second["status"], second["reason"]) == ("stopped", "interrupted")
    assert "points" not in first
    assert content["notes"] == []


def test_numbers_that_are_not_finite(run):
    first, second = valid(document(run))["branches"][0]["special_points"]
    assert second["spectrum"] == [[0.0, 5.0], ["nan", "-inf"]]
    assert second["margin"] == {"friction": "-inf"}
    assert second["coefficients"]["l2"] == "nan"
    assert second["error"] == 3e-12
    assert (first["error"], first["period"], first["spectrum_full"]) == (None, None, None)


def test_points(run):
    first, second = valid(document(run, points=True))["branches"]
    assert len(first["points"]) == 4
    assert first["points"][3]["free"] == [0.3 / 7]
    assert first["points"][3]["state"] == {"q1": 0.3 / 3, "q2": 0.3 / 3 + 1}
    assert first["points"][3]["observables"] == {"max_re": 0.3 / 11}
    assert first["points"][0]["period"] is None
    assert [point["special"] for point in first["points"]] == [False, True, False, True]
    (point,) = second["points"]
    assert (point["period"], point["stable"], point["unstable"], point["s"]) == (1.25, True, 0, 0.0)
    assert point["spectrum_error"] == "nan"
    assert point["admissible"] is True


def test_only_some_branches(run):
    content = valid(document(run, only=["b2"]))
    assert [branch["name"] for branch in content["branches"]] == ["b2"]
    assert content["branches"][0]["parent"] == "b1/HB2"
    with pytest.raises(DatabaseError, match="no branch 'b3'"):
        document(run, only=["b3"])


def test_empty_run_and_empty_branch(db, make_info):
    assert valid(document(db))["branches"] == []
    db.start_branch(make_info())
    assert valid(document(db, points=True))["branches"][0]["points"] == []


def test_parent_that_is_gone(run):
    run.drop("b1")
    assert valid(document(run))["branches"][0]["parent"] is None


def test_schema_is_itself_valid():
    jsonschema.Draft202012Validator.check_schema(interface_schema())
