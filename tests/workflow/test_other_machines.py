"""A database tells on what it was made, and a run that goes on elsewhere says so and goes on."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import contwalk as cw
from contwalk.storage.backends import backend_of
from contwalk.workflow.machine import kind_of_processor, made_elsewhere

RUN = """
contwalk: 1
system: autobalancer
model: {masses: 2}
preset: heavy
parameters: {omega: 5.0}
start: {equilibrium: balanced, parameters: {delta: 0.0065}}
continue: {parameter: delta, range: [0.003, 0.0065], direction: backward}
diagram: none
output: run.h5
"""


def test_a_resume_on_another_kind_of_processor_says_so_and_goes_on(tmp_path: Path):
    (tmp_path / "run.yaml").write_text(RUN, encoding="utf-8")
    path = tmp_path / "run.h5"
    run_file = cw.read_run_file(tmp_path / "run.yaml", output=str(path))
    cw.run(run_file, figures=False)
    with cw.open_database(path) as db:
        header, rows = db.header, len(db["b1"])
        assert "elsewhere" not in db.notes()
    assert {name: header.provenance[name] for name in kind_of_processor()} == kind_of_processor()
    with backend_of(path).open(path, writable=True) as db:
        db.write_header(replace(header, provenance={**header.provenance, "processor": "another"}))
    cw.run(run_file, resume=True, figures=False)
    with cw.open_database(path) as db:
        note = db.notes()["elsewhere"]
        assert "processor another, now " in note
        assert note.count(".") == note.rstrip(".").count(".") + 1
        assert len(db["b1"]) == rows


def test_what_an_earlier_version_has_not_stored_is_no_other_machine():
    assert made_elsewhere({}) == ""
    assert made_elsewhere(kind_of_processor()) == ""
