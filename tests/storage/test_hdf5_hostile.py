"""Files that were made to mislead: a sentence, at once, and in little memory."""

import json

import h5py
import numpy as np
import pytest

from contwalk.errors import DatabaseError
from contwalk.storage import Hdf5Database, document, open_database
from contwalk.storage.records import RecordLog
from contwalk.storage.schema import TEXT_CHUNK, TEXT_DTYPE, joined, pieces, special_from_text, special_text
from contwalk.storage.trajectory import TRAJECTORY


@pytest.fixture
def stored(tmp_path, header, make_info, make_row):
    path = tmp_path / "stored.h5"
    with Hdf5Database.create(path, header) as db:
        for name in ("b1", "b2"):
            db.start_branch(make_info(name))
            for s in range(5):
                db.append(name, make_row(make_info(name), float(s)))
    return path


def refused(path):
    with pytest.raises(DatabaseError, match=r"stored\.h5 is") as caught, open_database(path) as db:
        document(db, points=True)
    assert caught.value.remedy


def replaced(file, name, shape=(3,), dtype="f8", **options):
    del file[name]
    file.create_dataset(name, shape, dtype, **options)


def text_log(file, name, text):
    del file[name]
    RecordLog.create(file, name, pieces(text), TEXT_CHUNK)


def linked(file, name, link):
    del file[name]
    file[name] = link


def unlisted(file):
    file["catalogue"][0] = h5py.Reference()


def listed_twice(file):
    file["catalogue"][1] = file["catalogue"][0]


HUGE = 10**13
ROW = np.dtype([*TEXT_DTYPE.descr, ("crc32", "<u4")])
CHANGES = {
    "huge rows": lambda file: file["branches/b1/points"].resize((HUGE,)),
    "huge texts": lambda file: file["header"].resize((HUGE,)),
    "huge catalogue": lambda file: replaced(file, "catalogue", (HUGE,), h5py.ref_dtype, chunks=(1000,)),
    "zero header": lambda file: file["header"].resize((0,)),
    "numbers as header": lambda file: replaced(file, "header", chunks=(1,)),
    "numbers as rows": lambda file: replaced(file, "branches/b1/points", chunks=(1,)),
    "numbers as catalogue": lambda file: replaced(file, "catalogue"),
    "texts of any length": lambda file: replaced(file, "header", dtype=h5py.string_dtype(), chunks=(1,)),
    "compressed": lambda file: replaced(file, "header", (9,), ROW, chunks=(9,), compression="gzip"),
    "elsewhere": lambda file: replaced(file, "header", (9,), ROW, external=[("/etc/passwd", 0, 9999)]),
    "a table": lambda file: replaced(file, "header", (3, 3), ROW, chunks=(1, 1)),
    "a group as rows": lambda file: (file.pop("branches/b1/points"), file.create_group("branches/b1/points")),
    "external link": lambda file: linked(file, "header", h5py.ExternalLink("other.h5", "/header")),
    "soft link": lambda file: linked(file, "header", h5py.SoftLink("/notes")),
    "a circle": lambda file: linked(file, "branches/b1/points", h5py.SoftLink("/branches/b1/points")),
    "branch unlisted": unlisted,
    "branch listed twice": listed_twice,
    "header is a list": lambda file: text_log(file, "header", "[1, 2]"),
    "header is deep": lambda file: text_log(file, "header", "[" * 100_000),
    "header of other types": lambda file: text_log(
        file, "header", '{"system": 1, "model": [], "config": null, "provenance": {}}'
    ),
    "version is a text": lambda file: file.attrs.__setitem__("schema_version", "one"),
    "version is an array": lambda file: file.attrs.__setitem__("schema_version", np.ones(5)),
}


TEXTS = {
    "no problem": {"problem": "weather"},
    "nothing free": {"free": []},
    "states in one text": {"states": "q1"},
    "fewer than none": {"unknowns": -1},
    "more than there can be": {"unknowns": 10**12},
    "a half": {"spectrum": 0.5},
    "no name": {"name": 3},
    "a parent of three": {"parent": ["b1", 0.0, 1.0]},
    "what is not known": {"colour": "red"},
    "parameters by text": {"parameters": {"delta": "small"}},
}


@pytest.mark.parametrize("changed", TEXTS)
def test_records_of_other_types(stored, changed):
    with h5py.File(stored, "r+") as file:
        (text,) = joined(RecordLog(file["branches/b1/info"], TEXT_DTYPE).read())
        text_log(file, "branches/b1/info", json.dumps(json.loads(text) | TEXTS[changed]))
    refused(stored)


@pytest.mark.parametrize(
    "changes",
    [{"s": "here"}, {"spectrum": [[1.0]]}, {"state": [1.0]}, {"admissible": "yes"}, {"s": None}],
)
def test_special_points_of_other_types(make_special, changes):
    text = json.dumps(json.loads(special_text(make_special())) | changes)
    with pytest.raises(TypeError, match="of another type"):
        special_from_text(text)


@pytest.mark.parametrize("change", CHANGES)
def test_changed_by_another_program(stored, change):
    with h5py.File(stored, "r+") as file:
        CHANGES[change](file)
    refused(stored)


def test_a_branch_without_points(stored, make_info):
    with Hdf5Database.open(stored, writable=True) as db:
        db.start_branch(make_info("b3"))
    with open_database(stored) as db:
        assert len(document(db, points=True)["branches"][2]["points"]) == 0


def test_a_trajectory_is_called_one(tmp_path):
    path = tmp_path / "run_trajectory.h5"
    with h5py.File(path, "w") as file:
        file.attrs["format"] = TRAJECTORY
    with pytest.raises(
        DatabaseError, match="holds no branches: it is a motion that contwalk simulate"
    ) as told:
        open_database(path)
    assert "run_trajectory.csv" in told.value.remedy
    assert "read_trajectory" in told.value.remedy


def test_a_database_as_a_container(stored):
    with open_database(stored) as db:
        assert [branch.name for branch in db] == ["b1", "b2"]
        assert len(db) == 2
        assert "b1" in db
        assert "b3" not in db
