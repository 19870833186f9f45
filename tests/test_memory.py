"""What is made once is made once, and its owner goes when nobody needs it."""

from __future__ import annotations

import gc
import weakref

import pytest

from contwalk.memory import computed_once


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
