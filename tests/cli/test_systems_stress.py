"""`contwalk systems stress`: a line for each change of units, order and accuracy."""

from __future__ import annotations

import json

import pytest

FOLLOWED = """\
system: ./fork.py
start: {equilibrium: upright}
continue: {parameter: r, range: [-1.0, 1.0]}
diagram: {follow: [BP]}
"""


@pytest.fixture
def few(monkeypatch):
    """Only the first of the changes: what each does is for other tests."""
    from contwalk.workflow.stress import stressing

    every = stressing.cases_of
    monkeypatch.setattr(stressing, "cases_of", lambda system: every(system)[:1])


@pytest.mark.slow
def test_a_line_for_each_change(contwalk, folder):
    (folder / "followed.yaml").write_text(FOLLOWED, encoding="utf-8")
    done = contwalk("systems", "stress", "followed.yaml")
    assert (done.code, done.err) == (0, "")
    head, *lines = done.out.splitlines()
    assert head == "fork, along r; A is the study as it is"
    assert len(lines) == 12
    assert [line[33:41].strip() for line in lines] == ["same"] * 12
    assert lines[1].startswith("states in units of 1e-6 ")
    assert all("1 point " in line for line in lines)
    assert not list(folder.glob("*.h5"))  # databases are temporary


def test_a_plugin_is_put_to_the_study_that_init_would_write(contwalk, folder, few):
    done = contwalk("systems", "stress", "./fork.py", "--json")
    assert (done.code, done.err) == (0, "")
    document = json.loads(done.out)
    assert (document["stress_version"], document["system"], document["same"]) == (1, "fork", True)
    assert [result["case"] for result in document["results"]] == ["as it is", "states in units of 1e-6"]
    assert document["results"][0]["sentences"] == []


def test_bad_input(contwalk, folder):
    assert contwalk("systems", "stress", "nothing").code == 2
    assert contwalk("systems", "stress", "run.yaml", "--set", "masses=3").code == 2
    text = (folder / "run.yaml").read_text(encoding="utf-8")
    (folder / "run.yaml").write_text(text.replace("upright", "nowhere"), encoding="utf-8")
    assert contwalk("systems", "stress", "run.yaml").code == 2
