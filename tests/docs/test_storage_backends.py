"""The page on storage backends: a study goes into the file that it adds, is cut short, and goes on."""

from __future__ import annotations

import numpy as np
import pytest
from code_blocks import ROOT
from page_backend import PAGE, backends, json_lines

import contwalk as cw
from contwalk.errors import DatabaseError
from contwalk.storage import RunHeader
from contwalk.storage import backends as storage_backends
from contwalk.storage.database import Database
from contwalk.storage.file_database import FileDatabase
from contwalk.storage.schema import decode, encode

RUN = """
contwalk: 1
system: autobalancer
model: {masses: 2}
parameters: {omega: 5.0}
start: {equilibrium: balanced}
continue: {parameter: m, range: [0.001, 0.024]}
"""


@pytest.fixture
def page(monkeypatch):
    """The backend of the page, added as it says."""
    json_lines()
    assert set(storage_backends.BACKENDS) < set(backends())
    monkeypatch.setattr(storage_backends, "BACKENDS", backends())


def study(folder, output):
    path = folder / "study.yaml"
    path.write_text(RUN, encoding="utf-8")
    return cw.read_run_file(path, output=str(folder / output))


def rows_of(path):
    with cw.open_database(path) as db:
        return {name: db.rows(name) for name in db.branch_names()}, [b.special_points for b in db.branches()]


def same(one, other):
    """The same rows, but for how long they took, and the same points."""
    for name in one[0]:
        a, b = one[0][name].copy(), other[0][name].copy()
        a["seconds"] = b["seconds"] = 0.0
        assert a.tobytes() == b.tobytes()
    return one[0].keys() == other[0].keys() and repr(one[1]) == repr(other[1])


def test_a_study_is_the_same_in_both_files_and_goes_on_after_a_kill(page, tmp_path):
    for output in ("study.h5", "study.jsonl"):
        cw.run(study(tmp_path, output), figures=False)
    text = (tmp_path / "study.jsonl").read_bytes()
    assert text.startswith(b'["write_header"')
    whole = rows_of(tmp_path / "study.jsonl")
    assert len(whole[0]) > 1
    assert same(rows_of(tmp_path / "study.h5"), whole)
    lines = text.splitlines(keepends=True)
    torn = b"".join(lines[: len(lines) // 2]) + lines[len(lines) // 2][:20]
    (tmp_path / "study.jsonl").write_bytes(torn)
    with cw.open_database(tmp_path / "study.jsonl") as db:
        assert db.branches()[-1].outcome.reason == "interrupted"
    cw.run(study(tmp_path, "study.jsonl"), resume=True, figures=False)
    assert same(rows_of(tmp_path / "study.jsonl"), whole)


def test_what_is_no_such_file_is_refused_in_a_sentence(page, tmp_path):
    (tmp_path / "a.jsonl").write_text("not JSON\n", encoding="utf-8")
    with pytest.raises(DatabaseError, match=r"a\.jsonl is damaged and cannot be read"):
        cw.open_database(tmp_path / "a.jsonl")
    with pytest.raises(DatabaseError, match=r"b\.jsonl does not exist"):
        cw.open_database(tmp_path / "b.jsonl")


def test_two_writers_are_one_too_many(page, tmp_path):
    run = study(tmp_path, "study.jsonl")
    with json_lines().JsonLinesDatabase.create(run.output, RunHeader("x")):
        with pytest.raises(DatabaseError, match="is in use"):
            json_lines().JsonLinesDatabase.open(run.output, writable=True)
        with cw.open_database(run.output) as beside, pytest.raises(DatabaseError, match="reading only"):
            beside.write_note("a", "b")


def test_the_page_names_every_member_that_a_backend_has_to_write():
    text = PAGE.read_text(encoding="utf-8")
    table = text.split("## What a database must do")[1].split("\n\n")[1]
    members = Database.__abstractmethods__ | FileDatabase.__abstractmethods__
    assert [name for name in sorted(members) if f"`{name}" not in table] == []
    assert (ROOT / "contwalk/storage/backends.py").is_file()


def test_rows_keep_numbers_that_are_none(page, tmp_path):
    """A NaN and infinities come back through the text as they are."""
    row = np.array([(np.nan, np.inf, -0.0, 1e-308)], "f8,f8,f8,f8")
    back = np.array([tuple(decode(encode(row.tolist()[0], "a row")))], row.dtype)
    assert back.tobytes() == row.tobytes()
