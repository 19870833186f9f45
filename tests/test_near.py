"""What `make near` chooses: tests that changed, those that mirror what changed, and those that import it."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

from tools.near import Suite, changed_files

ROOT = Path(__file__).parents[1]
TEXTS = {
    "tests/storage/test_seal.py": "from contwalk.storage.seal import sealed\n",
    "tests/storage/test_files.py": "from contwalk.storage import Database\n",
    "tests/workflow/test_runs.py": "import contwalk as cw\n",
    "tests/cli/test_command.py": "from contwalk.cli.entry import run\n",
    "tests/docs/test_pages.py": "PAGES = ['docs/howto/point_types.md']\n",
    "tests/small_systems.py": "from contwalk.system import System\n",
}
IMPORTS = {
    "contwalk": frozenset({"contwalk.workflow.runner"}),
    "contwalk.storage": frozenset({"contwalk.storage.seal"}),
    "contwalk.storage.seal": frozenset(),
    "contwalk.workflow.runner": frozenset({"contwalk.storage"}),
    "contwalk.cli.entry": frozenset({"contwalk.workflow.runner"}),
    "contwalk.system": frozenset(),
}


@pytest.fixture
def suite() -> Suite:
    return Suite(TEXTS, IMPORTS, {"tests/storage/test_files.py": 100.0})


def test_what_mirrors_a_module_comes_before_what_imports_it(suite):
    near = suite.nearest(["contwalk/storage/seal.py"], 1000.0)
    assert near[:2] == ["tests/storage/test_seal.py", "tests/storage/test_files.py"]
    assert "tests/docs/test_pages.py" not in near
    assert "tests/workflow/test_runs.py" not in near  # the package's own names lead to everything


def test_tests_that_changed_come_first_and_what_is_no_module_is_near_where_it_is_named(suite):
    near = suite.nearest(["docs/howto/point_types.md", "tests/cli/test_command.py"], 1000.0)
    assert near == ["tests/cli/test_command.py", "tests/docs/test_pages.py"]


def test_what_costs_more_than_is_given_is_left_out_but_for_the_nearest(suite):
    assert suite.nearest(["contwalk/storage/seal.py"], 50.0)[0] == "tests/storage/test_seal.py"
    assert "tests/storage/test_files.py" not in suite.nearest(["contwalk/storage/seal.py"], 50.0)
    assert suite.nearest(["contwalk/storage/seal.py"], 0.0) == ["tests/storage/test_seal.py"]


def test_changes_are_those_since_the_branch_left(tmp_path):
    def git(*words: str) -> None:
        identity = ["-c", "user.name=a", "-c", "user.email=a@b", "-c", "commit.gpgsign=false"]
        subprocess.run(["git", *identity, *words], cwd=tmp_path, check=True, capture_output=True)

    git("init", "-b", "main")
    for name in ("kept.py", "committed.py", "edited.py"):
        (tmp_path / name).write_text("", encoding="utf-8")
    git("add", ".")
    git("commit", "-m", "first")
    git("checkout", "-b", "change")
    (tmp_path / "committed.py").write_text("1\n", encoding="utf-8")
    git("commit", "-am", "second")
    (tmp_path / "edited.py").write_text("1\n", encoding="utf-8")
    (tmp_path / "new.py").write_text("1\n", encoding="utf-8")
    assert changed_files("main", tmp_path) == ["committed.py", "edited.py", "new.py"]
    with pytest.raises(SystemExit, match=r"nowhere.*--base"):
        changed_files("nowhere", tmp_path)


def test_of_this_project_a_module_is_near_the_tests_that_mirror_it():
    assert Suite.read(ROOT).nearest(["contwalk/storage/seal.py"], 60.0)[0] == "tests/storage/test_seals.py"
