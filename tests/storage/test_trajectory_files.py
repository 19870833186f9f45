"""Motions and samples as files."""

from __future__ import annotations

import dataclasses
import os

import h5py
import numpy as np
import pytest

from contwalk.errors import DatabaseError
from contwalk.storage.failures import refuse_existing
from contwalk.storage.trajectory import (
    Samples,
    Trajectory,
    read_samples,
    read_trajectory,
    write_samples,
    write_trajectory,
)


def trajectory(events=2):
    rng = np.random.default_rng(1)
    return Trajectory(
        system="spring",
        states=("x", "v_µ"),
        parameters={"w": 0.1, "d": 1e-300},
        times=np.linspace(0.0, 1.0, 5),
        values=rng.normal(size=(5, 2)),
        modes=np.array([0, 0, 1, 1, 0]),
        mode_names=("free", "held"),
        event_names=("touch", "x = 0")[:events],
        event_times=rng.uniform(size=events),
        event_rising=np.array([True, False])[:events],
        event_before=rng.normal(size=(events, 2)),
        event_after=rng.normal(size=(events, 2)),
        event_modes=("free", "held")[:events],
        status="not_finite",
        header={"config": "system: spring\n", "provenance": {"python": "3"}},
    )


def samples():
    rng = np.random.default_rng(2)
    return Samples(
        system="spring",
        drawn=("x", "w"),
        measured="turns",
        draws=rng.normal(size=(4, 2)),
        values=np.array([1.0, np.nan, 0.0, 3.5]),
        settled=np.array([True, False, True, True]),
        crossed=np.array([True, False, False, True]),
        ends=rng.uniform(size=4),
        header={"parameters": {"w": 1.0}},
    )


def same(a, b):
    for field in dataclasses.fields(a):
        np.testing.assert_array_equal(getattr(a, field.name), getattr(b, field.name), err_msg=field.name)


@pytest.mark.parametrize("events", [0, 2])
def test_a_motion_is_read_back_as_it_was_written(tmp_path, events):
    path = write_trajectory(tmp_path / "t.h5", trajectory(events))
    same(read_trajectory(path), trajectory(events))
    assert [p.name for p in tmp_path.iterdir()] == ["t.h5"]


def test_of_two_motions_that_are_written_at_once_the_first_is_kept(tmp_path):
    path = write_trajectory(tmp_path / "t.h5", trajectory(), new=True)
    with pytest.raises(DatabaseError, match=r"t\.h5 exists.*--force"):
        write_trajectory(path, trajectory(0), new=True)
    same(read_trajectory(path), trajectory())
    assert [p.name for p in tmp_path.iterdir()] == ["t.h5"]


def test_samples_are_read_back_as_they_were_written(tmp_path):
    same(read_samples(write_samples(tmp_path / "s.h5", samples())), samples())


def test_a_file_of_something_else_is_told(tmp_path):
    path = write_samples(tmp_path / "s.h5", samples())
    with pytest.raises(DatabaseError, match=r"s\.h5 holds no trajectory: it is contwalk samples.*simulate"):
        read_trajectory(path)
    with h5py.File(tmp_path / "other.h5", "w"):
        pass
    with pytest.raises(DatabaseError, match="another program"):
        read_samples(tmp_path / "other.h5")
    with pytest.raises(DatabaseError, match="does not exist"):
        read_samples(tmp_path / "none.h5")
    with h5py.File(path, "a") as file:
        file.attrs["schema_version"] = 99
    with pytest.raises(DatabaseError, match="version 99"):
        read_samples(path)


def test_a_damaged_file_is_told(tmp_path):
    path = write_trajectory(tmp_path / "t.h5", trajectory())
    with h5py.File(path, "a") as file:
        del file["times"]
    with pytest.raises(DatabaseError, match="damaged"):
        read_trajectory(path)


def test_writing_that_fails_leaves_the_old_file_and_nothing_else(tmp_path):
    path = write_samples(tmp_path / "s.h5", samples())
    before = path.read_bytes()
    broken = dataclasses.replace(samples(), values=np.array([object()]))
    with pytest.raises(TypeError):
        write_samples(path, broken)
    assert path.read_bytes() == before
    assert os.listdir(tmp_path) == ["s.h5"]


def test_existing_files_are_refused_unless_forced(tmp_path):
    path = tmp_path / "s.h5"
    refuse_existing([path], force=False)
    path.write_bytes(b"")
    refuse_existing([path], force=True)
    with pytest.raises(DatabaseError, match=r"s\.h5 exists.*--force"):
        refuse_existing([tmp_path / "new.h5", path], force=False)
    with pytest.raises(DatabaseError, match="does not exist"):
        refuse_existing([tmp_path / "nowhere" / "x.h5"], force=True)
    with pytest.raises(DatabaseError, match="is a directory"):
        refuse_existing([tmp_path], force=True)
