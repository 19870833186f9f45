"""The half of a branch that is an image of the other one is not walked: it is stored as a walk finds it."""

from __future__ import annotations

import math

import numpy as np
import pytest
from cut_branches import Appended, assert_same, kept
from small_systems import labelled, small_problem, small_system

import contwalk as cw
from contwalk.continuation.settings import Mark, Settings
from contwalk.diagram.branch_in_progress import Start
from contwalk.diagram.diagram import Diagram, Noted, Plan
from contwalk.problems.equilibrium import mirror as mirrors
from contwalk.studies.opening import opened
from contwalk.system import Observable, State, Symmetry
from contwalk.system.declarations import ParameterValues


def lorenz(t, x, p, dx):
    dx[0] = 10.0 * (x[1] - x[0])
    dx[1] = p.rho * x[0] - x[1] - x[0] * x[2]
    dx[2] = x[0] * x[1] - 8.0 / 3.0 * x[2]


def half_turn(t, x, p, image):
    image[0], image[1], image[2] = -x[0], -x[1], x[2]


def two_unlike(t, x, p, dx):
    """Two genes that repress each other (a toggle switch); x1 is measured in halves of x0's unit."""
    a, b = x[0], 0.5 * x[1]
    dx[0] = p.mu / (1.0 + b**2) - a
    dx[1] = 2.0 * (p.mu / (1.0 + a**2) - b)
    dx[2] = a * b - x[2]


def exchanged(t, x, p, image):
    image[0], image[1], image[2] = 0.5 * x[1], 2.0 * x[0], x[2]


def hoop(t, x, p, dx):
    """A bead on a hoop that spins: the place pi at the top, and a slow wind."""
    dx[0] = x[1]
    dx[1] = math.sin(x[0]) * (1.0 + p.w * math.cos(x[0])) - 0.3 * x[1]


def other_side(t, x, p, image):
    image[0], image[1] = -x[0], -x[1]


def ring(t, x, p, dx):
    """Three cells in a ring with the exchanges of neighbours: two branches, one of which folds."""
    total = x[0] + x[1] + x[2]
    for i in range(3):
        dx[i] = p.mu * x[i] - x[i] ** 3 - 0.4 * total


def flipped(t, x, p, image):
    for i in range(3):
        image[i] = -x[i]


def swapped(t, x, p, image):
    image[0], image[1], image[2] = x[1], x[0], x[2]


def folding(t, x, p, dx):
    """A subcritical pitchfork that folds twice, with a state that follows."""
    dx[0] = p.mu * x[0] + 2.0 * x[0] ** 3 - x[0] ** 5
    dx[1] = x[0] ** 2 - x[1] + 0.3 * p.mu


def reflected(t, x, p, image):
    image[0], image[1] = -x[0], x[1]


SYSTEMS = {
    "lorenz": (lorenz, "xyz", "rho", (0.5, 30.0), [0.0, 0.0, 0.0], [("mirror", "spatial", half_turn)]),
    "units": (two_unlike, "xyz", "mu", (0.2, 4.0), [0.19, 0.38, 0.04], [("cells", "relabel", exchanged)]),
    "folding": (folding, "xy", "mu", (-1.5, 1.0), [0.0, -0.3], [("reflection", "spatial", reflected)]),
    "ring": (
        ring,
        "xyz",
        "mu",
        (-0.5, 2.0),
        [0.0, 0.0, 0.0],
        [("swap", "relabel", swapped), ("sign", "spatial", flipped)],
    ),
    "hoop": (
        hoop,
        [State("angle", period=2.0 * math.pi), State("rate")],
        "w",
        (0.2, 3.0),
        [math.pi, 0.0],
        [("sides", "spatial", other_side)],
    ),
}


def start_of(name, settings):
    field, states, free, _, state, symmetries = SYSTEMS[name]
    declared = tuple(Symmetry(*symmetry) for symmetry in symmetries)
    system = small_system(field, states, {free: settings.range[0]}, symmetries=declared)
    values = system.defaults()
    opening = opened(system, values, free, np.array(state), settings)
    return Start(system, free, values, opening, "start")


def made(name, **given):
    """The diagram of a system and the notes of it."""
    settings = Settings(range=SYSTEMS[name][3], **given)
    diagram = Diagram([start_of(name, settings)], Plan(settings, frozenset({"BP"}), 2))
    notes = [event.text for event in diagram.events() if isinstance(event, Noted)]
    return diagram.branches, notes


def not_walked(notes):
    return [note.split(":")[0] for note in notes if "It was not computed" in note]


@pytest.fixture(scope="module", params=list(SYSTEMS))
def both(request):
    return request.param, made(request.param), made(request.param, mirror_images="walked")


# A walk of the other half steps otherwise where states are measured from elsewhere than their symmetric
# place, or in units that the symmetry exchanges: there images are compared with the equations alone.
STEPS_OTHERWISE = ("units", "hoop")


@pytest.mark.drawn(1)
def test_images_have_the_rows_that_a_walk_finds(both):
    name, (branches, notes), (walked, other_notes) = both
    assert not_walked(notes)
    assert not not_walked(other_notes)
    for branch, other in zip(branches, walked, strict=True):
        a, b = branch.points, other.points
        if branch.name not in not_walked(notes) or name in STEPS_OTHERWISE:
            continue
        assert np.array_equal(a["unstable"], b["unstable"])
        assert np.array_equal(a["special"], b["special"])
        for column in ("s", "free", "state", "tangent", "weights", "spectrum", "observables"):
            scale = np.maximum(np.max(np.abs(b[column]), axis=0), 1e-6)
            assert np.max(np.abs(a[column] - b[column]) / scale) < 1e-7, column


def test_images_satisfy_the_equations_and_face_along_the_branch(both):
    name, (branches, notes), _ = both
    field, _, free, *_ = SYSTEMS[name]
    for branch in (b for b in branches if b.name in not_walked(notes)):
        rows = branch.points[branch["s"] < 0.0]
        assert np.all(rows["iterations"] == 0)
        for row in rows:
            rates = np.zeros(len(row["state"]))
            field(0.0, row["state"], ParameterValues(**{free: row["free"][0]}), rates)
            assert np.max(np.abs(rates)) < 1e-12
            assert np.linalg.norm(row["tangent"] / row["weights"]) == pytest.approx(1.0, abs=1e-12)
        regular = rows[~rows["special"]]
        chords = np.diff(np.column_stack([regular["unknowns"], regular["free"]]), axis=0)
        along = np.sum(chords * regular["tangent"][1:] / regular["weights"][1:] ** 2, axis=1)
        assert np.all(along > 0.0)


def test_images_of_special_points_are_as_a_walk_locates_them(both):
    _, (branches, _), (walked, _) = both
    for branch, other in zip(branches, walked, strict=True):
        free = branch.info.free[0]
        assert [p.name for p in branch.special_points] == [p.name for p in other.special_points]
        for a, b in zip(branch.special_points, other.special_points, strict=True):
            assert (a.label, a.kind, a.status, a.criticality) == (b.label, b.kind, b.status, b.criticality)
            assert (a.unstable_before, a.unstable_after) == (b.unstable_before, b.unstable_after)
            known = (a.error or 0.0) + (b.error or 0.0)
            assert abs(a.parameters[free] - b.parameters[free]) <= known
            assert list(a.state.values()) == pytest.approx(list(b.state.values()), rel=1e-7, abs=1e-7)
            for key, value in b.coefficients.items():
                if isinstance(value, float) and not key.endswith("_error"):
                    assert a.coefficients[key] == pytest.approx(value, rel=1e-7, abs=1e-9), (a.name, key)


def test_a_branch_tells_the_symmetry_of_its_halves():
    branches, notes = made("lorenz")
    assert branches[0].info.settings.get("mirror") is None
    assert branches[1].info.settings["mirror"] == ("mirror",)
    (note,) = notes
    assert "the image of the other one under the symmetry 'mirror'" in note
    assert "parameter" not in note


@pytest.mark.long
def test_without_the_symmetry_both_halves_are_walked():
    problem = small_problem(lorenz, "xyz", {"rho": 0.5}, "rho")
    straight = cw.continue_branch(problem, [0.0, 0.0, 0.0], (0.5, 30.0))
    branch = cw.switch_branch(problem, straight, "BP1", (0.5, 30.0))
    known = made("lorenz")[0][1]
    assert len(branch) == len(known)
    assert np.all(branch["iterations"][(branch["s"] < -0.1) & ~branch["special"]] > 0)
    for a, b in zip(labelled(branch, "HB"), labelled(known, "HB"), strict=True):
        assert a.parameters["rho"] == pytest.approx(b.parameters["rho"], abs=a.error + b.error)
        assert a.coefficients["l1"] == pytest.approx(b.coefficients["l1"], rel=1e-9)


@pytest.mark.long
def test_a_mark_that_is_not_the_same_on_the_image_is_looked_for_there():
    """x = -2 is met on the half of negative x only; the square of x on both."""
    system = small_system(
        folding,
        "xy",
        {"mu": -0.9},
        symmetries=(Symmetry("reflection", "spatial", reflected),),
        observables=(
            Observable("place", lambda t, x, p: x[0, 0]),
            Observable("square", lambda t, x, p: x[0, 0] ** 2),
        ),
    )
    found = {}
    for name, level in (("place", -1.2), ("square", 1.44)):
        settings = Settings(range=(-1.5, 1.0), marks=(Mark(name, (level,)),))
        values = system.defaults()
        opening = opened(system, values, "mu", np.array([0.0, -0.27]), settings)
        diagram = Diagram([Start(system, "mu", values, opening, "start")], Plan(settings))
        notes = [event.text for event in diagram.events() if isinstance(event, Noted)]
        found[name] = notes, labelled(diagram.branches[1], "UZ")
    notes, points = found["place"]
    assert not not_walked(notes)
    assert "'place', which is looked for, is not the same there" in notes[0]
    assert [p.state["x"] for p in points] == pytest.approx([-1.2], rel=1e-12)
    notes, points = found["square"]
    assert not_walked(notes) == ["b2"]
    assert sorted(p.state["x"] for p in points) == pytest.approx([-1.2, 1.2], rel=1e-12)


def test_where_an_image_does_not_satisfy_the_equations_the_walk_goes_on(monkeypatch):
    own = mirrors.Mirror.row

    def row(self, row, *more):
        return None if row["s"] > 5.0 else own(self, row, *more)

    monkeypatch.setattr(mirrors.Mirror, "row", row)
    branches, notes = made("lorenz")
    monkeypatch.undo()
    walked, _ = made("lorenz", mirror_images="walked")
    assert any("the images do not satisfy the equations" in note for note in notes)
    branch, other = branches[1], walked[1]
    low = branch.points["s"] < -5.0
    assert np.all(branch["iterations"][low & ~branch["special"]] > 0)
    assert np.all(branch["iterations"][(branch["s"] < 0.0) & ~low] == 0)
    assert len(branch) == len(other)
    assert branch["x"] == pytest.approx(other["x"], rel=1e-9, abs=1e-9)
    assert [p.name for p in branch.special_points] == [p.name for p in other.special_points]


@pytest.mark.drawn(1)
@pytest.mark.parametrize("name", ["lorenz", "folding"])
@pytest.mark.parametrize("trusted", [True, False])
def test_a_run_that_is_killed_anywhere_goes_on_to_the_same_bits(name, trusted, monkeypatch):
    """Of what was appended, any number of rows and special points may be there when it is taken up again."""
    if not trusted:
        own = mirrors.Mirror.row
        monkeypatch.setattr(
            mirrors.Mirror, "row", lambda self, row, *more: None if row["s"] > 1.0 else own(self, row, *more)
        )
    settings = Settings(range=SYSTEMS[name][3])

    def run(stored):
        diagram = Diagram([start_of(name, settings)], Plan(settings, depth=1), restore=stored.get)
        return diagram, list(diagram.events())

    whole, events = run({})
    appended = Appended.of(events, "b2")
    images = appended.images
    cuts = [0, images[0] - 1, *images[:: max(len(images) // 4, 1)], images[-2], images[-1]]
    for k in cuts:
        again, _ = run({"b1": kept(whole.branches[0]), "b2": appended.cut(k)})
        assert_same(again.branches[1], whole.branches[1], k)
