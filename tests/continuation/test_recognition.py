"""A branch is known where a solution lies on it and goes its way, or an image of the solution does."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from small_systems import circle, small_system

import contwalk as cw
from contwalk.continuation import pseudo_arclength
from contwalk.continuation.settings import Settings
from contwalk.continuation.state import begin
from contwalk.diagram import diagram
from contwalk.diagram.branch_in_progress import Start
from contwalk.diagram.diagram import Diagram, Noted, Plan
from contwalk.diagram.opening import Opening
from contwalk.diagram.recognition import Known, images, known_branch
from contwalk.diagram.reopening import reopened
from contwalk.problems.equilibrium.points.hopf import Hopf
from contwalk.studies.opening import opened
from contwalk.system import State, Symmetry

SETTINGS = Settings(range=(-1.0, 1.0))


def fork(t, x, p, dx):
    dx[0] = p.mu * x[0] - x[0] ** 3 + p.c
    dx[1] = -x[1] + x[0] ** 2


def turned(t, x, p, image):
    image[0] = -x[0]
    image[1] = x[1]


MIRROR = Symmetry("mirror", "spatial", turned)


def problem_of(symmetries=(), **values):
    system = small_system(fork, "xy", {"mu": 0.5, "c": 0.0, **values}, symmetries=symmetries)
    return cw.Equilibrium(system, system.defaults(), "mu")


def sample_at(problem, x, y, mu):
    here = begin(problem, np.array([x, y, mu]), SETTINGS)
    return here.sample


def upper(mu):
    return math.sqrt(mu), mu, mu


@pytest.fixture(scope="module")
def branches():
    problem = problem_of()
    straight = cw.continue_branch(problem, [0.0, 0.0], (-1.0, 1.0))
    outer = cw.switch_branch(problem, straight, "BP1", (-1.0, 1.0))
    return [straight, outer]


def test_a_solution_between_stored_points_is_known(branches):
    straight, _ = branches
    between = 0.5 * (straight["mu"][20] + straight["mu"][21])
    assert (
        known_branch(problem_of(), sample_at(problem_of(), 0.0, 0.0, between), [straight]).branch
        == straight.name
    )


def test_a_solution_of_another_branch_is_not(branches):
    straight, _ = branches
    assert known_branch(problem_of(), sample_at(problem_of(), *upper(0.4)), [straight]) is None


def test_beyond_the_ends_of_a_branch_nothing_is_known(branches):
    straight, _ = branches
    half = cw.continue_branch(problem_of(), [0.0, 0.0], (0.4, 1.0))
    assert known_branch(problem_of(), sample_at(problem_of(), 0.0, 0.0, 0.2), [half]) is None
    assert known_branch(problem_of(), sample_at(problem_of(), 0.0, 0.0, 0.2), [straight]) is not None


def test_right_where_two_branches_cross_the_way_decides():
    """x (mu - x) = 0: the two lines cross at zero, at 45 degrees."""

    def lines(t, x, p, dx):
        dx[0] = x[0] * (p.mu - x[0])

    system = small_system(lines, "x", {"mu": 0.5})
    problem = cw.Equilibrium(system, system.defaults(), "mu")
    flat = cw.continue_branch(problem, [0.0], (-1.0, 1.0))
    for mu in (1e-3, 1e-5, 1e-6):
        steep = begin(problem, np.array([mu, mu]), SETTINGS).sample
        assert known_branch(problem, steep, [flat]) is None
        along = begin(problem, np.array([0.0, mu]), SETTINGS).sample
        assert known_branch(problem, along, [flat]) == Known(flat.name)


@pytest.mark.parametrize(("unit", "gap"), [(1.0, 1e-4), (1e-3, 1e-8), (1e3, 1e-2)])
def test_a_branch_that_runs_close_beside_is_another_one(unit, gap):
    """x = 0 and x = gap, in a state of size `unit`."""

    def close(t, x, p, dx):
        dx[0] = x[0] * (x[0] - gap) * (1.0 + p.mu**2) / unit

    system = small_system(close, [State("x", scale=unit)], {"mu": 0.5})
    problem = cw.Equilibrium(system, system.defaults(), "mu")
    straight = cw.continue_branch(problem, [0.0], (-1.0, 1.0))
    for x, expected in ((0.0, Known(straight.name)), (gap, None)):
        sample = begin(problem, np.array([x, 0.3]), SETTINGS).sample
        assert sample.z[0] == pytest.approx(x, abs=1e-12 * unit)
        assert known_branch(problem, sample, [straight]) == expected


def test_an_image_is_known_only_where_the_symmetry_is_declared(branches):
    _, outer = branches
    x, y, mu = upper(0.4)
    kept = outer.points[outer.points["state"][:, 0] > 0.0]
    half = type(outer)(outer.info, kept, [], outer.outcome)
    lower = sample_at(problem_of(), -x, y, mu)
    assert known_branch(problem_of(), lower, [half]) is None
    mirrored = problem_of(symmetries=(MIRROR,))
    assert known_branch(mirrored, sample_at(mirrored, -x, y, mu), [half]) == Known(half.name, ("mirror",))


def test_a_solution_has_as_many_images_as_there_are_different_ones():
    """Of the mirror: two, but on the mirror itself only one."""
    mirrored, beside = problem_of(symmetries=(MIRROR,)), np.array([1e-4, 0.0, 1e-4])
    off, on = np.array(upper(0.4)), np.array([0.0, 0.0, 0.4])
    assert [z.tolist() for _, (z, _) in images(mirrored, off, off + beside)] == [
        [off[0], off[1], 0.4],
        [-off[0], off[1], 0.4],
    ]
    assert [z.tolist() for _, (z, _) in images(mirrored, on, on + beside)] == [on.tolist()]


def test_other_parameters_make_another_branch(branches):
    other = problem_of(c=1e-3)
    assert known_branch(other, sample_at(other, *upper(0.4)), branches) is None
    # At c = 0 the same state and parameter are known.
    assert known_branch(problem_of(), sample_at(problem_of(), *upper(0.4)), branches) is not None


def test_of_two_starts_that_are_mirror_images_the_second_is_known(tmp_path):
    """With the mirror declared one branch is walked, and a note says where the other start lies; else two."""
    from plugin_runs import run_text

    plugin = """
from contwalk.system import Mode, Parameter, State, Symmetry, System

def field(t, x, p, dx):
    dx[0] = p.mu * x[0] - x[0] ** 3

def turned(t, x, p, image):
    image[0] = -x[0]

SYSTEM = System(
    name="small", states=(State("x"),), parameters=(Parameter("mu", 0.5),), modes=(Mode("only", field),),
    {symmetries}
)
"""
    run = """
start: [{state: {x: 0.7071}}, {state: {x: -0.7071}}]
continue: {parameter: mu, range: [0.2, 1.0]}
diagram: none
"""
    mirror = 'symmetries=(Symmetry("mirror", "spatial", turned),),'
    for name, declared, expected in (("with", mirror, 1), ("without", "", 2)):
        folder = tmp_path / name
        folder.mkdir()
        (folder / "small.py").write_text(plugin.replace("{symmetries}", declared))
        result = run_text(folder, run)
        assert len(result.branches) == expected
        with cw.open_database(folder / "study.h5") as db:
            told = [text for text in db.notes().values() if "already known" in text]
        assert len(told) == 2 - expected
        assert all(
            "is the image of branch b1 under the symmetry 'mirror', already known" in text for text in told
        )


def test_a_start_far_away_is_found_by_damped_steps():
    """mu = atan x from x = 12: Newton's full step would go to -170 and beyond."""

    def field(t, x, p, dx):
        dx[0] = p.mu - math.atan(x[0])

    system = small_system(field, "x", {"mu": 0.1})
    problem = cw.Equilibrium(system, system.defaults(), "mu")
    branch = cw.continue_branch(problem, [12.0], (-1.0, 1.0))
    start = int(np.flatnonzero(branch["s"] == 0.0)[0])
    assert branch["x"][start] == pytest.approx(math.tan(0.1), rel=1e-14)
    assert branch["x"][[0, -1]] == pytest.approx([math.tan(-1.0), math.tan(1.0)], rel=1e-13)


def ellipse_with_followers(t, x, p, dx):
    """x^2 + mu^2 = 1, with y = x^2, z = x y^2 / 30 and w = z^2 / 40: dust beside the line x = 0."""
    dx[0] = x[0] * (1.0 - p.mu**2 - x[0] ** 2)
    dx[1] = x[0] ** 2 - x[1]
    dx[2] = x[0] * x[1] ** 2 - 30.0 * x[2]
    dx[3] = x[2] ** 2 - 40.0 * x[3]


def test_a_branch_is_known_where_its_unknowns_are_scaled_by_dust():
    """The ellipse is walked from its top. Of where it crosses the line, dust tells the metric: its arcs are
    hundreds of times as long there, and it was walked again."""
    system, values = small_system(ellipse_with_followers, "xyzw", {"mu": 0.0}), {"mu": 0.0}
    settings = Settings(range=(-2.0, 2.0))
    top = np.array([1.0, 1.0, 1.0 / 30.0, 1.0 / 36000.0])
    opening = opened(system, values, "mu", top, settings)
    made = Diagram([Start(system, "mu", values, opening, "top")], Plan(settings, depth=2))
    notes = [event.text for event in made.events() if isinstance(event, Noted)]
    assert len(made.branches) == 2
    assert [note.split()[0] for note in notes] == ["b1/BP2", "b2/BP1"]
    assert all("already known" in note for note in notes)


def test_a_solution_is_known_on_an_arc_over_which_an_unknown_turns():
    """x = mu and y = 1000 (1 - mu^2): by y alone nothing tells where on the arc over mu = 0 a solution is."""

    def hill(t, x, p, dx):
        dx[0] = p.mu - x[0]
        dx[1] = 1e3 * (1.0 - p.mu**2) - x[1]

    system = small_system(hill, [State("x", scale=1.0), State("y", scale=1e3)], {"mu": -0.3})
    problem = cw.Equilibrium(system, system.defaults(), "mu")
    branch = cw.continue_branch(problem, [-0.3, 910.0], (-0.31, 0.4))
    after = int(np.searchsorted(branch["mu"], 0.0))
    arc = type(branch)(branch.info, branch.points[[after - 2, after + 1]], [], branch.outcome)
    low, high = arc["mu"]
    for share in (0.1, 0.3, 0.5, 0.7, 0.9):
        mu = low + share * (high - low)
        sample = begin(problem, np.array([mu, 1e3 * (1.0 - mu**2), mu]), SETTINGS).sample
        assert known_branch(problem, sample, [arc]) == Known(branch.name)


def test_an_orbit_is_known_on_its_branch_if_its_period_is_as_often_that_of_the_forcing():
    system = small_system(circle, "xy", {"mu": 0.5})
    problem = cw.PeriodicOrbit(system, system.defaults(), "mu")
    start = [math.sqrt(0.5), 0.0]
    branch = cw.continue_branch(problem, start, (0.4, 0.8), period=2.0 * math.pi, direction="forward")
    there, sample = reopened(system, branch, len(branch) // 2)
    assert known_branch(there, sample, [branch]) == Known(branch.name)
    other = replace(branch, info=replace(branch.info, subharmonic=2))
    assert known_branch(there, sample, [other]) is None


class TestBeginningsAtHopfPoints:
    """An orbit's start at a Hopf point: known by a family that ends there, or else by the way it goes."""

    @pytest.fixture
    def recognised(self, branches, monkeypatch):
        problem, straight = problem_of(), branches[0]
        here = begin(problem, np.array([0.0, 0.0, 0.3]), SETTINGS)
        values, opening = problem.system.defaults(), Opening(problem, here)
        start = Start(problem.system, "mu", values, opening, "b9/HB1", ("b9", 0.0), leaves=Hopf())
        walks = []

        def told(ends_there):
            found = Diagram([], Plan(SETTINGS))
            found.branches = [straight]
            monkeypatch.setattr(diagram, "_ends_at_point", lambda branch, *at: ends_there)
            monkeypatch.setattr(found._walk, "beside", lambda *given: walks.append(given) or here.sample)
            return found._recognised(start), len(walks)

        return told

    def test_where_a_family_ends_there_nothing_is_walked(self, recognised, branches):
        assert recognised(True) == (Known(branches[0].name), 0)

    def test_where_none_does_both_ways_are_looked_at(self, recognised, branches):
        assert recognised(False) == (Known(branches[0].name), 2)


def test_steps_that_recognition_has_looked_at_are_not_taken_again(monkeypatch):
    """A line with a pitchfork, and the branch that leaves it both ways."""
    taken, take_step, system = [], pseudo_arclength.take_step, problem_of().system
    monkeypatch.setattr(pseudo_arclength, "take_step", lambda *given: taken.append(1) or take_step(*given))
    opening = opened(system, system.defaults(), "mu", np.array([0.0, 0.0]), SETTINGS)
    found = Diagram([Start(system, "mu", system.defaults(), opening, "line")], Plan(SETTINGS))
    list(found.events())
    straight, outer = found.branches
    assert [point.label for point in straight.special_points].count("BP") == 1
    assert np.ptp(outer["x"]) > 1.9
    assert len(taken) == sum(int(np.sum(~branch.points["special"])) - 1 for branch in found.branches)
