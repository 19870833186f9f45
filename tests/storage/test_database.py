"""What every database does, on both of them."""

import math
from dataclasses import replace

import numpy as np
import pytest

from contwalk.branch import Outcome
from contwalk.errors import DatabaseError

DONE = Outcome("complete", "bound", "delta reached 0.01. Widen continue.range to go on.")


def test_header_comes_back(db, reread, header):
    assert reread(db).header == header


def test_rows_come_back_bit_by_bit_in_order_of_appending(db, reread, make_info, make_row):
    info = make_info()
    db.start_branch(info)
    rows = [make_row(info, s) for s in (0.0, 0.1, 1 / 3, -0.1, -0.2)]
    for row in rows:
        db.append("b1", row)
    stored = reread(db).rows("b1")
    assert stored.dtype == info.point_dtype()
    assert stored.tobytes() == np.array(rows).tobytes()


def test_branch_is_sorted_named_and_incomplete_until_finished(db, reread, make_info, make_row, make_special):
    info = make_info()
    db.start_branch(info)
    for s in (0.0, 0.1, 0.2, -0.1, -0.2):
        db.append("b1", make_row(info, s))
    db.append_special("b1", make_special("HB", 0.2))
    db.append_special("b1", make_special("HB", -0.1))
    again = reread(db)
    branch = again.branch("b1")
    assert branch.info == info
    assert branch["s"].tolist() == [-0.2, -0.1, 0.0, 0.1, 0.2]
    assert [(point.name, point.index) for point in branch.special_points] == [("HB1", 1), ("HB2", 4)]
    assert not branch.complete
    assert (branch.outcome.status, branch.outcome.reason) == ("stopped", "interrupted")
    assert "contwalk continue FILE --resume" in branch.outcome.message
    assert branch.cost == {"seconds": 5 * 0.25, "rhs": 5 * 40}
    assert [point.s for point in again.specials("b1")] == [0.2, -0.1]


def test_special_point_comes_back_with_nan_and_infinity(db, reread, make_info, make_row, make_special):
    info = make_info()
    point = make_special()
    db.start_branch(info)
    db.append("b1", make_row(info, point.s))
    db.append_special("b1", point)
    (stored,) = reread(db).specials("b1")
    # repr, because nan is not equal to itself
    assert repr(stored) == repr(point)


def test_finish_and_reopen(db, reread, make_info, make_row):
    info = make_info()
    db.start_branch(info)
    db.append("b1", make_row(info, 0.0))
    db.finish("b1", DONE, {"seconds": 1.5, "rhs": 700})
    db = reread(db, writable=True)
    branch = db.branch("b1")
    assert branch.complete
    assert branch.outcome == DONE
    assert branch.cost == {"seconds": 1.5, "rhs": 700}
    with pytest.raises(DatabaseError, match="b1 is finished"):
        db.append("b1", make_row(info, 0.1))
    db.drop_outcome("b1")
    db.drop_outcome("b1")
    db.append("b1", make_row(info, 0.1))
    db = reread(db, writable=True)
    assert not db.branch("b1").complete
    assert len(db.branch("b1")) == 2
    later = replace(DONE, message="Again. " + "x" * 3000)  # longer than one piece of the text log
    db.finish("b1", later, {"seconds": 2.0, "rhs": 800})
    assert reread(db).branch("b1").outcome == later


def test_truncate_keeps_the_first(db, reread, make_info, make_row, make_special):
    info = make_info()
    db.start_branch(info)
    for s in (0.0, 0.1, 0.2, 0.3):
        db.append("b1", make_row(info, s))
        db.append_special("b1", make_special("UZ", s))
    db.truncate("b1", 2, [0])
    assert db.rows("b1")["s"].tolist() == [0.0, 0.1]
    db.append("b1", make_row(info, 9.0))
    again = reread(db)
    assert again.rows("b1")["s"].tolist() == [0.0, 0.1, 9.0]
    assert [point.s for point in again.specials("b1")] == [0.0]


def test_drop_frees_the_name_and_keeps_the_others(db, reread, make_info, make_row):
    for number in (1, 2, 3):
        info = make_info(f"b{number}")
        db.start_branch(info)
        db.append(info.name, make_row(info, float(number)))
    db.finish("b3", DONE, {"seconds": 1.0, "rhs": 2})
    db.write_note("seeds", "b1/HB1 is b2")
    db.drop("b2")
    assert db.branch_names() == ["b1", "b3"]
    db.start_branch(make_info("b2"))
    again = reread(db)
    assert again.branch_names() == ["b1", "b3", "b2"]
    assert [branch["s"].tolist() for branch in again.branches()] == [[1.0], [3.0], []]
    assert again.branch("b3").outcome == DONE
    assert again.notes() == {"seeds": "b1/HB1 is b2"}


def test_order_of_creation_is_kept_for_many_branches(db, reread, make_info):
    names = [f"b{number}" for number in range(40, 0, -1)]
    for name in names:
        db.start_branch(make_info(name))
    assert reread(db).branch_names() == names


def test_a_log_grows_beyond_its_first_chunk_size(db, reread, make_info, make_special):
    # 8 rows a chunk and 64 chunks in a node of HDF5's index: beyond 512 the file is copied once
    db.start_branch(make_info())
    for s in range(520):
        db.append_special("b1", make_special("UZ", float(s)))
    assert [point.s for point in reread(db).specials("b1")] == [float(s) for s in range(520)]


def test_notes(db, reread):
    db.write_note("seeds", "old")
    db.write_note("seeds", "b1/HB1 is b2: ≈")
    db.write_note("queue", "ä" * 5000)
    db.write_note("taken back", "b3 is integrated")
    db.write_note("taken back", "")
    assert reread(db).notes() == {"seeds": "b1/HB1 is b2: ≈", "queue": "ä" * 5000}


def test_empty_columns(db, reread, make_info, make_row):
    info = make_info(observables=(), spectrum=0)
    db.start_branch(info)
    row = make_row(info, 0.5)
    db.append("b1", row)
    stored = reread(db).rows("b1")
    assert stored["observables"].shape == (1, 0)
    assert stored.tobytes() == row.tobytes()


def test_wide_points(db, reread, make_info, make_row, make_special):
    states = tuple(f"q{k}" for k in range(28))
    info = make_info(states=states, unknowns=2000, spectrum=28, settings={"mesh": list(range(20000))})
    point = make_special(
        unknowns=tuple(np.linspace(0, 1 / 3, 2000)), tangent=tuple(np.linspace(-1 / 3, 1, 2001))
    )
    row = make_row(info, 0.2, period=1.5)
    db.start_branch(info)
    db.append("b1", row)
    db.append_special("b1", point)
    again = reread(db)
    assert again.branch("b1").info == info
    assert again.rows("b1").tobytes() == row.tobytes()
    assert again.specials("b1")[0].unknowns == point.unknowns


def test_info_of_every_kind_comes_back(db, reread, make_info):
    info = make_info(
        "b2",
        problem="hybrid_orbit",
        parent=("b1", 0.1),
        closure="legs",
        signature=("knee", "heel"),
        subharmonic=2,
    )
    db.start_branch(info)
    assert reread(db).branch("b2").info == info


def test_a_special_point_whose_row_was_torn_stays_on_the_branch(db, make_info, make_row, make_special):
    info = make_info()
    db.start_branch(info)
    db.append("b1", make_row(info, 0.0))
    db.append_special("b1", make_special("LP", 0.1))
    assert db.branch("b1").special("LP1").index == 0


def test_a_record_that_does_not_fit_is_refused_not_cut(db, make_info, make_special):
    db.start_branch(make_info())
    with pytest.raises(DatabaseError, match=r"needs \d+ bytes") as caught:
        db.append_special("b1", make_special(note="x" * 50_000))
    assert "note" in caught.value.remedy
    assert db.specials("b1") == []


def test_wrong_columns_are_refused(db, make_info, make_row):
    db.start_branch(make_info())
    with pytest.raises(DatabaseError, match="has the columns"):
        db.append("b1", make_row(make_info(unknowns=4), 0.0))
    with pytest.raises(DatabaseError, match="shape"):
        db.append("b1", np.zeros(2, make_info().point_dtype()))
    assert len(db.rows("b1")) == 0


def test_names_are_checked(db, make_info):
    db.start_branch(make_info())
    with pytest.raises(DatabaseError, match="exists already"):
        db.start_branch(make_info())
    for name in ("", "b1/x", "."):
        with pytest.raises(DatabaseError, match="cannot be named"):
            db.start_branch(make_info(name))
    with pytest.raises(DatabaseError, match="has no branch 'b11'") as caught:
        db.branch("b11")
    assert caught.value.remedy == "Did you mean 'b1'? Known: b1."


@pytest.mark.parametrize("value", [object(), {1: "number as key"}, {1.5}])
def test_what_json_cannot_hold_is_refused(db, make_info, value):
    with pytest.raises(DatabaseError, match="ranch b1 h"):
        db.start_branch(make_info(settings={"x": value}))
    assert db.branch_names() == []


def test_numpy_and_complex_values_in_coefficients(db, reread, make_info, make_special):
    db.start_branch(make_info())
    values = {"a": np.float64(0.1), "b": np.array([1.0, math.inf]), "c": 1 + 2j, "d": np.bool_(True)}
    db.append_special("b1", make_special(coefficients=values))
    stored = reread(db).specials("b1")[0].coefficients
    assert stored == {"a": 0.1, "b": [1.0, math.inf], "c": 1 + 2j, "d": True}


def test_closed_database_says_so(db, make_info):
    db.close()
    db.close()
    for use in (db.branch_names, db.notes, lambda: db.start_branch(make_info()), lambda: db.rows("b1")):
        with pytest.raises(DatabaseError, match="is closed"):
            use()
