"""A sample with some of what it tells changed, and steps' scales that are kept with the steps."""

from __future__ import annotations

from dataclasses import fields, replace

import numpy as np
import pytest

from contwalk.problems.orbit.equations import blocks_of
from contwalk.problems.orbit.evaluations import Evaluations
from contwalk.problems.sample import Rates, Sample


def sample() -> Sample:
    ones, rates = np.ones(2), Rates.known(np.zeros(1))
    return Sample(ones, ones, ones, 1.0, np.zeros(1), np.zeros(1), rates, np.zeros(1), 0, ones, ones, 0.5)


def test_it_is_what_replace_makes():
    one, changes = sample(), {"iterations": 3, "z": np.array([2.0, 5.0])}
    ours, theirs = one.varied(**changes), replace(one, **changes)
    for each in fields(Sample):
        assert getattr(ours, each.name) is getattr(theirs, each.name), each.name
    assert one.iterations == 0


def test_what_a_sample_does_not_tell_is_refused():
    with pytest.raises(TypeError, match="nothing called wight"):
        sample().varied(wight=np.ones(2))


def test_what_belongs_to_steps_is_made_anew_on_others():
    known, steps, others = Evaluations(), object(), object()
    assert [known.on(own, "cost", lambda own=own: id(own)) for own in (steps, steps, others, steps)] == [
        *(id(steps), id(steps), id(others), id(steps))
    ]


def test_blocks_are_the_matrix_itself():
    matrix = np.arange(7.0 * 8.0).reshape(7, 8)
    blocks = blocks_of(matrix, 3, 2)
    assert np.shares_memory(blocks, matrix)
    np.testing.assert_array_equal(blocks[1, :, 2], matrix[2:4, 4:6])
