"""What branches, special points and databases show of themselves: a line, and a table for notebooks."""

from __future__ import annotations

import re
from dataclasses import replace
from html.parser import HTMLParser

import numpy as np
import pytest

from contwalk.branch import Branch, BranchInfo, Outcome, SpecialPoint, named
from contwalk.signatures import folded
from contwalk.small_picture import Line, svg
from contwalk.storage import MemoryDatabase, RunHeader
from contwalk.system import Mode, Parameter, State, System
from contwalk.system.units import lasting, time_unit


class Cells(HTMLParser):
    """The cells of a table, row by row; every element that is opened is closed."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.rows: list[list[str]] = []
        self.open: list[str] = []
        self.feed(text)
        assert self.open == []

    def handle_starttag(self, tag, attrs):
        self.open.append(tag)
        if tag == "tr":
            self.rows.append([])
        elif tag in ("th", "td"):
            self.rows[-1].append("")

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        if self.open and self.open[-1] in ("th", "td"):
            self.rows[-1][-1] += data


def made(points: int = 500, **changes) -> Branch:
    info = BranchInfo("b2", "periodic_orbit", ("x",), (), ("mu",), {"mu": 0.0}, 1000, 3, **changes)
    rows = np.zeros(points, dtype=info.point_dtype())
    rows["s"] = np.arange(points)
    rows["free"][:, 0] = np.linspace(0.5, 2.0, points)
    special = [
        SpecialPoint("PD", 10.0, criticality="supercritical", parameters={"mu": 0.53}, error=3.2e-12),
        SpecialPoint("LP", 20.0, status="unlocated", unstable_after=1, note="seen <only> & lost"),
        *[SpecialPoint("UZ", 100.0 + k, unknowns=tuple(range(1000))) for k in range(9)],
    ]
    return Branch(info, rows, named(special, rows), Outcome("complete", "bound", "Done."))


def test_a_branch_is_a_line():
    assert repr(made()) == (
        "<b2: 500 points, periodic orbit, mu 0.5 to 2; "
        "PD1 LP1 UZ1 UZ2 UZ3 UZ4 UZ5 UZ6 and 3 more; complete (bound)>"
    )
    assert repr(made(points=0)).startswith("<b2: 0 points, periodic orbit; ")
    assert repr(made(points=1)).startswith("<b2: 1 point, periodic orbit, mu 0.5 to 0.5; ")


def test_a_system_is_a_line():
    modes = (Mode("free", lambda t, x, p, dx: None),)
    system = System("box", (State("x"), State("v")), (Parameter("mu", 0.0),), modes)
    assert repr(system) == "<System 'box': 2 states, 1 parameter, 1 mode>"


def test_every_column_is_found_by_its_name():
    branch = made(points=3)
    assert branch.points["spectrum"].shape == (3, 3)
    branch.points["spectrum"][1] = [2.0 + 1.0j, 2.0 - 1.0j, 0.5]
    assert branch["re_1"].tolist() == [0.0, 2.0, 0.0]
    assert branch["im_2"].tolist() == [0.0, -1.0, 0.0]
    for name, column in branch.columns().items():
        assert np.array_equal(branch[name], column, equal_nan=column.dtype.kind == "f"), name
    assert branch.knows("re_3")
    assert not branch.knows("re_4")
    with pytest.raises(KeyError, match=r"no 're_4'. Known: .*re_3"):
        branch["re_4"]


def test_special_points_are_lines_in_a_list():
    first, second, *others = made().special_points
    assert repr(first) == "<PD1: period doubling, supercritical, located, error 3.2e-12>"
    assert repr([second]) == "[<LP1: fold, unlocated>]"
    assert len(repr(others)) < 500  # nine points of 1000 unknowns


def test_tables_of_special_points_hold_what_is_known():
    rows = Cells(made()._repr_html_()).rows
    assert rows[0] == ["name", "what", "mu", "error", "criticality", "unstable"]
    assert rows[1] == ["PD1", "period doubling", "0.53", "3.2e-12", "supercritical", "0 → 0"]
    assert rows[2][1] == "fold, NOT LOCATED"
    assert float(rows[2][2]) == pytest.approx(0.5 + 1.5 * 20 / 499, rel=1e-11)  # twelve digits are shown
    assert len(rows) == 12
    point = replace(made().special_points[1], period=2.5, spectrum=(1.0 + 0j, 0.5 - 0.25j))
    cells = dict(map(tuple, Cells(point._repr_html_()).rows))
    assert cells["note"] == "seen <only> & lost"
    assert cells["period"] == "2.5"
    assert cells["eigenvalue or multiplier 2"] == "0.5-0.25i"


def test_a_small_diagram_stands_before_the_table():
    shown = made()._repr_html_()
    picture = shown[: shown.index("<table")]
    assert picture.startswith("<svg")
    assert 'data-point="b2/PD1"' in picture
    assert "<script" not in picture
    # Text of a database is text: the name of a branch, of a state and of what a point is.
    line = Line("<b>", np.array([0.0, 1.0]), np.array([0.0, 0.0]), np.array([1]), [("P", "<i>", 0.5, 0.0)])
    assert "<b>" not in svg([line], "<u>", "<u>")
    assert svg([], "x", "y") == ""
    gone = Line("b1", np.array([np.nan]), np.array([0.0]), np.zeros(0, dtype=int))
    assert svg([gone], "x", "y") == ""


def test_lines_of_a_small_diagram_say_how_stable_they_are():
    x = np.linspace(0.0, 1.0, 5)
    shown = svg([Line("b1", x, x, np.array([1, 1, 0, -1]))], "x", "y")
    paths = re.findall(r'<path d="([^"]*)" fill="none" stroke="#0067a0"', shown)
    assert [path.count("L") for path in paths] == [2, 1, 1]


def test_a_database_is_a_line_and_a_table_of_its_branches():
    with MemoryDatabase(RunHeader("small")) as database:
        assert repr(database) == "<database in memory of small: no branches>"
        branch = made(points=3, origin="from <HB1>")
        database.start_branch(branch.info)
        for row in branch.points:
            database.append("b2", row)
        assert repr(database) == "<database in memory of small: b2>"
        rows = Cells(database._repr_html_()).rows
        assert rows[0][0] == "branch"
        assert rows[1][:4] == ["b2", "periodic orbit", "3", "mu 0.5 to 2"]
        assert rows[1][-1] == "from <HB1>"
    assert repr(database) == "<database in memory, closed>"


@pytest.mark.parametrize(
    ("events", "text"),
    [
        ("", ""),
        ("knee heel", "knee heel"),
        ("heel heel heel heel", "heel heel heel heel"),
        (" ".join(["heel"] * 32), "32 x heel"),
        (" ".join(["knee", "heel"] * 16), "16 x (knee heel)"),
        ("a a a b c c d", "3 x a b c c d"),
        (" ".join(["a"] * 6 + ["b"]), "6 x a b"),
        (" ".join((["a"] * 5 + ["b"]) * 3), "3 x (5 x a b)"),
    ],
)
def test_long_signatures_are_folded(events, text):
    assert folded(events.split()) == text


@pytest.mark.parametrize(
    ("units", "unit"),
    [
        (("1", "1"), ""),
        (("rad", "1"), ""),
        (("l1", "sqrt(k/M)", "sqrt(k M)"), ""),
        (("m", "rad"), "s"),
        (("rad", "rad/s"), "s"),
        (("mV", "1/ms", "uF/cm2"), "ms"),
        (("1/h", "g/L"), "h"),
        (("1/s", "1/ms"), ""),  # two units of time: neither is the one
        ((), ""),
    ],
)
def test_the_unit_of_time_is_what_the_units_imply(units, unit):
    assert time_unit(units) == unit


def test_durations_have_a_unit_where_there_is_one():
    assert lasting(1.25, "s") == "1.25 s"
    assert lasting(1.23456, "", ".3g") == "1.23"
    system = System(
        "neuron",
        (State("V", "mV"),),
        (Parameter("g", 1.0, "1/ms"),),
        (Mode("only", lambda t, x, p, dx: None),),
    )
    assert system.time_unit == "ms"
    assert system.lasting(12.0) == "12 ms"
