"""Computations hold NumPy's linear algebra to one thread, and give back what there was."""

from __future__ import annotations

import pytest
from small_systems import small_problem

import contwalk as cw
from contwalk.numerics import threads
from contwalk.numerics.threads import count, each_on_one_thread, one_thread


@pytest.fixture(autouse=True)
def two_threads():
    library = threads._library()
    if library is None:
        pytest.skip("NumPy's linear algebra has no threads that are known")
    before = count()
    library[1](2)
    yield
    library[1](before)


def test_within_it_there_is_one_and_then_as_many_as_before():
    assert count() == 2
    with one_thread():
        assert count() == 1
        with one_thread():
            assert count() == 1
        assert count() == 1
    assert count() == 2


def test_a_computation_that_fails_gives_them_back():
    with pytest.raises(ZeroDivisionError), one_thread():
        _ = 1 / 0
    assert count() == 2


def test_an_iterator_holds_one_only_while_it_computes():
    def counted():
        yield count()
        yield count()

    for inside in each_on_one_thread(counted()):
        assert inside == 1
        assert count() == 2


def test_the_verbs_of_the_interface_compute_on_one(monkeypatch):
    seen = []

    def field(t, x, p, dx):
        dx[0] = p.a - x[0] ** 2

    def watching(self, z, known=cw.Equilibrium.linearize):
        seen.append(count())
        return known(self, z)

    problem = small_problem(field, "x", {"a": 1.0}, "a")
    monkeypatch.setattr(cw.Equilibrium, "linearize", watching)
    cw.continue_branch(problem, [1.0], (0.5, 1.5))
    assert set(seen) == {1}
    for _ in cw.points(problem, [1.0], (0.5, 1.5)):
        assert count() == 2
    assert set(seen) == {1}
    assert count() == 2
