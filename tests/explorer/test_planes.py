"""Phase planes of a page: nullclines, equilibria and directions are those of the system."""

from __future__ import annotations

import numpy as np
import pytest
from explorer_pages import CYCLE, blocks, computed, numbers

from contwalk.explorer import explored
from contwalk.storage import open_database

# Saddles at (-1, 0) and (1, 0), a node between them; the parameter moves nothing but the second rate.
STUDY = """\
contwalk: 1
system: {equations: "x' = x^3 - x; y' = -a*y; a = 1"}
start: {state: {x: 0.0, y: 0.0}}
continue: {parameter: a, range: [0.5, 1], max_points: 3}
output: rests.h5
"""


def page(folder, text):
    with open_database(computed(folder, "rests", text)) as database:
        return blocks(explored(database).page)


def curves_of(block):
    """Of each plane its window, equilibria, directions (a, a) and curves (k, 2) by kind."""
    header, body = block
    values, at, before = numbers(body), 0, None
    side = header["arrows"]

    def table(rows, columns, earlier):
        nonlocal at
        steps = np.array(values[at : at + rows * columns]).reshape(rows, columns)
        at += rows * columns
        whole = np.cumsum(steps, axis=0)
        return whole if earlier is None else whole + earlier

    for plane in header["planes"]:
        before = table(side * side, 1, before)
        window = np.reshape(plane["window"], (2, 2))
        curves = [
            (kind, window[:, 0] + np.ptp(window, axis=1) * table(count, 2, None) / header["place"])
            for kind, count in plane["curves"]
        ]
        yield window, plane["rests"], before.reshape(side, side), curves
    assert at == len(values)


def test_what_is_drawn_is_the_systems(tmp_path):
    found = page(tmp_path, STUDY)["planes b1"]
    planes = list(curves_of(found))
    assert [plane["row"] for plane in found[0]["planes"]] == list(range(len(planes)))
    window, rests, field, curves = planes[0]
    # A branch at the origin has no size of its own: a window of 1 beside it, in which there is one rest.
    assert window.tolist() == [[-0.5, 0.5], [-0.5, 0.5]]
    assert [rest[2] for rest in rests] == [True]
    assert np.allclose(rests[0][:2], 0.0, atol=1e-9)
    of_kind = dict(curves)
    # Places are told to a part of the window.
    part = 1.0 / found[0]["place"]
    assert np.abs(of_kind["null0"][:, 0]).max() <= part
    assert np.abs(of_kind["null1"][:, 1]).max() <= part
    # At the upper left the way is down to the right: both rates are towards the middle.
    turns = field / found[0]["turn"]
    assert 0.75 < turns[-1, 0] < 1.0
    assert 0.25 < turns[0, -1] < 0.5


def test_an_orbit_has_the_window_that_holds_it(tmp_path):
    found = page(tmp_path, CYCLE)
    planes = list(curves_of(found["planes b2"]))
    window, rests, _, _ = planes[-1]
    assert (window[:, 0] < -1.0).all()
    assert (window[:, 1] > 1.0).all()
    assert [rest[2] for rest in rests] == [False]


@pytest.mark.parametrize(
    ("equations", "state"),
    [
        ("x' = a - x; y' = -y; z' = -z; a = 1", "{x: 1.0, y: 0.0, z: 0.0}"),
        ("x' = a - x + sin(t); y' = -y; a = 1; period = 2*pi", "{x: 1.0, y: 0.0}"),
    ],
)
def test_other_systems_have_none(tmp_path, equations, state):
    text = STUDY.replace("x' = x^3 - x; y' = -a*y; a = 1", equations).replace("{x: 0.0, y: 0.0}", state)
    assert not [name for name in page(tmp_path, text) if name.startswith("planes")]
