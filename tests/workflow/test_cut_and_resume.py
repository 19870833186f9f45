"""Runs that are cut at each of their first reports and go on: the same diagram to the last bit.

A report comes after the row of a point is stored, and another one after its record: the places at which a
kill finds a start without its mark, a mark's row without its record, a branch without an end.
"""

from __future__ import annotations

import contextlib

import numpy as np
import pytest
from killed_runs import FORK_PLUGIN, assert_same

from contwalk.storage import open_database
from contwalk.workflow.run_file.reading import read_run_file
from contwalk.workflow.runner import Reporter, run

pytestmark = pytest.mark.slow

# The start is at two marks itself, of the parameter and of an observable.
RUN = """
contwalk: 1
system: ./fork.py
start: {state: {x: 0.0, y: -0.5}}
continue: {parameter: mu, range: [-0.6, 0.4]}
mark: {mu: [-0.5, -0.45], max_re: [-0.5]}
engine: {step: 0.05}
"""


class Cut(BaseException):
    """Ends a run as a kill would: nothing catches it."""


class Cutting(Reporter):
    """Cuts at the report of a number, and counts them."""

    def __init__(self, number: int) -> None:
        self.left = number
        self.told: list[str] = []

    def _count(self, what: str) -> None:
        self.told.append(what)
        self.left -= 1
        if self.left == 0:
            raise Cut

    def point(self, info, parameter, step, unstable, number):
        self._count("point")

    def special(self, info, point):
        self._count(point.label)


def study(folder, output, number=0, **rest):
    reporter = Cutting(number)
    file = read_run_file(folder / "run.yaml", output=str(folder / output))
    with contextlib.suppress(Cut):
        run(file, figures=False, reporter=reporter, **rest)
    return reporter.told


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    path = tmp_path_factory.mktemp("cut")
    (path / "fork.py").write_text(FORK_PLUGIN)
    (path / "run.yaml").write_text(RUN)
    return path


@pytest.fixture(scope="module")
def whole(folder):
    """What an uninterrupted run reports."""
    return study(folder, "whole.h5")


def test_the_start_has_marks_of_its_own(whole):
    assert whole[:5] == ["point", "point", "UZ", "point", "UZ"]


@pytest.mark.drawn(3)
@pytest.mark.parametrize("number", [*range(1, 9), 40, 41, 42])
def test_a_run_that_is_cut_goes_on_to_the_same_diagram(folder, whole, number):
    output = f"cut{number}.h5"
    told = study(folder, output, number)
    assert told == whole[:number]
    study(folder, output, resume=True)
    assert_same(folder / "whole.h5", folder / output)


@pytest.mark.long
def test_a_run_that_is_cut_again_and_again_goes_on_to_the_same_diagram(folder, whole):
    for _ in range(len(whole) // 15):  # each time it gets on by 14 reports or so
        study(folder, "often.h5", 15, resume=True)
    study(folder, "often.h5", resume=True)
    assert_same(folder / "whole.h5", folder / "often.h5")


LOOP = """
from contwalk.system import Mode, Parameter, State, System

def field(t, x, p, dx):
    dx[0] = 1.0 - p.mu**2 - (x[0] - 0.1) ** 2 / 4.0

SYSTEM = System(
    name="loop",
    states=(State("x"),),
    parameters=(Parameter("mu", 0.0),),
    modes=(Mode("smooth", field),),
)
"""
CLOSED = """
contwalk: 1
system: ./loop.py
start: {state: {x: 2.1}}
continue: {parameter: mu, range: [-2.0, 2.0]}
"""


def test_a_closed_branch_that_is_cut_closes_at_its_own_start(tmp_path):
    """Not where it was taken up again, a whole turn later."""
    (tmp_path / "loop.py").write_text(LOOP)
    (tmp_path / "run.yaml").write_text(CLOSED)
    whole = study(tmp_path, "whole.h5")
    for number in (2, 5, len(whole) // 2, len(whole) - 2):
        output = f"cut{number}.h5"
        assert study(tmp_path, output, number) == whole[:number]
        study(tmp_path, output, resume=True)
        assert_same(tmp_path / "whole.h5", tmp_path / output)


GROWING = """
from contwalk.system import Mode, Parameter, State, System

def field(t, x, p, dx):
    growth = 1.0 - x[0] ** 2 - x[1] ** 2
    dx[0] = growth * x[0] - x[1]
    dx[1] = growth * x[1] + x[0]
    dx[2] = p.a * x[2] - x[2] ** 3 + x[0]

SYSTEM = System(
    name="growing",
    states=(State("x"), State("y"), State("z")),
    parameters=(Parameter("a", -0.5),),
    modes=(Mode("smooth", field),),
)
"""
# Deviations grow by exp(2 pi a), about, so that the orbit is cut into 2 and 4 segments on the way.
STRETCHED = """
contwalk: 1
system: ./growing.py
start: {simulate: {state: {x: 1.0, y: 0.0, z: 0.0}, until: settled}}
continue: {parameter: a, range: [-0.5, 4.0], direction: forward}
diagram: none
"""


REPELLING = """
import numpy as np

from contwalk.system import Mode, Parameter, State, System, Transition

def field(t, x, p, dx):
    dx[0] = x[0] - np.sin(x[1]) - np.cos(x[1])
    dx[1] = -1.0

def leaves(t, x, p):
    return 1.0 - x[0] + np.sin(x[1])

def set_anew(t, x, p, after):
    after[0] = p.a + 0.1 * x[1]
    after[1] = 0.0

SYSTEM = System(
    name="growing",
    states=(State("x"), State("y")),
    parameters=(Parameter("a", 0.5),),
    modes=(Mode("near", field),),
    transitions=(Transition("leaves", "near", "near", leaves, reset=set_anew),),
)
"""
# The leg lasts about 10 a, over which deviations grow by its exponential.
STRETCHED_LEG = """
contwalk: 1
system: ./growing.py
start: {simulate: {state: {x: 0.4, y: 0.0}, until: settled}}
continue: {parameter: a, range: [0.3, 2.6], direction: backward}
diagram: none
"""


@pytest.mark.drawn(1)
@pytest.mark.parametrize(("plugin", "run_file"), [(GROWING, STRETCHED), (REPELLING, STRETCHED_LEG)])
def test_a_run_that_is_cut_where_its_orbit_is_cut_into_segments_goes_on_to_the_same_diagram(
    tmp_path, plugin, run_file
):
    (tmp_path / "growing.py").write_text(plugin)
    (tmp_path / "run.yaml").write_text(run_file)
    whole = study(tmp_path, "whole.h5")
    with open_database(tmp_path / "whole.h5") as db:
        (branch,) = db.branches()
    unknowns = np.isfinite(branch.points["unknowns"]).sum(axis=1)
    cuts = np.flatnonzero(np.diff(unknowns)) + 1
    assert len(cuts) == 2
    for row in cuts:
        number = whole.index("point") + int(row) + 1  # the report of that row
        output = f"cut{row}.h5"
        assert study(tmp_path, output, number) == whole[:number]
        study(tmp_path, output, resume=True)
        assert_same(tmp_path / "whole.h5", tmp_path / output)
