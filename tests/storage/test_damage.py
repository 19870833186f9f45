"""A damaged database gives the same answer as before, or a refusal; never another answer."""

from __future__ import annotations

from pathlib import Path

import pytest
from damage import answer, flipped, outcomes, truncated

from contwalk.cli.entry import run as command
from contwalk.storage.seal import LENGTH, SHORTEST

SMOOTH = """\
contwalk: 1
system: autobalancer
start: {equilibrium: all}
continue: {parameter: delta, range: [0.002, 0.008], max_points: 20}
diagram: none
output: run.h5
"""

FORCED = """\
from contwalk.system import Mode, Parameter, State, System

def field(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = p.f * np.cos(t) - x[0] - 0.2 * x[1] - x[0] ** 3

SYSTEM = System(
    "shaken", states=(State("x"), State("v")), parameters=(Parameter("f", 0.5),),
    modes=(Mode("only", field),), period=lambda p: 2.0 * np.pi,
)
"""

ORBITS = """\
contwalk: 1
system: ./shaken.py
start: {simulate: {state: {x: 0.1, v: 0.0}, until: settled}}
continue: {parameter: f, range: [0.3, 0.8], max_points: 8}
mark: {f: [0.6]}
diagram: none
output: run.h5
"""

HYBRID = """\
contwalk: 1
system: rimless_wheel
parameters: {gamma: 0.1}
start: {simulate: {state: {theta: -0.2, omega_: 1.5}, until: settled}}
continue: {parameter: gamma, range: [0.08, 0.12], max_points: 6}
diagram: none
output: run.h5
"""

KINDS = {"smooth": SMOOTH, "orbit": ORBITS, "hybrid": HYBRID}


@pytest.fixture(scope="module", params=KINDS)
def database(request, tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp(request.param)
    (folder / "shaken.py").write_text("import numpy as np\n" + FORCED, encoding="utf-8")
    (folder / "run.yaml").write_text(KINDS[request.param], encoding="utf-8")
    path = folder / "run.h5"
    assert command(["continue", str(folder / "run.yaml"), "--quiet", "--output", str(path)]) == 0
    return path


def test_flipped_bits_and_missing_ends(database):
    """1000 flips and 200 cuts of each."""
    content = database.read_bytes()
    found = outcomes(database, flipped(content, 1000, seed=1))
    # A flip in the mark of the seal makes it no seal; everything else is covered.
    assert found["another"] == 0
    assert found["refused"] >= 950
    found = outcomes(database, truncated(content, 200, seed=2))
    assert found["another"] == 0
    assert found["refused"] >= 190  # all but those that lack the seal, or all but its first bytes


def test_all_of_the_seal_may_be_missing_and_no_part_of_it(database, tmp_path):
    """A run that is killed after its last branch leaves no seal; a copy that was cut short is refused."""
    content, right = database.read_bytes(), answer(database)
    copy = tmp_path / "run.h5"
    copy.write_bytes(content[:-LENGTH])
    assert answer(copy) == right
    for lost in (1, 2, LENGTH // 2, LENGTH - SHORTEST, LENGTH + 1):
        copy.write_bytes(content[:-lost])
        assert answer(copy).startswith("refused")
