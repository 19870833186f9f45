"""Numbers of a page come back as they were."""

from __future__ import annotations

import numpy as np
from explorer_pages import blocks, numbers

from contwalk.explorer.machine import MOST, SCALE, MachineOfBranch
from contwalk.explorer.packing import packed, predicted, short, varints
from contwalk.plotting.drawn_elements import Element


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


def test_an_outline_that_moves_and_turns_is_written_once():
    """Its instants have four numbers each, which put it where it was drawn, to a part of the picture."""
    shape = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.5, 1.5], [0.0, 1.0]])
    places = []
    for angle in np.linspace(0.0, 2.0, 9):
        turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
        places.append(shape @ turn.T + [angle, 0.5 * angle])
    machine = MachineOfBranch()
    view = np.array([-4.0, 4.0, -4.0, 4.0])
    machine.add([([Element("fill", points, {"fill": "#000000"}, 1.0)], view) for points in places])
    header = machine.header()
    assert len(header["outlines"]) == 1
    assert header["tracks"] == [[[0, 0, 4, 9]]]
    rows = np.cumsum(np.array(numbers(bytes(machine.body))).reshape(9, 4), axis=0)
    outline = np.array(header["outlines"][0]).reshape(-1, 2) @ [1.0, 1.0j] / SCALE["outline"]
    unit = SCALE["view"] / 8.0
    for (a, b, x, y), points in zip(rows, places, strict=True):
        shown = x + 1j * y + (a + 1j * b) / SCALE["turn"] * outline
        drawn = unit * ((points[:, 0] + 4.0) + 1j * (4.0 - points[:, 1]))
        # An outline is told to a sixteenth, a turn and a place to a half of their parts.
        assert np.abs(shown - drawn).max() <= 1.0


def test_an_outline_that_changes_its_form_is_written_point_by_point():
    rough = np.random.default_rng(3)
    machine = MachineOfBranch()
    view = np.array([-4.0, 4.0, -4.0, 4.0])
    shapes = [rough.normal(size=(5, 2)) for _ in range(MOST["outlines"] + 4)]
    machine.add([([Element("line", points, {"stroke": "#000000"}, 1.0)], view) for points in shapes])
    assert len(machine.header()["outlines"]) == MOST["outlines"]
    key, first, width, count = machine.header()["tracks"][0][-1]
    assert (first, width, count) == (MOST["outlines"], 10, 4)
    assert machine.header()["keys"][key][-1] == -1
