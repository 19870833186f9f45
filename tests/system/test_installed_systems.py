"""Installed systems are found as the metadata of packages tell, and what was found is never out of date."""

from __future__ import annotations

import sys
from importlib.metadata import entry_points
from pathlib import Path

import pytest

from contwalk.system import installed as installed_systems
from contwalk.system.installed import GROUP, Installed, installed


@pytest.fixture(autouse=True)
def fresh(monkeypatch, tmp_path):
    """Nothing is known yet, in this process and on disk; nor afterwards."""
    monkeypatch.setenv("CONTWALK_CACHE_DIR", str(tmp_path / "cache"))
    installed.cache_clear()
    yield
    installed.cache_clear()


def package(folder: Path, points: str) -> None:
    """A package that is installed in a folder, with its list of entry points."""
    told = folder / "waves-1.0.dist-info"
    told.mkdir(parents=True, exist_ok=True)
    (told / "METADATA").write_text("Metadata-Version: 2.1\nName: waves\nVersion: 1.0\n")
    (told / "entry_points.txt").write_text(points)


def again() -> dict[str, str]:
    """What another process finds."""
    installed.cache_clear()
    return dict(installed())


def test_they_are_those_of_the_metadata():
    told = {point.name: point.value for point in entry_points(group=GROUP)}
    assert again() == told
    assert again() == told  # from disk


def test_packages_that_come_change_and_go_are_seen(monkeypatch, tmp_path):
    folder = tmp_path / "site"
    folder.mkdir()
    before = again()
    monkeypatch.syspath_prepend(str(folder))
    assert again() == before
    package(folder, f"[{GROUP}]\nwaves = waves.model:SYSTEM\n")
    assert again() == before | {"waves": "waves.model:SYSTEM"}
    assert again() == before | {"waves": "waves.model:SYSTEM"}
    package(folder, f"[{GROUP}]\nripples = waves.model:SYSTEM\n")
    assert again() == before | {"ripples": "waves.model:SYSTEM"}
    (folder / "waves-1.0.dist-info" / "entry_points.txt").unlink()
    assert again() == before


def test_nothing_is_kept_where_packages_are_found_otherwise(monkeypatch, tmp_path):
    class Finder:
        def find_spec(self, *_args):
            return None

        def find_distributions(self, *_args):
            return ()

    monkeypatch.setattr(sys, "meta_path", [*sys.meta_path, Finder()])
    assert installed_systems._packages() is None
    again()
    assert not list((tmp_path / "cache").rglob("*.o"))


def test_a_system_is_loaded_from_its_place(monkeypatch, tmp_path):
    (tmp_path / "calm.py").write_text("class waters:\n    SYSTEM = 'still'\n")
    monkeypatch.syspath_prepend(str(tmp_path))
    assert Installed("calm", "calm:waters.SYSTEM").load() == "still"
    assert Installed("calm", "calm : waters [extra]").load().SYSTEM == "still"
    assert Installed("calm", "calm").load().__name__ == "calm"
    with pytest.raises(ImportError):
        Installed("storm", "storm_that_is_nowhere:SYSTEM").load()
