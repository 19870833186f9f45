"""Starts whose Newton iteration hops across a jump of a guard or a reset are told with the plugin's line."""

from __future__ import annotations

import pytest
from block_machine import PLUGIN

import contwalk as cw

RUN = """\
contwalk: 1
system: ./block.py
start: START
continue: {parameter: force, range: [LOWEST, 1.6], max_points: 3}
diagram: none
output: OUT
"""
SETTLED = "{simulate: {state: {x: 0.1, v: 0.3}, until: settled}}"
STORED = "{from: first.h5, point: b1/EP1, parameters: {force: FORCE}}"


def started(folder, start, output, lowest=0.9):
    (folder / "run.yaml").write_text(
        RUN.replace("START", start).replace("OUT", output).replace("LOWEST", f"{lowest}")
    )
    return cw.run(cw.read_run_file(folder / "run.yaml"), figures=False).branches[0]


@pytest.mark.parametrize(
    ("old", "new", "force", "what"),
    [
        ("-0.6 * x[1]", "-(0.6 if x[1] < 1.44 else 0.8) * x[1]", "1.1", "reset"),
        ("-0.6 * x[1]", "-(0.6 if x[1] < 1.44 else 0.3) * x[1]", "1.15", "reset"),
        ("return 1.0 - x[0]", "return (1.0 if x[1] < 1.44 else 0.95) - x[0]", "1.07", "guard"),
    ],
)
def test_a_start_that_hops_across_a_jump_tells_its_line(tmp_path, old, new, force, what, monkeypatch):
    """The stored orbit meets the stops slower than what is compared there; where the other one would, it
    does not.
    """
    monkeypatch.chdir(tmp_path)
    source = PLUGIN.replace("CONDITIONS", "").replace("MORE", "").replace(old, new)
    (tmp_path / "block.py").write_text(source)
    line = 1 + source[: source.index("1.44")].count("\n")
    assert len(started(tmp_path, SETTLED, "first.h5")) > 1
    outcome = started(tmp_path, STORED.replace("FORCE", force), "second.h5").outcome
    assert (outcome.status, outcome.reason) == ("failed", "no_convergence")
    assert f"the {what} of transition '" in outcome.message
    assert f"block.py, line {line} (a comparison)" in outcome.message


def test_a_start_that_does_not_converge_for_other_reasons_tells_of_no_jump(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "block.py").write_text(PLUGIN.replace("CONDITIONS", "").replace("MORE", ""))
    started(tmp_path, SETTLED, "first.h5")
    outcome = started(tmp_path, STORED.replace("FORCE", "0.3"), "second.h5", 0.2).outcome
    assert outcome.reason == "no_convergence"
    assert "jumps" not in outcome.message
