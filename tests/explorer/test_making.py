"""What a page tells of how its file was made: enough to make it again, and what is not in it."""

from __future__ import annotations

import pytest
from explorer_pages import CYCLE, blocks, computed

from contwalk.explorer import explored
from contwalk.explorer.making import making_of
from contwalk.storage import open_database


@pytest.fixture(scope="module")
def head(tmp_path_factory):
    with open_database(computed(tmp_path_factory.mktemp("making"), "cycle", CYCLE)) as database:
        return blocks(explored(database).page)["head"][0]


def test_the_run_file_is_there_and_makes_the_same_branches_again(head, tmp_path):
    again = computed(tmp_path, "cycle", head["making"]["config"])
    with open_database(again) as database:
        assert [len(branch) for branch in database.branches()] == [each["count"] for each in head["branches"]]


def test_facts_name_versions_accuracy_equations_and_the_command(head):
    facts = head["making"]["facts"]
    assert facts[0].startswith("Made with contwalk 0.1.0, Python 3.")
    assert facts[1:] == [
        "Requested relative error of special points: 1e-08.",
        "The equations are in the run file below.",
        "To make it again, save the text below as cycle.yaml and run: contwalk continue cycle.yaml",
    ]


def test_labels_have_their_meanings(head):
    assert {label: head["meanings"][label] for label in ("EP", "HB")} == {
        "EP": "end point",
        "HB": "Hopf point",
    }


def test_a_plugin_is_named_and_no_folder_is():
    made = {
        "run_file": "/home/anna/a.yaml",
        "run_file_directory": "/home/anna",
        "plugin_files": {"p.py": "12ab"},
    }
    facts = making_of("system: ./p.py", made | {"system_reference": "./p.py"}, "continue")["facts"]
    assert facts == [
        "The equations are in the plugin p.py, which is not in this page: ask whoever sent it. "
        "Its sha256 is 12ab.",
        "To make it again, save the text below as a.yaml, p.py where it names it, and run: "
        "contwalk continue a.yaml",
    ]


def test_a_file_without_the_text_of_its_run_file_tells_nothing():
    assert making_of("", {}, "continue") == {}
