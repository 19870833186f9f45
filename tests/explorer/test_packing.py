"""Numbers of a page come back as they were."""

from __future__ import annotations

import numpy as np
from explorer_pages import blocks, numbers

from contwalk.explorer.packing import packed, predicted, short, varints


def test_whole_numbers_come_back():
    edges = [sign * (2**power + more) for power in range(50) for more in (-1, 0, 1) for sign in (1, -1)]
    assert numbers(varints(edges)) == edges
    assert numbers(varints([])) == []
    # Small ones take a byte each.
    small = list(range(-64, 64))
    assert (numbers(varints(small)), len(varints(small))) == (small, 128)


def test_a_table_like_the_one_before_it_is_nearly_nothing():
    before = np.cumsum(np.arange(30).reshape(10, 3), axis=0)
    assert not predicted(before, before).any()
    steps = predicted(before[:4], None)
    assert np.array_equal(np.cumsum(steps, axis=0), before[:4])
    # A longer table than the one before it goes on without it.
    longer = np.concatenate([before, before[-1:] + 5])
    assert predicted(longer, before)[-1].tolist() == [5, 5, 5]


def test_a_block_holds_a_header_and_bytes():
    text = packed({"name": "</script>ä", "none": None}, b"\x00\xff")
    page = f'<script type="application/octet-stream" data-block="x">{text}</script>'
    assert "<" not in text
    assert blocks(page) == {"x": ({"name": "</script>ä", "none": None}, b"\x00\xff")}


def test_what_is_not_finite_has_no_place():
    assert short(np.array([1.0 / 3.0, np.nan, np.inf])) == [0.333333333, None, None]
