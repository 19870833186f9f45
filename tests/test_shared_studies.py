"""A study that several files look at is computed once, and anew where anything that decides it changes."""

from __future__ import annotations

import multiprocessing
import os
from pathlib import Path

import pytest
import shared_studies
from shared_studies import KEPT, shared_branches

RUN = """\
contwalk: 1
system: autobalancer
start: {equilibrium: balanced}
continue: {parameter: m, range: [0.01, 0.012], max_points: 3}
diagram: none
"""


@pytest.fixture
def run_file(tmp_path) -> Path:
    path = tmp_path / "run.yaml"
    path.write_text(RUN, encoding="utf-8")
    return path


def kept(place: Path) -> set[str]:
    return {path.name for path in place.glob("*.h5")}


def test_it_is_computed_once(run_file, tmp_path, monkeypatch):
    first = shared_branches(run_file, (), tmp_path / "kept")
    monkeypatch.setattr(shared_studies, "run", None)  # whoever calls it fails
    again = shared_branches(run_file, (), tmp_path / "kept")
    assert [branch.points.tobytes() for branch in again] == [branch.points.tobytes() for branch in first]
    assert len(first[0]) == 3


def test_whatever_decides_it_gives_another_one(run_file, tmp_path, monkeypatch):
    place = tmp_path / "kept"
    shared_branches(run_file, (), place)
    shared_branches(run_file, ("continue.max_points=4",), place)
    monkeypatch.setenv("CONTWALK_CACHE_DIR", str(tmp_path))  # where machine code is kept decides nothing
    monkeypatch.setattr(shared_studies, "_code", lambda: "another state of the code")
    shared_branches(run_file, (), place)
    monkeypatch.setenv("OPENBLAS_CORETYPE", "Prescott")
    shared_branches(run_file, (), place)
    run_file.write_text(RUN.replace("0.012", "0.013"), encoding="utf-8")
    shared_branches(run_file, (), place)
    assert len(kept(place)) == 5


def test_two_processes_compute_it_once(run_file, tmp_path):
    place = tmp_path / "kept"
    with multiprocessing.get_context("spawn").Pool(2) as pool:
        one, other = pool.starmap(_seconds, [(run_file, place)] * 2)
    assert one == other  # what each point took is never the same twice
    assert len(kept(place)) == 1


def _seconds(path: Path, place: Path) -> list[float]:
    (branch,) = shared_branches(path, (), place)
    return branch["seconds"].tolist()


def test_what_nobody_has_asked_for_in_a_day_is_taken_away(run_file, tmp_path):
    place = tmp_path / "kept"
    shared_branches(run_file, (), place)
    (old,) = kept(place)
    os.utime(place / old, (1.0, 1.0))
    shared_branches(run_file, ("continue.max_points=2",), place)
    assert old not in kept(place)
    assert len(kept(place)) == 1
    assert KEPT > 3600.0
