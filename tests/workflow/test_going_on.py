"""`--resume` with more points, a wider range or other figures: as if it had been asked for from the start."""

from __future__ import annotations

import numpy as np
import pytest

from contwalk.errors import DatabaseError
from contwalk.storage import Hdf5Database, open_database
from contwalk.workflow.run_file.reading import read_run_file
from contwalk.workflow.runner import Reporter, run

pytestmark = pytest.mark.slow

# x = 0 has pitchforks at r = 0 and, from y's part, at r = 2; the branches born at 0 fold back at r = -0.25.
PLUGIN = """\
from contwalk.system import Mode, Parameter, Start, State, System

def field(t, x, p, dx):
    dx[0] = p.r * x[0] + x[0] ** 3 - x[0] ** 5
    dx[1] = (p.r - 2.0) * x[1] - x[1] ** 3

SYSTEM = System(
    "two_forks", states=(State("x"), State("y")), parameters=(Parameter("r", -0.5),),
    modes=(Mode("only", field),), starts=(Start("rest", lambda p: [[0.0, 0.0]]),),
)
"""

RUN = """\
contwalk: 1
system: ./forks.py
start: {equilibrium: rest}
continue: {parameter: r, range: [-1.0, 3.0]}
diagram: {follow: [BP], depth: 1}
"""


@pytest.fixture
def compute(tmp_path):
    (tmp_path / "forks.py").write_text(PLUGIN, encoding="utf-8")
    (tmp_path / "run.yaml").write_text(RUN, encoding="utf-8")

    def computed(output, *overrides, resume=False, reporter=None):
        run_file = read_run_file(tmp_path / "run.yaml", overrides, str(tmp_path / output))
        return run(run_file, resume=resume, figures=False, reporter=reporter)

    return computed


def numbers(branch):
    """All of its rows but what they cost in time, along the branch."""
    names = [name for name in branch.points.dtype.names if name != "seconds"]
    return [branch.points[name].tobytes() for name in names]


def specials(path):
    """Parent, label and place of all special points, without names that depend on the order of branches."""
    with open_database(path) as db:
        found = [(branch.outcome.reason, point) for branch in db for point in branch.special_points]
    # Nine decimals: the errors of all are below 1e-12.
    places = [np.round([p.parameters["r"], *p.state.values()], 9) + 0.0 for _, p in found]
    return sorted((why, p.label, p.kind or "", *at) for (why, p), at in zip(found, places, strict=True))


@pytest.mark.parametrize("points", [5])
def test_more_points_give_the_run_that_had_them(compute, tmp_path, points):
    whole = compute("whole.h5").branches
    first = compute("more.h5", f"continue.max_points={points}")
    assert {branch.outcome.reason for branch in first.branches} >= {"max_points"}
    again = compute("more.h5", resume=True).branches
    assert [branch.outcome for branch in again] == [branch.outcome for branch in whole]
    by_end = {(b.info.parent, numbers(b)[0]): b for b in again}
    for branch in whole:
        # To the last bit, and under the same special point of the same parent.
        assert numbers(branch) == numbers(by_end[branch.info.parent, numbers(branch)[0]])
    with open_database(tmp_path / "more.h5") as db:
        assert "max_points" not in db.header.config
        assert sorted(db.branch_names()) == sorted(branch.name for branch in whole)


def test_a_wider_range_finds_the_same_points(compute, tmp_path):
    compute("whole.h5")
    first = compute("wider.h5", "continue.range=[-0.6, 1.0]")
    assert len(first.branches) == 2
    kept = [numbers(branch) for branch in first.branches]
    again = compute("wider.h5", resume=True)
    assert specials(tmp_path / "wider.h5") == specials(tmp_path / "whole.h5")
    # What was computed stays, between the ends of the first range.
    for branch, before in zip(again.branches, kept, strict=False):
        assert len(before[0]) < len(numbers(branch)[0])
        assert all(part in more for part, more in zip(before[:3], numbers(branch)[:3], strict=True))
    # And again: nothing is left to do.
    content = [numbers(branch) for branch in again.branches]
    assert [numbers(branch) for branch in compute("wider.h5", resume=True).branches] == content


class Stopping(Reporter):
    """Ends the process' work at the n-th point."""

    def __init__(self, number):
        self.left = number

    def point(self, info, parameter, step, unstable, number):
        self.left -= 1
        if self.left == 0:
            raise KeyboardInterrupt


@pytest.mark.drawn(1)
@pytest.mark.parametrize("number", [8, 30])
def test_an_interruption_on_the_wider_way(compute, tmp_path, number):
    compute("whole.h5", "continue.range=[-0.6, 1.0]")
    compute("whole.h5", resume=True)
    compute("cut.h5", "continue.range=[-0.6, 1.0]")
    assert compute("cut.h5", resume=True, reporter=Stopping(number)).interrupted
    compute("cut.h5", resume=True)
    with open_database(tmp_path / "cut.h5") as cut, open_database(tmp_path / "whole.h5") as whole:
        assert cut.branch_names() == whole.branch_names()
        assert [numbers(branch) for branch in cut] == [numbers(branch) for branch in whole]
        assert [branch.outcome for branch in cut] == [branch.outcome for branch in whole]


@pytest.mark.parametrize(
    ("overrides", "said"),
    [
        (
            ["continue.max_points=4"],
            r"\(continue.max_points\). Only max_points and diagram.effort may be raised",
        ),
        (["continue.range=[-0.5, 3.0]"], "continue.range"),
        (["continue.range=[-2.0, 2.5]"], "continue.range"),
        (["continue.direction=up"], "continue.direction"),
        (["diagram=none", "mark={r: [0.5]}"], r"\(diagram, mark\)"),
    ],
)
def test_what_is_another_study(compute, tmp_path, overrides, said):
    compute("run.h5", "continue.max_points=5")
    before = specials(tmp_path / "run.h5")
    with pytest.raises(DatabaseError, match=said) as told:
        compute("run.h5", *["continue.max_points=5", *overrides], resume=True)
    assert "--force" in told.value.remedy
    assert specials(tmp_path / "run.h5") == before


def test_other_figures_are_no_other_study(compute, tmp_path):
    compute("run.h5", "figures=[eigenvalues]")
    compute("run.h5", "figures=[bifurcation_diagram]", resume=True)
    with Hdf5Database.open(tmp_path / "run.h5") as db:
        assert "bifurcation_diagram" in db.header.config
        assert "widened" not in db.header.provenance


# The branch through x = 0 is crossed twice by a loop, which is longer than it.
LOOP = """\
from contwalk.system import Mode, Parameter, Start, State, System

def field(t, x, p, dx):
    dx[0] = x[0] * (1.0 - p.r ** 2 - x[0] ** 2 / 9.0 + 0.1 * x[0])

SYSTEM = System(
    "loop", states=(State("x"),), parameters=(Parameter("r", 0.0),),
    modes=(Mode("only", field),), starts=(Start("rest", lambda p: [[0.0]]),),
)
"""


@pytest.mark.drawn(1)
@pytest.mark.parametrize("points", [40, 70, 150])
def test_a_loop_that_was_cut_before_it_closed_is_one_branch(compute, tmp_path, points):
    """With 70 points it has been begun at both crossings; the second part is the first one's, and dropped."""
    (tmp_path / "forks.py").write_text(LOOP, encoding="utf-8")
    whole = compute("whole.h5", "continue.range=[-2.0, 2.0]").branches
    assert [branch.outcome.reason for branch in whole] == ["bound", "closed"]
    compute("more.h5", "continue.range=[-2.0, 2.0]", f"continue.max_points={points}")
    again = compute("more.h5", "continue.range=[-2.0, 2.0]", resume=True).branches
    assert [numbers(branch) for branch in again] == [numbers(branch) for branch in whole]
    assert [branch.special_points for branch in again] == [branch.special_points for branch in whole]
    assert [branch.outcome for branch in again] == [branch.outcome for branch in whole]
    with open_database(tmp_path / "more.h5") as more, open_database(tmp_path / "whole.h5") as one:
        assert set(one.notes().items()) <= set(more.notes().items())
        assert ("b3 is left out" in str(more.notes())) == (points == 70)


# Folds at mu = -c and c, on one curve with a cusp at a = 0.
CUSP = """\
from contwalk.system import Mode, Parameter, Start, State, System

def field(t, x, p, dx):
    dx[0] = p.r + p.a * x[0] - x[0] ** 3

SYSTEM = System(
    "cusp", states=(State("x"),), parameters=(Parameter("r", -1.0), Parameter("a", 1.0)),
    modes=(Mode("only", field),), starts=(Start("low", lambda p: [[-1.3247]]),),
)
"""


@pytest.mark.drawn(1)
@pytest.mark.parametrize("points", [20, 60, 90])
def test_curves_of_a_study_that_was_cut_are_those_of_the_whole_one(compute, tmp_path, points):
    """With 60 points the curve is begun at both folds, with 20 at one, when the second is not yet found."""
    (tmp_path / "forks.py").write_text(CUSP, encoding="utf-8")
    asked = [
        "start={equilibrium: low}",
        "continue.range=[-1.0, 1.0]",
        "loci={with: a, range: [-1.0, 2.0], of: LP}",
    ]
    whole = compute("whole.h5", *asked).branches
    assert [(branch.name, branch.info.problem) for branch in whole] == [
        ("b1", "equilibrium"),
        ("b2", "locus"),
    ]
    compute("more.h5", *asked, f"continue.max_points={points}")
    again = compute("more.h5", *asked, resume=True).branches
    assert [branch.name for branch in again] == ["b1", "b2"]
    assert [numbers(branch) for branch in again] == [numbers(branch) for branch in whole]
    assert [branch.special_points for branch in again] == [branch.special_points for branch in whole]


@pytest.mark.drawn(1)
@pytest.mark.parametrize("start", [-1.0, 3.0])
def test_a_start_at_an_end_of_the_range_goes_on(compute, start):
    """One direction ends where it begins: that end is not the other direction's."""
    changes = f"parameters.r={start}", "diagram=none"
    (whole,) = compute("whole.h5", *changes).branches
    assert whole.outcome.reason == "bound"
    compute("more.h5", *changes, "continue.max_points=5")
    assert compute("cut.h5", *changes, reporter=Stopping(5)).interrupted
    for output in ("more.h5", "cut.h5"):
        (again,) = compute(output, *changes, resume=True).branches
        assert again.outcome == whole.outcome
        assert numbers(again) == numbers(whole)
        assert [(p.label, p.kind, p.s) for p in again.special_points] == [
            (p.label, p.kind, p.s) for p in whole.special_points
        ]
