"""Results that are kept line by line."""

from __future__ import annotations

import errno
import os
from pathlib import Path
from types import SimpleNamespace

import pytest

from contwalk.errors import DatabaseError, WriteError
from contwalk.storage.failures import disk_full
from contwalk.storage.journal import Journal, check_still_new, going_on_from

STUDY = {"study": "a", "rays": 3}


def written(path, *results):
    with Journal(path, STUDY, resume=False) as journal:
        for result in results:
            journal.add(result)
    return path.read_bytes()


def test_results_are_there_again_to_the_last_bit(tmp_path):
    path, results = tmp_path / "j", [{"border": 0.1 + 0.2, "many": [1e-300, -0.0]}, {"border": None}]
    written(path, *results)
    with Journal(path, STUDY, resume=True) as journal:
        assert journal.kept == results


def test_what_was_being_written_when_killed_is_dropped_and_what_came_before_is_kept(tmp_path):
    path = tmp_path / "j"
    whole = written(path, {"n": 0}, {"n": 1}, {"n": 2})
    for cut in range(len(whole)):
        path.write_bytes(whole[:cut])
        with Journal(path, STUDY, resume=True) as journal:
            kept = len(journal.kept)
            assert journal.kept == [{"n": k} for k in range(kept)]
            for k in range(kept, 3):
                journal.add({"n": k})
        assert path.read_bytes() == whole


@pytest.mark.parametrize("there", [True, False])
def test_a_journal_is_no_link_to_another_file(tmp_path, there):
    victim, path = tmp_path / "victim", tmp_path / "j"
    if there:
        victim.write_text("mine")
    path.symlink_to(victim)
    for resume in (False, True):
        with pytest.raises(DatabaseError, match=r"j is a link.*Remove it"):
            Journal(path, STUDY, resume=resume)
    assert victim.exists() == there
    assert not there or victim.read_text() == "mine"


def test_all_who_made_results_are_told(tmp_path):
    path = tmp_path / "j"
    for made in ({"processor": "one"}, {"processor": "another"}, {"processor": "one"}):
        with Journal(path, STUDY, resume=True, made=made) as journal:
            journal.add({"n": len(journal.kept)})
    with Journal(path, STUDY, resume=True, made=made) as journal:
        assert journal.kept == [{"n": 0}, {"n": 1}, {"n": 2}]
        assert journal.made == [{"processor": "one"}, {"processor": "another"}]


@pytest.mark.parametrize("damaged", range(3))
def test_results_before_a_damaged_one_are_kept_and_the_others_are_computed_again(tmp_path, damaged):
    path = tmp_path / "j"
    whole = written(path, *({"n": n} for n in range(3)))
    begins = [0, *(place + 1 for place, byte in enumerate(whole) if byte == ord("\n"))]
    broken = bytearray(whole)
    broken[begins[1 + damaged] + 12] ^= 1
    path.write_bytes(broken)
    told = rf"damaged at byte {begins[1 + damaged]}: the {damaged} results .* \({3 - damaged} lines\)"
    with pytest.warns(UserWarning, match=told):
        journal = Journal(path, STUDY, resume=True)
    with journal:
        assert journal.kept == [{"n": n} for n in range(damaged)]
        for n in range(damaged, 3):
            journal.add({"n": n})
    assert path.read_bytes() == whole


def test_a_journal_that_does_not_tell_its_study_is_refused(tmp_path):
    path = tmp_path / "j"
    whole = bytearray(written(path, {"n": 0}, {"n": 1}))
    whole[20] ^= 1
    path.write_bytes(bytes(whole))
    with pytest.raises(DatabaseError, match="damaged at byte 0"):
        Journal(path, STUDY, resume=True)


def test_results_of_another_study_are_not_taken_up(tmp_path):
    path = tmp_path / "j"
    written(path, {"n": 0})
    with pytest.raises(DatabaseError, match="another study; what differs: rays"):
        Journal(path, STUDY | {"rays": 4}, resume=True)
    with Journal(path, STUDY | {"rays": 4}, resume=False) as journal:
        assert journal.kept == []


@pytest.mark.parametrize(("name", "command"), [("margins", "margins"), ("samples", "sample")])
def test_a_full_disk_is_told_with_the_command_that_goes_on(name, command):
    error = disk_full(Path(f"x_{name}.journal"))
    assert "What it holds is kept." in str(error)
    assert f"contwalk {command} FILE --resume" in error.remedy


def test_what_another_process_has_written_meanwhile_is_left_alone(tmp_path):
    path, table = tmp_path / "j", tmp_path / "table.csv"
    table.write_text("of a study that began a little earlier, and has ended\n")
    with Journal(path, STUDY, resume=False) as journal:
        with pytest.raises(DatabaseError, match="exists"):
            check_still_new(journal, [table], force=False)
        assert not path.exists()
    written(path, {"n": 0})
    with Journal(path, STUDY, resume=True) as journal:  # its files were being written when it was stopped
        check_still_new(journal, [table], force=False)
    assert path.exists()


def test_a_disk_that_is_full_is_told_once_and_not_again_where_the_journal_is_closed(tmp_path, monkeypatch):
    def full(*given):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    journal = Journal(tmp_path / "j", STUDY, resume=False)
    journal._file.close()
    monkeypatch.setattr(journal, "_file", SimpleNamespace(write=full, flush=full, close=full))
    with pytest.raises(DatabaseError, match="disk is full"), journal:
        journal.add({"n": 0})


def test_files_that_cannot_be_written_in_the_end_are_told_with_the_way_to_go_on(tmp_path):
    journal = tmp_path / "x_margins.journal"
    with pytest.raises(WriteError) as caught, going_on_from(journal):
        raise DatabaseError("The disk is full: x_margins.csv cannot be created.", "Free some space.")
    assert caught.value.exit_code == 1
    assert caught.value.sentence.endswith(f"cannot be created. What was found is kept in {journal}.")
    assert caught.value.remedy == "Mend that, then go on with: contwalk margins FILE --resume"
