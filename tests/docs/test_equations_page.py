"""docs/reference/equations.md: its text is a system, its run file finds what the model is known for."""

from __future__ import annotations

import pytest
from code_blocks import ROOT, blocks, run_python

import contwalk as cw
from contwalk.workflow.run_file.reading import read_run_text
from contwalk.workflow.runner import run

PAGE = ROOT / "docs" / "reference" / "equations.md"


def test_the_text_is_a_system():
    (text,) = blocks(PAGE, "text")
    system = cw.system_from_text(text)
    assert system.about == "Bouncing on a spring, with a stop"
    assert [entry.name for entry in (*system.signals, *system.transitions)] == ["energy", "hit"]


def test_python_finds_it_in_few_lines(tmp_path):
    (program,) = blocks(PAGE, "python")
    said = run_python(program, tmp_path).splitlines()
    assert said[1].startswith("b1: ")
    assert float(said[-1]) == pytest.approx(2.0, abs=1e-12)
    assert (tmp_path / "brusselator.png").exists()


def test_the_study_finds_the_hopf_point(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (text,) = blocks(PAGE, "yaml")
    result = run(read_run_text(text, "study.yaml"))
    assert [point.name for point in result.branches[0].special_points] == ["EP1", "HB1", "EP2"]
