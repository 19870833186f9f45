"""A damaged database gives the same answer as before, or a refusal; never another answer."""

from __future__ import annotations

from pathlib import Path

import pytest
from damage import answer, flipped, outcomes, truncated

from contwalk.cli.entry import run as command
from contwalk.storage import Hdf5Database
from contwalk.storage.seal import LENGTH, SHORTEST, intact

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
    # All but those that lack some or all of the seal only: a quarter lack up to 200 bytes.
    assert found["refused"] >= 150
    assert found["refused"] + found["same"] == 200


def test_a_file_without_its_seal_or_with_a_part_of_it_is_read(database, tmp_path):
    """A run that is killed after its last branch leaves no seal or a part of it, and all of its rows."""
    content, right = database.read_bytes(), answer(database)
    copy = tmp_path / "run.h5"
    for lost in (1, 2, LENGTH // 2, LENGTH - SHORTEST, LENGTH - 1, LENGTH):
        copy.write_bytes(content[:-lost])
        assert answer(copy) == right, lost
        with Hdf5Database.open(copy, writable=True):
            pass
        assert intact(copy.read_bytes())
        assert answer(copy) == right, lost
    copy.write_bytes(content[: -LENGTH - 1])
    assert answer(copy).startswith("refused")
