"""An observable that is no number at some points: stored as it is, and one sentence says so."""

from __future__ import annotations

import numpy as np

from contwalk.storage import open_database
from contwalk.workflow.run_file.reading import read_run_file
from contwalk.workflow.runner import Reporter, run

PLUGIN = """\
import numpy as np
from contwalk.system import Mode, Observable, Parameter, Start, State, System

def field(t, x, p, dx):
    dx[0] = p.a - x[0]

SYSTEM = System(
    "line", states=(State("x"),), parameters=(Parameter("a", 1.0),), modes=(Mode("only", field),),
    starts=(Start("rest", lambda p: [[p.a]]),),
    observables=(
        Observable("root", lambda t, x, p: np.sqrt(x[0, 0])),
        Observable("twice", lambda t, x, p: 2 * x[0, 0]),
    ),
)
"""
RUN = """\
contwalk: 1
system: ./line.py
start: {equilibrium: rest}
continue: {parameter: a, range: [-1.0, 2.0]}
"""


class Kept(Reporter):
    def __init__(self):
        self.notes = []

    def note(self, text):
        self.notes.append(text)


def test_it_is_told_where_and_how_often(tmp_path):
    (tmp_path / "line.py").write_text(PLUGIN)
    (tmp_path / "run.yaml").write_text(RUN)
    kept = Kept()
    found = run(read_run_file(tmp_path / "run.yaml", output=str(tmp_path / "out.h5")), reporter=kept)
    with open_database(found.path) as db:
        (branch,) = db
        notes = list(db.notes().values())
    lacking = branch["a"] < 0.0
    assert np.all(np.isnan(branch["root"]) == lacking)
    assert np.any(lacking)
    (told,) = [note for note in kept.notes if "root" in note]
    assert told in notes
    assert f"not a number at {lacking.sum()} of {len(lacking)} points" in told
    assert not [note for note in kept.notes if "twice" in note]
