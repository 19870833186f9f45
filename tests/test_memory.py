"""What is made once is made once, and its owner goes when nobody needs it."""

from __future__ import annotations

import gc
import math
import weakref

import pytest
from small_systems import small_system

import contwalk as cw
from contwalk.memory import computed_once, memory_of, remembered


class Owner:
    def __init__(self):
        self.calls = 0

    @computed_once
    def answer(self):
        """What is asked for."""
        self.calls += 1
        return [self.calls]


def test_a_property_is_computed_once_for_each_object():
    one, other = Owner(), Owner()
    assert one.answer is one.answer
    assert one.calls == 1
    assert other.answer is not one.answer
    assert Owner.answer.__doc__ == "What is asked for."


def test_what_is_computed_keeps_nobody():
    owner = Owner()
    _ = owner.answer
    gone = weakref.ref(owner)
    gc.disable()
    try:
        del owner
        assert gone() is None
    finally:
        gc.enable()


def test_what_fails_is_asked_for_again():
    class Failing:
        calls = 0

        @computed_once
        def answer(self):
            self.calls += 1
            if self.calls == 1:
                raise ValueError("not yet")
            return self.calls

    failing = Failing()
    with pytest.raises(ValueError, match="not yet"):
        _ = failing.answer
    assert failing.answer == failing.answer == 2


def test_what_is_remembered_of_an_object_goes_with_it():
    owner = Owner()
    known = memory_of(owner, "pairs")
    made = [remembered(known, key, 2, lambda circle=owner: (circle, [])) for key in (1, 2, 1, 3)]
    assert made[0] is made[2]
    assert list(memory_of(owner, "pairs")) == [2, 3]
    assert memory_of(owner, "others") == {}
    gone = weakref.ref(owner)
    del owner, known, made
    gc.collect()
    assert gone() is None


def forced(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = p.a * math.cos(2.0 * t) - x[0] - 0.3 * x[1]


def test_a_system_that_has_been_studied_is_not_kept():
    """What is compiled of it was, to the end of the process: of a walker tens of megabytes each time."""
    system = small_system(forced, "xy", {"a": 0.5}, period=lambda p: math.pi)
    problem = cw.PeriodicOrbit(system, system.defaults(), "a")
    branch = cw.continue_branch(problem, [0.1, 0.1], (0.4, 0.6), direction="forward")
    assert len(branch) > 2
    gone = weakref.ref(system)
    del system, problem, branch
    gc.collect()
    assert gone() is None
