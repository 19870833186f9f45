"""Ctrl-C in Python: a sentence, nothing lost, and the same call goes on to the same bits."""

from __future__ import annotations

import sys
import types

import pytest
from killed_runs import assert_same

import contwalk as cw
from contwalk.errors import ContwalkError, Interrupted
from contwalk.shortcuts import computing, diagrams
from contwalk.workflow import notebook_line, runner
from contwalk.workflow.notebook_line import NotebookLine, watcher
from contwalk.workflow.reporter import NoteKeeper

RANGE = "r", (-0.5, 0.5)


@cw.model(r=-0.5, a=0.25)
def fork(x, y, *, r, a):
    return r * x - x**3, a - y


class Stopping(NoteKeeper):
    """Ctrl-C at a report, 0 before the first one."""

    def __init__(self, number):
        super().__init__()
        self.left = number

    def branch_began(self, info):
        self._count(0)

    def point(self, info, parameter, step, unstable, number):
        self._count(1)

    def special(self, info, point):
        self._count(1)

    def _count(self, one):
        self.left -= one
        if self.left == 0:
            self.left = -1
            raise KeyboardInterrupt


@pytest.fixture
def stopped_at(monkeypatch):
    def stop(number):
        monkeypatch.setattr(diagrams, "watcher", lambda ends: Stopping(number))

    yield stop
    assert not computing._STOPPED


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    return cw.diagram(fork, *RANGE).save(tmp_path_factory.mktemp("whole") / "fork.h5")


# At the first row, at another one, and in the branch that leaves a special point.
@pytest.mark.parametrize("number", [1, 12, 70])
def test_the_same_call_goes_on_to_the_same_bits(stopped_at, whole, number):
    stopped_at(number)
    with pytest.raises(KeyboardInterrupt, match=r"points? are kept, and the same call goes on") as caught:
        cw.diagram(fork, *RANGE)
    kept = str(caught.value).split("'")[1]
    assert 0 < sum(map(len, cw.open_database(kept))) <= number
    stopped_at(-1)
    found = cw.diagram(fork, *RANGE)
    assert str(found.path) == kept
    assert_same(whole, found.path)


def test_nothing_goes_on_where_something_else_is_asked_for(stopped_at):
    stopped_at(5)
    with pytest.raises(Interrupted):
        cw.diagram(fork, *RANGE)
    stopped_at(-1)
    other = cw.diagram(fork, "r", (-0.5, -0.1))
    assert other["b1"]["r"].max() == -0.1
    cw.diagram(fork, *RANGE)


def test_before_the_first_point_nothing_is_kept(stopped_at, tmp_path):
    stopped_at(0)
    for output in (None, tmp_path / "x.h5"):
        with pytest.raises(KeyboardInterrupt, match="before the first point: nothing is kept"):
            cw.diagram(fork, *RANGE, output=output)
    assert list(tmp_path.iterdir()) == []


def test_an_output_goes_on_in_another_process(stopped_at, whole, tmp_path):
    """As there: nothing of the first call is known but the file, and no start is given."""
    path = tmp_path / "x.h5"
    stopped_at(12)
    with pytest.raises(KeyboardInterrupt, match="the same call with resume=True goes on"):
        cw.diagram(fork, *RANGE, output=path)
    stopped_at(-1)
    with pytest.raises(ContwalkError, match=r"exists\. Go on with it by resume=True"):
        cw.diagram(fork, *RANGE, output=path)
    with pytest.raises(ContwalkError, match="settings differ from"):
        cw.diagram(fork, *RANGE, output=path, resume=True, start={"x": 3.0})
    found = cw.diagram(fork, *RANGE, output=str(path), resume=True)
    assert found.path == path
    assert found.start == "the simulation from the origin until settled"
    assert_same(whole, path)
    del found
    assert path.exists()


def test_a_start_that_leads_nowhere_leaves_no_output(tmp_path):
    nowhere = cw.system_from_text("x' = 1 + x^2 + a^2; a = 1")
    with pytest.raises(ContwalkError, match="No start of"):
        cw.diagram(nowhere, "a", (-1, 2), output=tmp_path / "x.h5")
    assert list(tmp_path.iterdir()) == []


def test_a_run_file_goes_on_as_from_the_shell(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    text = 'system: {equations: "x\' = r*x - x^3; r = -0.5"}\nstart: {state: {x: 0.0}}\n'
    (tmp_path / "run.yaml").write_text(f"{text}continue: {{parameter: r, range: [-0.5, 0.5]}}\n")
    run_file = cw.read_run_file("run.yaml")
    cut = cw.run(run_file, reporter=Stopping(9))
    assert cut.interrupted
    assert repr(cut).startswith("run into run.h5, interrupted, run(..., resume=True) goes on\nb1: 9 points")
    again = cw.run(run_file, resume=True)
    assert repr(again).startswith("run into run.h5, finished\nb1: ")
    cw.run(cw.read_run_file("run.yaml", output="whole.h5"))
    assert_same(tmp_path / "whole.h5", again.path)


def test_beside_the_computing_a_sentence_says_what_is_kept(tmp_path, monkeypatch):
    (tmp_path / "run.yaml").write_text(
        'system: {equations: "x\' = r - x^3; r = -0.5"}\nstart: {state: {x: -1.0}}\n'
        "continue: {parameter: r, range: [-0.5, 0.5]}\n"
    )

    def interrupted(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(runner, "drawn", interrupted)
    with pytest.raises(Interrupted, match=r"What was found is in .*x\.h5: run") as caught:
        cw.run(cw.read_run_file(tmp_path / "run.yaml", output=str(tmp_path / "x.h5")))
    assert caught.value._render_traceback_() == [str(caught.value)]
    assert len(cw.open_database(tmp_path / "x.h5")["b1"]) > 5


def test_one_branch_alone_keeps_nothing_and_says_so(monkeypatch):
    def interrupted(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr("contwalk.studies.verbs.opened", interrupted)
    with pytest.raises(KeyboardInterrupt, match=r"nothing is kept\. cw\.diagram and cw\.run keep"):
        cw.continue_branch(cw.Equilibrium(fork, fork.defaults(), "r"), [0.0, 0.25], (-0.5, 0.5))


class Cell:
    """A cell of a notebook: what stands in it, first and last."""

    def __init__(self):
        self.lines = []

    def display(self, line, display_id):
        assert display_id
        self.lines.append(line)
        return self

    def update(self, line):
        self.lines.append(line)


@pytest.fixture
def cell(monkeypatch):
    """A process that is a notebook's kernel, as IPython says it."""
    shown = Cell()
    python = types.ModuleType("IPython")
    python.get_ipython = lambda: types.SimpleNamespace(kernel=object())
    python.display = types.ModuleType("IPython.display")
    python.display.display = shown.display
    monkeypatch.setitem(sys.modules, "IPython", python)
    monkeypatch.setitem(sys.modules, "IPython.display", python.display)
    return shown


def test_a_cell_shows_how_far_it_is_and_what_was_computed(cell):
    found = cw.diagram(fork, *RANGE)
    first, *_, last = cell.lines
    assert str(first).startswith("b1  r = -0.5  step ")
    assert '<progress value="0.000" max="1">' in first._repr_html_()
    points = sum(map(len, found)) - len([p for p in found.special_points.values() if p.label == "BP"])
    assert str(last).endswith(f"of {len(found)} branches computed")
    assert abs(int(str(last).split()[0]) - points) <= len(found)
    assert "<progress" not in last._repr_html_()


def test_a_cell_says_that_it_was_interrupted(cell, tmp_path, monkeypatch):
    class Stopped(Stopping, NotebookLine):
        def __init__(self, ends):
            NotebookLine.__init__(self, ends, clock=lambda: 0.0)
            self.left = 9

        def point(self, info, parameter, step, unstable, number):
            NotebookLine.point(self, info, parameter, step, unstable, number)
            Stopping.point(self, info, parameter, step, unstable, number)

    monkeypatch.setattr(diagrams, "watcher", Stopped)
    with pytest.raises(Interrupted) as caught:
        cw.diagram(fork, *RANGE, output=tmp_path / "x.h5")
    assert list(map(str, cell.lines))[1:] == ["Interrupted: 9 points of 1 branch computed"]
    assert caught.value._render_traceback_() == [str(caught.value)]


def test_bad_input_shows_the_cells_own_lines_alone(cell):
    with pytest.raises(ContwalkError) as caught:
        cw.diagram(fork, "q", (0, 1))
    told = "\n".join(caught.value._render_traceback_())
    assert told.endswith("'q' is not a parameter of 'fork'. Allowed: r, a.")
    assert 'cw.diagram(fork, "q", (0, 1))' in told
    assert "contwalk/shortcuts" not in told
    assert cell.lines == []


def test_elsewhere_nobody_is_told(monkeypatch):
    monkeypatch.delitem(sys.modules, "IPython", raising=False)
    assert not notebook_line.in_notebook()
    assert type(watcher((0.0, 1.0))) is NoteKeeper
