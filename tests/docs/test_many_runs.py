"""The how-to page on many runs: its commands and its program from the page alone, the same bytes from all."""

from __future__ import annotations

import pytest
from code_blocks import blocks, commands, run_command, run_python

import contwalk as cw

pytestmark = pytest.mark.slow

PAGE = "docs/howto/many_runs.md"


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """The page's files, and its commands run in their order."""
    folder = tmp_path_factory.mktemp("many_runs")
    plugin, _ = blocks(PAGE, "python")
    (study,) = blocks(PAGE, "yaml")
    (folder / "brusselator.py").write_text(plugin, encoding="utf-8")
    (folder / "fleet.yaml").write_text(study, encoding="utf-8")
    for line in commands(PAGE):
        run_command(line, folder)
    return folder


def test_two_processes_store_what_one_does(folder):
    with cw.open_database(folder / "fleet.h5") as two, cw.open_database(folder / "alone.h5") as one:
        assert two.branch_names() == one.branch_names()
        assert two.notes() == one.notes()
        for name in one.branch_names():
            a, b = one.rows(name), two.rows(name)
            for column in set(a.dtype.names) - {"seconds"}:
                assert a[column].tobytes() == b[column].tobytes()
            assert repr(list(map(vars, one.specials(name)))) == repr(list(map(vars, two.specials(name))))


def test_the_hopf_points_are_those_of_the_formula(folder):
    """b = 1 + a^2, and a cycle from each."""
    with cw.open_database(folder / "fleet.h5") as database:
        branches = database.branches()
    found = [point for branch in branches for point in branch.special_points if point.label == "HB"]
    assert len(found) == 5
    for point in found:
        assert abs(point.parameters["b"] - 1.0 - point.parameters["a"] ** 2) <= point.error
    assert [branch.info.problem for branch in branches].count("periodic_orbit") == 5


def test_any_pool_gives_the_same(folder):
    _, program = blocks(PAGE, "python")
    assert run_python(program, folder) == "10 branches, the same in both\n"
