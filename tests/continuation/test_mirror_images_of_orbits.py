"""The half of a branch of orbits that is the image of the other one: as a walk finds it, and closed."""

from __future__ import annotations

import math

import numpy as np
import pytest
from cut_branches import Appended, assert_same, kept
from scipy.integrate import solve_ivp
from small_systems import small_system

from contwalk.continuation.settings import Mark, Settings
from contwalk.diagram.branch_in_progress import Start
from contwalk.diagram.diagram import Diagram, Noted, Plan
from contwalk.problems.orbit import mirror as mirrors
from contwalk.studies.opening import opened
from contwalk.studies.opening_orbits import opened_orbit
from contwalk.system import Observable, Symmetry
from contwalk.system.declarations import ParameterValues


def lorenz(t, x, p, dx):
    dx[0] = 10.0 * (x[1] - x[0])
    dx[1] = p.rho * x[0] - x[1] - x[0] * x[2]
    dx[2] = x[0] * x[1] - 8.0 / 3.0 * x[2]


def half_turn(t, x, p, image):
    image[0], image[1], image[2] = -x[0], -x[1], x[2]


def pendulum(t, x, p, dx):
    """Driven at its pivot's side: its swings lose their symmetry, and double their period."""
    dx[0] = x[1]
    dx[1] = -math.sin(x[0]) - 0.5 * x[1] + p.a * math.cos(2.0 / 3.0 * t)


def inverted(t, x, p, image):
    image[0], image[1] = -x[0], -x[1]


def in_step(t, x, p, dx):
    """Two alike driven masses: they move as one, until each goes its own way. No time passes in the image."""
    far = x[0] - x[2]
    for i, sign in ((0, 1.0), (2, -1.0)):
        dx[i] = x[i + 1]
        push = sign * (p.k * far - far**3)
        dx[i + 1] = -x[i] - x[i] ** 3 - 0.4 * x[i + 1] + push + math.cos(t)


def exchanged(t, x, p, image):
    image[0], image[1], image[2], image[3] = x[2], x[3], x[0], x[1]


SYSTEMS = {
    "lorenz": (lorenz, "xyz", "rho", (240.0, 330.0), 320.0, [10.0, 10.0, 300.0], half_turn, "spatial", None),
    "pendulum": (
        pendulum,
        "qv",
        "a",
        (0.9, 1.1),
        0.95,
        [0.1, 0.0],
        inverted,
        "spatial",
        lambda p: 3.0 * math.pi,
    ),
    "in_step": (
        in_step,
        "abcd",
        "k",
        (0.1, 1.6),
        0.3,
        [0.1, 0.0, 0.1, 0.0],
        exchanged,
        "relabel",
        lambda p: 2.0 * math.pi,
    ),
}


def system_of(name, **more):
    field, states, free, _, value, _, image, role, period = SYSTEMS[name]
    symmetries = (Symmetry("twin", role, image),)
    return small_system(field, states, {free: value}, symmetries=symmetries, period=period, **more)


def made(name, stored=None, system=None, **given):
    """The branches from a settled orbit, and those that leave it, with the notes."""
    _, _, free, span, _, state, *_ = SYSTEMS[name]
    system, settings = system or system_of(name), Settings(range=span, max_points=40, **given)
    values = system.defaults()
    opening = opened_orbit(system, values, free, np.array(state), settings, until="settled")
    start = Start(system, free, values, opening, "start", orbit=True)
    diagram = Diagram([start], Plan(settings, depth=1), restore=(stored or {}).get)
    events = list(diagram.events())
    return diagram.branches, [event.text for event in events if isinstance(event, Noted)], events


@pytest.fixture(scope="module", params=list(SYSTEMS))
def both(request):
    return request.param, made(request.param)[:2], made(request.param, mirror_images="walked")[:2]


def not_walked(notes):
    return [note.split(":")[0] for note in notes if "It was not computed" in note]


@pytest.mark.drawn(1)
def test_special_points_are_those_that_a_walk_locates(both):
    _, (branches, notes), (walked, others) = both
    assert "b2" in not_walked(notes)
    assert not not_walked(others)
    branch, other = branches[1], walked[1]
    free = branch.info.free[0]
    assert [p.name for p in branch.special_points] == [p.name for p in other.special_points]
    for a, b in zip(branch.special_points, other.special_points, strict=True):
        assert (a.label, a.kind, a.status, a.criticality) == (b.label, b.kind, b.status, b.criticality)
        assert (a.unstable_before, a.unstable_after) == (b.unstable_before, b.unstable_after)
        if a.kind == "max_points":
            continue
        known = max((a.error or 0.0) + (b.error or 0.0), 1e-14)
        assert abs(a.parameters[free] - b.parameters[free]) <= known
        assert a.period == pytest.approx(b.period, rel=1e-7)
        assert np.array(a.spectrum) == pytest.approx(np.array(b.spectrum), rel=1e-4, abs=1e-6)
        for key, value in b.coefficients.items():
            if isinstance(value, float) and not key.endswith("_error"):
                assert a.coefficients[key] == pytest.approx(value, rel=1e-3, abs=1e-9), (a.name, key)


@pytest.mark.drawn(1)
def test_images_are_orbits_by_an_independent_integration(both):
    name, (branches, _), _ = both
    field, _, free, *_ = SYSTEMS[name]
    rows = branches[1].points[branches[1]["s"] < 0.0]
    assert len(rows) > 5
    assert np.all(rows["iterations"] == 0)
    for row in rows[:: max(len(rows) // 6, 1)]:
        p = ParameterValues(**{free: float(row["free"][0])})

        def rates(t, x, p=p):
            dx = np.zeros(len(x))
            field(t, x, p, dx)
            return dx

        size = int(np.sum(np.isfinite(row["unknowns"])))
        start = row["unknowns"][: len(row["state"])]
        end = solve_ivp(rates, (0.0, float(row["period"])), start, "DOP853", rtol=1e-11, atol=1e-12).y[:, -1]
        grown = max(1.0, float(np.max(np.abs(row["spectrum"]))))
        scale = np.maximum(np.abs(row["weights"][: len(start)]), np.abs(start))
        assert size == len(start) or name == "lorenz"
        assert np.max(np.abs(end - start) / scale) < 1e-5 * grown


def test_images_join_the_orbit_that_the_branch_leaves(both):
    """State and tangent go on through the start without a jump."""
    _, (branches, _), _ = both
    rows = branches[1].points[~branches[1]["special"]]
    k = int(np.flatnonzero(rows["s"] == 0.0)[0])
    size = int(np.sum(np.isfinite(rows[k]["unknowns"])))
    before, here, after = (rows[i]["unknowns"][:size] for i in (k - 1, k, k + 1))
    weights = rows[k]["weights"][:size]
    assert np.linalg.norm((before + after - 2.0 * here) / weights) < 0.3 * np.linalg.norm(
        (after - before) / weights
    )
    assert rows[k - 1]["s"] == -rows[k + 1]["s"]
    chord = (here - before) / weights
    along = rows[k - 1]["tangent"][:size] / weights
    assert chord @ along > 0.9 * np.linalg.norm(chord) * np.linalg.norm(along)


def test_extremes_are_exchanged(both):
    """What is largest on one side is what is least, or another state's largest, on the other."""
    name, (branches, _), _ = both
    branch = branches[1]
    s, here, there = branch["s"], "min:x", "max:x"
    if name == "in_step":
        here, there = "max:a", "max:c"
    elif name == "pendulum":
        here, there = "min:q", "max:q"
    sign = 1.0 if name == "in_step" else -1.0
    ahead = branch[here][s > 0.0]
    assert branch[there][s < 0.0][::-1] == pytest.approx(sign * ahead, rel=1e-5)


@pytest.mark.drawn(1)
@pytest.mark.parametrize("trusted", [True, False])
def test_a_run_that_is_killed_goes_on_to_the_same_bits(trusted, monkeypatch):
    if not trusted:
        own = mirrors.OrbitMirror.row
        limited = lambda self, row, *more: None if row["s"] > 0.4 else own(self, row, *more)  # noqa: E731
        monkeypatch.setattr(mirrors.OrbitMirror, "row", limited)
    whole, notes, events = made("pendulum")
    assert any("do not satisfy" in note for note in notes) == (not trusted)
    appended = Appended.of(events, "b2")
    images = appended.images
    for k in (images[0] - 1, images[0], images[len(images) // 2], images[-2], images[-1]):
        again, _, _ = made("pendulum", {"b1": kept(whole[0]), "b2": appended.cut(k)})
        assert_same(again[1], whole[1], k)


@pytest.mark.long
def test_a_marked_value_that_differs_on_the_image_is_found_there():
    """The largest angle is another on the image, its range is not."""
    observables = (Observable("range", lambda t, x, p: np.ptp(x[:, 0])),)
    system = system_of("pendulum", observables=observables)
    plain = made("pendulum", system=system)[0][1]
    row = plain.points[plain["s"] > 0.0][len(plain) // 4]
    for name in ("max:q", "range"):
        level = float(plain[name][plain["s"] == row["s"]][0])
        branches, notes, _ = made("pendulum", system=system, marks=(Mark(name, (level * 1.0001,)),))
        found = [p for p in branches[1].special_points if p.label == "UZ"]
        if name == "range":
            assert "b2" in not_walked(notes)
            assert len(found) == 2
            assert found[0].parameters["a"] == pytest.approx(found[1].parameters["a"], rel=1e-9)
        else:
            assert any("'max:q', which is looked for, is not the same there" in note for note in notes)
            assert found


def test_a_cycle_that_is_the_image_of_a_known_one_is_told_with_the_symmetry():
    """Of the Lorenz equations' two cycles at their Hopf points one is walked."""
    system = small_system(lorenz, "xyz", {"rho": 20.0}, symmetries=(Symmetry("twin", "spatial", half_turn),))
    settings, values = Settings(range=(0.5, 25.0), max_points=110), system.defaults()
    opening = opened(system, values | {"rho": 0.9}, "rho", np.zeros(3), settings)
    start = Start(system, "rho", values | {"rho": 0.9}, opening, "rest")
    diagram = Diagram([start], Plan(settings, frozenset({"BP", "HB"}), 2))
    notes = [event.text for event in diagram.events() if isinstance(event, Noted)]
    assert [branch.info.problem for branch in diagram.branches] == ["equilibrium"] * 2 + ["periodic_orbit"]
    told = [note for note in notes if "already known" in note]
    assert told == ["b2/HB2 is the image of branch b3 under the symmetry 'twin', already known."]
