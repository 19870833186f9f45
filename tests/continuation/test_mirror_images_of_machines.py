"""Machines with events: the half of a branch that is the image of the other one is as a walk finds it."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from cut_branches import Appended, assert_same, kept
from forced_mirrors import block, half, pair
from hybrid_runs import ACCURACY, opened

from contwalk.continuation.settings import Settings
from contwalk.diagram.branch_in_progress import Start
from contwalk.diagram.diagram import Diagram, Noted, Plan
from contwalk.problems.orbit import mirror as mirrors

# Machine, half periods of the forcing in half a cycle, a value with a symmetric orbit, and a range that
# passes the value at which the symmetry is lost; of the pair, one of its stops is grazed in it as well.
CASES = {"block": (True, 3, 2.8, (2.5, 3.6)), "pair": (False, 1, 18.0, (17.0, 28.0))}


def made(name, stored=None, **given):
    """The symmetric orbits and those that leave them, with notes and events."""
    rocks, n, beta, span = CASES[name]
    system, state = block() if rocks else pair(), half(beta, n, rocks).at_zero
    mode = ("right" if state[0] > 0.0 else "left") if rocks else "free"
    settings = Settings(range=span, max_points=60, max_step=0.2, **given)
    opening = opened(system, "beta", list(state), {"beta": beta}, mode=mode, settings=settings)
    values = system.defaults() | {"beta": beta}
    diagram = Diagram(
        [Start(system, "beta", values, opening, "start", orbit=True)],
        Plan(settings, frozenset({"BP"}), 1),
        restore=(stored or {}).get,
    )
    events = list(diagram.events())
    return diagram.branches, [e.text for e in events if isinstance(e, Noted)], events


@cache
def known(name):
    return made(name)


@cache
def walked(name):
    return made(name, mirror_images="walked")


@pytest.mark.long
@pytest.mark.parametrize("name", CASES)
def test_rows_are_those_that_a_walk_finds(name):
    (_, branch), notes, _ = known(name)
    (_, other), others, _ = walked(name)
    assert any("the image of the other one under the symmetry 'inversion'" in note for note in notes)
    assert not any("inversion" in note for note in others)
    assert branch.info.settings["mirror"] == ("inversion",)
    a, b = branch.points, other.points
    images = (a["s"] < 0.0) & (a["iterations"] == 0) & ~a["special"]
    assert np.sum(images) > 5
    assert np.max(a["residual"][images]) <= 20.0
    # Steps differ in their last digits: rows are compared where both have one, at an end or a located point.
    label = "PD" if name == "pair" else "EP"
    mine, its = (next(p.index for p in own.special_points if p.label == label) for own in (branch, other))
    a, b = a[mine], b[its]
    assert a["s"] < 0.0
    assert a["admissible"] == b["admissible"]
    for column in ("free", "unknowns", "observables", "period", "spectrum"):
        assert a[column] == pytest.approx(b[column], rel=1e-6, abs=1e-7, nan_ok=True), column


@pytest.mark.drawn(1)
@pytest.mark.parametrize("name", CASES)
def test_special_points_are_those_that_a_walk_locates(name):
    (_, branch), _, _ = known(name)
    (_, other), _, _ = walked(name)
    assert [p.name for p in branch.special_points] == [p.name for p in other.special_points]
    for a, b in zip(branch.special_points, other.special_points, strict=True):
        assert (a.label, a.kind, a.status, a.criticality) == (b.label, b.kind, b.status, b.criticality)
        assert (a.unstable_before, a.unstable_after) == (b.unstable_before, b.unstable_after)
        assert a.admissible == b.admissible
        known_to = max((a.error or 0.0) + (b.error or 0.0), 1e-14)
        assert abs(a.parameters["beta"] - b.parameters["beta"]) <= known_to
        assert list(a.state.values()) == pytest.approx(list(b.state.values()), rel=1e-7, abs=1e-7)
        assert a.margin.keys() == b.margin.keys()
        for condition, value in b.margin.items():
            assert a.margin[condition] == pytest.approx(value, rel=1e-5, abs=1e-7, nan_ok=True), condition
        if "c" in b.coefficients:
            assert a.coefficients["c"] == pytest.approx(b.coefficients["c"], rel=1e-6)


@pytest.mark.parametrize("name", CASES)
def test_legs_change_places(name):
    """Durations of the two legs, and states with their signs, are exchanged from one half to the other."""
    (_, branch), _, _ = known(name)
    rows = branch.points[~branch["special"]]
    ahead, behind = rows[rows["s"] > 0.0], rows[rows["s"] < 0.0][::-1]
    n = min(len(ahead), len(behind)) - 1
    for a, b in zip(ahead[:n], behind[:n], strict=True):
        assert b["unknowns"][:4] == pytest.approx(-np.roll(a["unknowns"][:4], 2), abs=100.0 * ACCURACY)
        assert b["unknowns"][4:6] == pytest.approx(a["unknowns"][4:6][::-1], rel=100.0 * ACCURACY)


def test_a_limit_is_located_by_a_walk_of_its_own():
    """Limits are told by names of events, which are other ones on the image."""
    (_, branch), notes, _ = known("pair")
    grazings = [p for p in branch.special_points if p.label == "GR"]
    assert len(grazings) == 2
    assert "'high' is touched" in grazings[0].note + grazings[1].note
    assert "'low' is touched" in grazings[0].note + grazings[1].note
    assert any("a limit (GR) has to be located" in note for note in notes)


@pytest.mark.long
@pytest.mark.parametrize("trusted", [True, False])
def test_a_run_that_is_killed_goes_on_to_the_same_bits(trusted, monkeypatch):
    if not trusted:
        own = mirrors.OrbitMirror.row
        limited = lambda self, row, *more: None if row["s"] > 0.5 else own(self, row, *more)  # noqa: E731
        monkeypatch.setattr(mirrors.OrbitMirror, "row", limited)
    whole, notes, events = made("pair") if not trusted else known("pair")
    assert any("do not satisfy" in note for note in notes) == (not trusted)
    appended = Appended.of(events, "b2")
    images = appended.images
    for k in (images[0] - 1, images[0], images[len(images) // 2], images[-2]):
        again, _, _ = made("pair", {"b1": kept(whole[0]), "b2": appended.cut(k)})
        assert_same(again[1], whole[1], k)
