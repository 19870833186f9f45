"""Reason codes: which end is which, what follows from it, and what a stored one becomes."""

import numpy as np
import pytest
from small_systems import labelled, small_system

import contwalk as cw
from contwalk.branch import BranchInfo, Outcome, SpecialPoint
from contwalk.continuation.settings import Settings
from contwalk.diagram.branch_in_progress import BranchInProgress, Start, Stored, goes_on, restored, spent
from contwalk.diagram.diagram import Diagram, Plan
from contwalk.diagram.events import Found
from contwalk.problems.orbit.points.catalogue import LIMIT_TYPES
from contwalk.storage.schema import outcome_from_text, outcome_text, special_from_text, special_text
from contwalk.studies.opening_orbits import opened_orbit


def born_above(t, x, p, dx):
    """Stuart-Landau in nu = 1 - mu: the cycle r^2 = 1 - nu shrinks as nu grows to 1."""
    mu = 1.0 - p.nu - x[0] ** 2 - x[1] ** 2
    dx[0] = mu * x[0] - 2.0 * x[1]
    dx[1] = 2.0 * x[0] + mu * x[1]


def shrinking_start():
    system = small_system(born_above, "xy", {"nu": 0.9})
    settings = Settings(range=(0.7, 1.2))
    opening = opened_orbit(
        system, {"nu": 0.9}, "nu", np.array([np.sqrt(0.1), 0.0]), settings, None, period=np.pi
    )
    return Start(system, "nu", {"nu": 0.9}, opening, "start"), Plan(settings, frozenset(), 0)


def test_a_family_that_shrinks_in_one_direction_is_walked_in_the_other():
    problem = cw.PeriodicOrbit(small_system(born_above, "xy", {"nu": 0.9}), {"nu": 0.9}, "nu")
    branch = cw.continue_branch(problem, [np.sqrt(0.1), 0.0], (0.7, 1.2), period=np.pi)
    assert {q.kind for q in labelled(branch, "EP")} == {"bound", "shrunk"}
    assert branch["nu"].min() == 0.7
    # the last orbit is at most a step, a 64th of the range, before the Hopf point
    assert branch["nu"].max() == pytest.approx(1.0, abs=0.5 / 64)


def test_a_run_killed_between_the_directions_walks_the_second_one():
    start, plan = shrinking_start()
    whole = [e for e in Diagram([start], plan).events() if isinstance(e, Found)]
    first = next(k for k, e in enumerate(whole) if e.special is not None and e.special.label == "EP") + 1
    rows = np.concatenate([e.row for e in whole[:first] if e.row is not None])
    specials = [e.special for e in whole[:first] if e.special is not None]
    assert [p.kind for p in specials] == ["shrunk"]
    start, plan = shrinking_start()
    diagram = Diagram([start], plan, lambda name: Stored(rows, specials, None))
    again = [e for e in diagram.events() if isinstance(e, Found)]
    rest = whole[first:]
    assert len(again) == len(rest) > 3
    for ours, theirs in zip(again, rest, strict=True):
        for column in ("s", "free", "unknowns", "tangent"):
            if theirs.row is not None:
                assert ours.row[column].tobytes() == theirs.row[column].tobytes()
    assert [p.kind for p in labelled(diagram.branches[0], "EP")] == ["bound", "shrunk"]


def end(kind, s=0.5, label="EP", note=None):
    return SpecialPoint(label, s, kind=kind, note=note)


STATUS = {
    "bound": "complete",
    "closed": "complete",
    "shrunk": "complete",
    "rejoined": "complete",
    "unbounded": "complete",
    "max_points": "stopped",
    "stop_at": "stopped",
    "homoclinic": "stopped",
    "grazing": "stopped",
    "order_change": "stopped",
    "inadmissible": "stopped",
    "step_too_small": "failed",
    "not_finite": "failed",
    "plugin_error": "failed",
}


@pytest.mark.parametrize("kind", STATUS)
def test_a_stored_end_has_its_status_again(kind):
    told = restored(end(kind, note="A sentence."), False)
    assert told == Outcome(STATUS[kind], kind, "A sentence.")


@pytest.mark.parametrize(
    ("kind", "events", "expected"),
    [
        ("grazing", {"GR": "switch"}, True),
        ("grazing", {"GR": "stop", "OC": "switch"}, False),
        ("order_change", {"OC": "switch"}, True),
        ("order_change", {"OC": "stop"}, False),
        ("bound", {"GR": "switch"}, False),
    ],
)
def test_where_a_diagram_goes_on_beyond_an_end(kind, events, expected):
    assert goes_on(LIMIT_TYPES, end(kind), events) is expected


@pytest.mark.parametrize(
    ("note", "today"),
    [
        ("The branch is closed: it came back to its start. Nothing to do.", "closed"),
        ("The orbit shrinks onto an equilibrium, at a Hopf point near b = 0.84: it ends.", "shrunk"),
        ("The orbit has become its parent's again: the branch ends on it. Nothing to do.", "rejoined"),
    ],
)
def test_files_from_before_the_codes_are_read_with_them(note, today):
    assert special_from_text(special_text(end("closed", note=note))).kind == today
    outcome, _ = outcome_from_text(outcome_text(Outcome("complete", "closed", note), {}))
    assert (outcome.status, outcome.reason) == ("complete", today)


def test_each_direction_has_points_of_its_own():
    info = BranchInfo("b1", "equilibrium", ("x",), (), ("lam",), {}, 1, 1)
    rows = np.zeros(6, dtype=info.point_dtype())
    rows["s"] = [0.0, 0.0, 0.1, 0.2, 0.3, -0.1]  # the start, a mark there, three forward, one backward
    work = BranchInProgress(info, [rows[i : i + 1] for i in range(6)])
    assert (spent(work, 1.0), spent(work, -1.0)) == (5, 3)
