"""What branches cost too much is left for later: bounded, named, and gone on with to the same bits."""

from __future__ import annotations

import math
import shlex
from pathlib import Path

import numpy as np
import pytest
from cut_branches import bits

from contwalk.cli.entry import run as command_line
from contwalk.errors import DatabaseError, RunFileError
from contwalk.labels import END
from contwalk.storage import open_database
from contwalk.workflow.run_file.reading import read_run_file
from contwalk.workflow.runner import Reporter, run

# Rössler's band: doublings at c = 2.8324 and 3.8374.
PLUGIN = """\
from contwalk.system import Mode, Parameter, State, System

def field(t, x, p, dx):
    dx[0] = -x[1] - x[2]
    dx[1] = x[0] + 0.2 * x[1]
    dx[2] = 0.2 + x[2] * (x[0] - p.c)

SYSTEM = System(
    "band", states=(State("x"), State("y"), State("z")), parameters=(Parameter("c", 2.0),),
    modes=(Mode("only", field),),
)
"""

RUN = """\
contwalk: 1
system: ./band.py
start: {simulate: {state: {x: 1, y: 1, z: 0}, until: settled}}
continue: {parameter: c, range: [2.0, 4.0]}
diagram: {depth: 2, effort: none}
accuracy: 1e-6
"""

FORKS = """\
from contwalk.system import Mode, Parameter, Start, State, System

def field(t, x, p, dx):
    dx[0] = p.r * x[0] + x[0] ** 3 - x[0] ** 5

SYSTEM = System(
    "fork", states=(State("x"),), parameters=(Parameter("r", -0.5),), modes=(Mode("only", field),),
    starts=(Start("rest", lambda p: [[0.0]]),),
)
"""

FORKED = """\
contwalk: 1
system: ./fork.py
start: {equilibrium: rest}
continue: {parameter: r, range: [-1.0, 3.0]}
"""

# Pads at 1 and 2: one family of forced orbits, which rests on none of them, on one, on both.
PADS = """\
from math import cos, pi

from contwalk.system import Mode, Parameter, State, System, Transition

def held(pads):
    def rate(t, x, p, dx):
        dx[0] = x[1]
        dx[1] = p.A * cos(0.8 * t) - x[0] - 0.4 * x[1]
        if pads > 0:
            dx[1] -= 0.5 * (x[0] - 1.0)
        if pads > 1:
            dx[1] -= 0.5 * (x[0] - 2.0)
    return rate

def before(place):
    return lambda t, x, p: place - x[0]

def beyond(place):
    return lambda t, x, p: x[0] - place

SYSTEM = System(
    "pads", states=(State("x"), State("v")), parameters=(Parameter("A", 0.3),),
    modes=tuple(Mode(name, held(pads)) for pads, name in enumerate(("free", "one", "two"))),
    transitions=(
        Transition("hits1", "free", "one", before(1.0)), Transition("leaves1", "one", "free", beyond(1.0)),
        Transition("hits2", "one", "two", before(2.0)), Transition("leaves2", "two", "one", beyond(2.0)),
    ),
    period=lambda p: 2.5 * pi,
)
"""

PADDED = """\
contwalk: 1
system: ./pads.py
start: {simulate: {state: {x: 0.1, v: 0}, mode: free, until: settled}}
continue: {parameter: A, range: [0.1, 3.0]}
diagram: {depth: 4, effort: none}
events: {GR: switch}
"""


@pytest.fixture(scope="module")
def band(tmp_path_factory):
    folder = tmp_path_factory.mktemp("band")
    (folder / "band.py").write_text(PLUGIN, encoding="utf-8")
    (folder / "run.yaml").write_text(RUN, encoding="utf-8")
    return folder


def computed(folder, output, *overrides, reporter=None, **how):
    run_file = read_run_file(folder / "run.yaml", overrides, str(folder / output))
    return run(run_file, figures=False, reporter=reporter, **how)


@pytest.fixture(scope="module")
def whole(band):
    return computed(band, "whole.h5").branches


def dearness(branch, periods, first):
    """What a doubled branch has cost up to each point, in points of so many periods, against what it shows.

    One largest step, a 64th of the range, is shown by its first point already.
    """
    each = periods * first.cost["rhs"] / len(first)
    c = branch.points["free"][:, 0]
    steps = 64 * (np.maximum.accumulate(c) - np.minimum.accumulate(c)) / 2.0
    return np.cumsum(branch.points["rhs"]) / each / (1.0 + steps)


@pytest.fixture(scope="module")
def effort(whole):
    """One that ends the second of two doubled branches where it is dearest, and no earlier."""
    found = dearness(whole[2], 4, whole[0])
    worst = int(found.argmax())
    assert 2 <= worst < len(found) - 1
    return float(0.5 * (found[worst] + found[:worst].max()))


@pytest.fixture(scope="module")
def bounded(band, effort):
    return computed(band, "bounded.h5", f"diagram.effort={effort!r}").branches


def assert_alike(ours, theirs):
    assert [bits(branch) for branch in ours] == [bits(branch) for branch in theirs]
    assert [branch.special_points for branch in ours] == [branch.special_points for branch in theirs]
    assert [branch.outcome for branch in ours] == [branch.outcome for branch in theirs]


def notes(path):
    with open_database(path) as db:
        return db.notes()


def test_a_branch_that_costs_more_stops_and_is_named(band, whole, bounded, effort):
    assert_alike(bounded[:2], whole[:2])
    third = bounded[2]
    assert (third.outcome.status, third.outcome.reason) == ("stopped", "effort")
    assert "--resume --set diagram.effort=none" in third.outcome.message
    assert bits(third) == bits(whole[2])[: len(bits(third))]  # as far as it has come
    assert len(third) == dearness(whole[2], 4, whole[0]).argmax() + 1 > 2
    assert dearness(whole[1], 2, whole[0]).max() < effort
    (note,) = [text for key, text in notes(band / "bounded.h5").items() if key == "effort"]
    assert note.startswith(f"Left for later (`diagram.effort` = {effort:g}): b3 stopped.")


def test_the_command_that_goes_on_ends_with_the_bits_of_a_run_without_bounds(band, whole, bounded):
    words = notes(band / "bounded.h5")["effort"].partition("To go on: ")[2]
    program, *arguments = shlex.split(words)
    assert program == "contwalk"
    copy = band / "gone_on.h5"
    copy.write_bytes((band / "bounded.h5").read_bytes())
    arguments[arguments.index("--output") + 1] = str(copy)
    assert command_line([*arguments, "--quiet"]) == 0
    with open_database(copy) as db:
        assert_alike(db.branches(), whole)
        assert "effort" not in db.notes()


@pytest.mark.long
def test_nothing_is_begun_where_nothing_is_left(band):
    longer = (
        "engine.step=0.05"  # the first steps show more: what all may cost together ends the doubled branch
    )
    whole = computed(band, "longer.h5", longer).branches
    few = 0.97 * whole[1].cost["rhs"] / whole[0].cost["rhs"]
    assert few > dearness(whole[1], 2, whole[0]).max()
    branches = computed(band, "few.h5", longer, f"diagram.effort={few!r}").branches
    assert [branch.outcome.reason for branch in branches] == ["bound", "effort"]
    told = notes(band / "few.h5")["effort"]
    (point,) = [point.name for point in branches[1].special_points if point.label == "PD"]
    assert f"what begins at b2/{point} was not begun" in told
    again = computed(band, "few.h5", longer, "diagram.effort=none", resume=True).branches
    assert_alike(again, whole)


def test_the_same_bits_from_several_processes(band, bounded, effort):
    others = computed(band, "jobs.h5", f"diagram.effort={effort!r}", jobs=2).branches
    assert_alike(others, bounded)


class Killing(Reporter):
    """Interrupts a run at a point of its third branch."""

    def __init__(self, number):
        self._number = number

    def point(self, info, parameter, step, unstable, number):
        if (info.name, number) == ("b3", self._number):
            raise KeyboardInterrupt


@pytest.mark.drawn(1)
@pytest.mark.parametrize("back", [1, 4])
def test_the_same_bits_after_an_interruption(band, bounded, effort, back):
    override, output = f"diagram.effort={effort!r}", f"killed{back}.h5"
    first = computed(band, output, override, reporter=Killing(len(bounded[2]) - back))
    assert first.interrupted
    assert_alike(computed(band, output, override, resume=True).branches, bounded)
    assert_alike(computed(band, output, override, resume=True).branches, bounded)


def test_a_run_does_not_go_on_with_less(band, bounded):
    with pytest.raises(DatabaseError, match=r"diagram\.effort"):
        computed(band, "bounded.h5", "diagram.effort=0.1", resume=True)


@pytest.mark.long
def test_branches_of_equilibria_have_all_their_points(tmp_path):
    (tmp_path / "fork.py").write_text(FORKS, encoding="utf-8")
    (tmp_path / "run.yaml").write_text(FORKED, encoding="utf-8")
    found = computed(tmp_path, "all.h5", "diagram.effort=none").branches
    assert found[1].cost["rhs"] > 2 * found[0].cost["rhs"]
    assert_alike(computed(tmp_path, "one.h5", "diagram.effort=1").branches, found)


def test_pieces_of_one_family_between_grazings_are_no_generations(tmp_path):
    (tmp_path / "pads.py").write_text(PADS, encoding="utf-8")
    (tmp_path / "run.yaml").write_text(PADDED, encoding="utf-8")
    found = computed(tmp_path, "all.h5").branches
    both = ("hits1", "hits2", "leaves2", "leaves1")
    assert [branch.info.signature for branch in found] == [(), ("hits1", "leaves1"), both]
    first, second, third = (branch.cost["rhs"] for branch in found)
    for_each = 2.02 * third / (64 * first / len(found[0]))  # each of two directions may have a half
    assert second > 0.02 * third  # together they cost more than one of them may
    assert_alike(computed(tmp_path, "less.h5", f"diagram.effort={for_each!r}").branches, found)
    last = computed(tmp_path, "least.h5", f"diagram.effort={0.9 * for_each!r}").branches[-1]
    assert last.outcome.reason == "effort"


@pytest.mark.slow
def test_a_neuron_whose_doubled_cycles_live_within_a_fraction_of_a_step(tmp_path):
    plugin = Path(__file__).parents[1] / "peers" / "problems" / "hodgkin_huxley.py"
    rest = "{v: 0.0, m: 0.053, h: 0.596, n: 0.318}"
    starts = f"contwalk: 1\nsystem: {plugin}\nstart: {{state: {rest}}}\n"
    text = starts + "continue: {parameter: I, range: [0.0, 200.0]}\n"
    (tmp_path / "run.yaml").write_text(text, encoding="utf-8")
    branches = computed(tmp_path, "neuron.h5").branches
    labels = [[p.label for p in branch.special_points if p.label != END] for branch in branches]
    assert labels[:2] == [["HB", "HB"], ["LP", "PD", "PD", "LP", "LP"]]
    cycles, doubled = branches[1:]
    assert doubled.outcome.reason == "effort"
    each = cycles.cost["rhs"] / len(cycles)
    assert doubled.cost["rhs"] < 2 * 50 * each + 50 * each * 2 * 64 * 0.0004 + doubled.points["rhs"].max()
    assert "b3 stopped" in notes(tmp_path / "neuron.h5")["effort"]


@pytest.mark.parametrize(("written", "meant"), [("none", math.inf), ("2.5", 2.5)])
def test_effort_of_a_run_file(band, written, meant):
    assert read_run_file(band / "run.yaml", [f"diagram.effort={written}"]).effort == meant


@pytest.mark.parametrize("written", ["0", "-1", "much", "true"])
def test_what_is_no_effort_is_refused(band, written):
    with pytest.raises(RunFileError, match=r"diagram\.effort: is .*Allowed: "):
        read_run_file(band / "run.yaml", [f"diagram.effort={written}"])


def test_costs_are_counted_with_every_point(whole):
    for branch in whole:
        assert branch.cost["rhs"] == int(np.sum(branch.points["rhs"]))
