"""Whether a step of orbits, which begin anywhere on themselves, passes the one where the walk began."""

from __future__ import annotations

from dataclasses import dataclass

from made_up import MadeUp

from contwalk.continuation.returns import place_of_closure


@dataclass
class Orbits(MadeUp):
    """Solutions that are the same wherever they begin: the first unknown says where, and says nothing."""

    @property
    def meshed(self):
        return self

    def same(self, origin, there):
        return bool(abs(origin.parameter - there.parameter) <= 1e-11)


def cubic():
    """lam = x + x^3 and y = -lam: no straight line leads to a value of the parameter."""
    return Orbits(
        lambda z: [z[2] - z[0] - z[0] ** 3, z[1] + z[2]],
        lambda z: [[-1.0 - 3.0 * z[0] ** 2, 0.0, 1.0], [0.0, 1.0, 1.0]],
    )


def place(x):
    return x, -x - x**3, x + x**3


def at(problem, x):
    return problem.sample(place(x), (1.0, -1.0, 1.0))


def test_a_step_over_the_parameter_of_the_beginning_passes_it():
    problem = cubic()
    segment = problem.segment(place(0.5), place(0.7))
    assert place_of_closure(segment, [], at(problem, 0.6)) is not None
    assert place_of_closure(segment, [], at(problem, 0.8)) is None


def test_a_step_the_other_way_does_not():
    problem = cubic()
    segment = problem.segment(place(0.7), place(0.5))
    assert place_of_closure(segment, [], at(problem, 0.6)) is None


def test_the_search_ends_where_it_is_there():
    """Newton's method gets there in two corrections of a few evaluations each; it does not go on."""
    problem = cubic()
    segment = problem.segment(place(0.5), place(0.7))
    origin, before = at(problem, 0.6), problem.evaluated
    assert place_of_closure(segment, [], origin) is not None
    assert problem.evaluated - before < 15


def test_a_step_that_begins_there_within_errors_has_not_been_away():
    problem = cubic()
    near = 0.6 - 1e-13  # the parameter is the same to 2.1e-13
    segment = problem.segment(place(near), place(0.7))
    assert place_of_closure(segment, [], at(problem, 0.6)) is None


def test_a_step_that_begins_near_at_another_parameter_passes_it(monkeypatch):
    """An orbit of many periods of a forcing passes near every state of its neighbours: it has been away."""
    problem = cubic()
    monkeypatch.setattr(type(problem), "same", lambda *_: True)
    segment = problem.segment(place(0.6 - 1e-6), place(0.7))
    assert place_of_closure(segment, [], at(problem, 0.6)) is not None
