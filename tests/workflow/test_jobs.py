"""A study is the same to the last bit on any number of processes, whatever becomes of them."""

from __future__ import annotations

import os
import signal
import threading
from concurrent.futures import Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from dataclasses import replace
from multiprocessing import get_context
from pathlib import Path

import pytest

from contwalk.cli import entry
from contwalk.diagram import branch_walk
from contwalk.diagram.ahead import NAMELESS, Ends, Note, Point, Task
from contwalk.errors import PluginError
from contwalk.storage import open_database
from contwalk.workflow import workers
from contwalk.workflow.executors import NoExecutor
from contwalk.workflow.run_file.reading import read_run_file
from contwalk.workflow.runner import Reporter, run
from contwalk.workflow.study_text import StudyText
from contwalk.workflow.walking_ahead import Seeds, Walker
from contwalk.workflow.workers import LOST, MOST_LOST, Workers

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parents[2]

PLUGIN = """
from contwalk.system import Mode, Parameter, Start, State, System


def field(t, x, p, dx):
    dx[0] = p.a * x[0] - x[0] ** 3 + p.c * x[1]
    dx[1] = (p.a - p.b) * x[1] - x[1] ** 3 - p.c * x[0]


def rest(p):
    return [[0.0, 0.0]]


SYSTEM = System(
    "pair",
    states=(State("x", "1", 1.0, "first"), State("y", "1", 1.0, "second")),
    parameters=(
        Parameter("a", 0.5, "1", (-9.0, 9.0), "growth"),
        Parameter("b", 0.3, "1", (-9.0, 9.0), "difference"),
        Parameter("c", 0.0, "1", (-9.0, 9.0), "coupling"),
    ),
    modes=(Mode("only", field),),
    starts=(Start("rest", rest, "at rest"),),
)
"""
STUDY = """
contwalk: 1
system: ./pair.py
start: {{equilibrium: rest}}
continue: {{parameter: a, range: [-0.5, 1.5], max_points: 40}}
diagram: {{follow: [BP, HB], depth: {depth}}}
sweep: {{c: {values}}}
output: pair.h5
"""


def written(folder: Path) -> Path:
    """Three lines, of branches of equilibria that leave each other, and of an orbit where it is turning."""
    (folder / "pair.py").write_text(PLUGIN)
    path = folder / "pair.yaml"
    path.write_text(STUDY.format(depth=3, values="[0.0, 0.05, 0.4]"))
    return path


@pytest.fixture
def study(tmp_path) -> Path:
    return written(tmp_path)


@pytest.fixture(scope="module")
def alone(tmp_path_factory) -> Path:
    """What one process stores of the study."""
    return computed(written(tmp_path_factory.mktemp("alone")), "1.h5")


def computed(path: Path, name: str, overrides: tuple[str, ...] = (), **given) -> Path:
    output = name if path.parent == ROOT / "runs" else str(path.parent / name)
    run_file = read_run_file(path, overrides, output)
    run(run_file, figures=False, **given)
    return run_file.output


def assert_identical(one: Path, other: Path) -> None:
    """All that is stored but for the seconds that it took, byte by byte."""
    with open_database(one) as a, open_database(other) as b:
        assert a.branch_names() == b.branch_names()
        assert a.notes() == b.notes()
        for first, second in zip(a.branches(), b.branches(), strict=True):
            assert first.info == second.info
            for column in set(first.points.dtype.names) - {"seconds"}:
                assert first.points[column].tobytes() == second.points[column].tobytes(), column
            assert repr(first.outcome) == repr(second.outcome)
            for p, q in zip(first.special_points, second.special_points, strict=True):
                assert repr(vars(p)) == repr(vars(q))


def test_any_number_of_processes_stores_the_same_bytes(study, alone):
    with open_database(alone) as db:
        assert len(db.branches()) == 6
        assert {branch.info.problem for branch in db.branches()} == {"equilibrium", "periodic_orbit"}
    for jobs in (2, 4):
        assert_identical(alone, computed(study, f"{jobs}.h5", jobs=jobs))


@pytest.mark.parametrize(
    ("file", "short"),
    [
        ("autobalancer_cascade.yaml", ("continue.max_points=12",)),
        pytest.param("autobalancer_load.yaml", ("continue.max_points=25",), marks=pytest.mark.long),
        pytest.param("planar_slope.yaml", ("continue.max_points=6",), marks=pytest.mark.long),
        pytest.param(
            "walker3d_figure9.yaml", ("continue.max_points=3", "diagram.depth=1"), marks=pytest.mark.long
        ),
    ],
)
def test_studies_of_the_thesis_are_the_same_on_two_processes(file, short, tmp_path):
    path = ROOT / "runs" / file
    alone = computed(path, str(tmp_path / "1.h5"), short)
    assert_identical(alone, computed(path, str(tmp_path / "2.h5"), short, jobs=2))


class Interrupting(Reporter):
    """Ctrl-C at the point of a given number."""

    def __init__(self, number: int) -> None:
        self._left = number

    def point(self, info, parameter, step, unstable, number):
        self._left -= 1
        if self._left == 0:
            raise KeyboardInterrupt


@pytest.mark.drawn(1)
@pytest.mark.parametrize("first", [1, 2])
def test_what_was_interrupted_goes_on_on_another_number_of_processes(study, alone, first):
    for number in (7, 90):
        path = study.parent / f"{number}.h5"
        run_file = read_run_file(study, (), str(path))
        result = run(run_file, figures=False, reporter=Interrupting(number), jobs=first)
        assert result.interrupted
        assert sum(len(branch) for branch in result.branches) == number
        computed(study, path.name, jobs=3 - first, resume=True)
        assert_identical(alone, path)


def shown(messages) -> list:
    """Messages as plain values, without the seconds that they took."""
    result = []
    for message in messages:
        if isinstance(message, Point):
            row = message.row
            names = [] if row is None else [name for name in row.dtype.names if name != "seconds"]
            special = None if message.special is None else vars(message.special)
            result.append(([row[name].tobytes() for name in names], repr(special)))
        else:
            result.append(repr(message))
    return result


def test_a_killed_process_loses_nothing(study):
    text = StudyText.of(read_run_file(study))
    expected = shown(Walker(text).messages(Task((2,))))
    for kills in (1, MOST_LOST, MOST_LOST + 1):  # after the last one it is walked here
        workers = Workers(text, 1)
        try:
            found, left = [], kills
            for message in workers.messages(Task((2,))):
                found.append(message)
                if left and len(found) > 4 * (kills - left + 1):
                    for number in workers.process_ids:
                        os.kill(number, signal.SIGKILL)
                    left -= 1
            assert shown(found) == expected
        finally:
            workers.close()


class Ending:
    """A process that ends as soon as it is asked for a branch."""

    number, own_end = 0, ""

    def __init__(self, pool) -> None:
        self.task, self._pool = None, pool

    def send(self, request) -> None:
        threading.Thread(target=self._pool.ended, args=(self,)).start()

    def end(self) -> None:
        pass


def test_it_is_said_that_a_process_has_ended_and_where_its_branch_is_walked(study, monkeypatch):
    monkeypatch.setattr(workers, "_Process", Ending)
    text, told = StudyText.of(read_run_file(study)), list[str]()
    pool = Workers(text, 1, told.append)
    assert shown(pool.messages(Task((2,)))) == shown(Walker(text).messages(Task((2,))))
    assert told[:-1] == [LOST] * MOST_LOST
    assert told[-1].startswith(
        "A branch is computed in the run's own process, because others have failed at it"
    )


ENDING = """
import ctypes
import sys


def seen(t, x, p):
    if "worker" in sys.argv[0] and p.a > 0.4:
        ctypes.CDLL(None)._exit(0)
    return p.a
"""


def test_a_plugin_that_ends_its_processes_is_told_and_the_run_fails(study, capsys):
    plugin = study.parent / "pair.py"
    text = plugin.read_text(encoding="utf-8").replace("import Mode", "import Mode, Observable")
    text = text.replace(
        "    starts=", '    observables=(Observable("seen", seen, "1", "what is seen"),),\n    starts='
    )
    plugin.write_text(ENDING + text, encoding="utf-8")
    output = study.parent / "ended.h5"
    command = ["continue", str(study), "--jobs", "2", "--no-figures", "--output", str(output)]
    assert entry.run(command) == 1
    assert "the last one ended itself with exit code 0" in " ".join(capsys.readouterr().err.split())
    with open_database(output) as db:
        failed = [branch for branch in db.branches() if branch.outcome.status == "failed"]
        assert failed
        assert {branch.outcome.reason for branch in failed} == {"plugin_error"}


@pytest.mark.long
def test_no_more_processes_begin_than_there_are_processors(study, alone, monkeypatch):
    begun = []

    class Counted(workers._Process):
        def __init__(self, pool):
            begun.append(sum(not process.has_answered for process in pool._processes))
            super().__init__(pool)

    monkeypatch.setattr(workers, "_Process", Counted)
    monkeypatch.setattr(workers, "processors", lambda: 1)
    assert_identical(alone, computed(study, "2.h5", jobs=1000))
    assert begun
    assert set(begun) == {0}


def test_a_run_goes_on_though_a_process_is_killed(study, alone, monkeypatch):
    made: list[Workers] = []
    begin = Workers.__init__
    monkeypatch.setattr(Workers, "__init__", lambda own, *given: (made.append(own), begin(own, *given))[1])

    class Killing(Reporter):
        left = 3

        def point(self, info, parameter, step, unstable, number):
            if number == 5 and self.left:
                self.left -= 1
                for process in made[0].process_ids:
                    os.kill(process, signal.SIGKILL)

    reporter = Killing()
    assert_identical(alone, computed(study, "2.h5", jobs=2, reporter=reporter))
    assert reporter.left == 0
    assert made[0].process_ids == []


class Breaking:
    """As of a pool whose process was killed by the system: what is asked for later is refused at once."""

    def __init__(self) -> None:
        self.asked = 0

    def submit(self, function, *arguments):
        self.asked += 1
        if self.asked > 2:
            raise BrokenProcessPool("A process in the pool was terminated abruptly.")
        future: Future = Future()
        future.set_exception(BrokenProcessPool("A process in the pool was terminated abruptly."))
        return future


def test_a_run_goes_on_though_its_pool_breaks(study, alone):
    told: list[str] = []

    class Telling(Reporter):
        def note(self, text):
            told.append(text)

    assert_identical(alone, computed(study, "2.h5", executor=Breaking(), reporter=Telling()))
    said = [text for text in told if text.startswith("A branch is computed in the run's own process")]
    assert said
    assert all("BrokenProcessPool: A process in the pool was terminated abruptly." in text for text in said)


class OnlyMap:
    """As of an MPI pool: one call, whose results come in order."""

    def __init__(self) -> None:
        self.calls: list[int] = []

    def map(self, function, items):
        items = list(items)
        self.calls.append(len(items))
        return [function(item) for item in items]


def test_any_object_with_map_or_submit_walks(study, alone):
    pool = OnlyMap()
    assert_identical(alone, computed(study, "map.h5", executor=pool))
    assert pool.calls[0] == 6  # both directions of all lines at once
    with ProcessPoolExecutor(2, mp_context=get_context("forkserver")) as executor:
        assert_identical(alone, computed(study, "submit.h5", executor=executor))
    with pytest.raises(NoExecutor, match="neither submit nor map"):
        computed(study, "none.h5", executor=object())


def test_curves_from_points_of_another_database_are_walked_ahead(study, alone):
    with open_database(alone) as db:
        found = [(b.name, p.name) for b in db.branches() for p in b.special_points if p.label == "HB"]
    (branch, point), *_ = found
    path = study.parent / "curve.yaml"
    path.write_text(
        "contwalk: 1\nsystem: ./pair.py\noutput: curve.h5\n"
        f"start: {{from: {alone}, point: {branch}/{point}}}\n"
        "continue: {parameters: [a, c], range: {a: [-0.5, 1.5], c: [0.2, 0.6]}}\n"
    )
    pool = OnlyMap()
    one = computed(path, "curve1.h5")
    assert_identical(one, computed(path, "curve_map.h5", executor=pool))
    assert pool.calls[0] == 2  # both directions


CIRCLE = """
from contwalk.system import Mode, Parameter, Start, State, System


def field(t, x, p, dx):
    dx[0] = p.a * p.a + x[0] * x[0] - 1.0


SYSTEM = System(
    "circle",
    states=(State("x", "1", 1.0, "height"),),
    parameters=(Parameter("a", 0.6, "1", (-9.0, 9.0), "width"),),
    modes=(Mode("only", field),),
    starts=(Start("on_it", lambda p: [[0.8]]),),
)
"""


@pytest.mark.long
def test_the_other_direction_of_a_closed_branch_is_not_there(tmp_path):
    (tmp_path / "circle.py").write_text(CIRCLE)
    path = tmp_path / "circle.yaml"
    path.write_text(
        "system: ./circle.py\nstart: {equilibrium: on_it}\ncontinue: {parameter: a, range: [-3, 3]}\n"
        "output: circle.h5\n"
    )
    alone = computed(path, "1.h5")
    with open_database(alone) as db:
        assert [branch.outcome.reason for branch in db.branches()] == ["closed"]
    assert_identical(alone, computed(path, "2.h5", jobs=2))
    assert_identical(alone, computed(path, "map.h5", executor=OnlyMap()))


@pytest.mark.drawn(1)
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_an_error_on_one_side_ends_the_branch_as_it_does_alone(study, monkeypatch, side):
    own = branch_walk.walk

    def breaking(problem, state, settings, observer, sign, most, **rest):
        for number, event in enumerate(own(problem, state, settings, observer, sign, most, **rest)):
            if sign == side and number == 4:
                raise PluginError("Broken for the test.")
            yield event

    monkeypatch.setattr(branch_walk, "walk", breaking)
    alone = computed(study, "1.h5")
    with open_database(alone) as db:
        broken = [branch for branch in db.branches() if "Broken for the test" in branch.outcome.message]
        assert broken
    assert_identical(alone, computed(study, "map.h5", executor=OnlyMap()))


def test_another_plugin_than_that_of_the_run_is_refused(study):
    text = StudyText.of(read_run_file(study))
    (study.parent / "pair.py").write_text(PLUGIN.replace("p.a * x[0]", "p.a * x[0] * 1.0"))
    with pytest.raises(PluginError, match="not the one that the run began with"):
        Walker(text)


def test_what_grows_out_of_a_branch_is_made_once_in_a_process():
    """And only as far as it is asked for."""
    made: list[int] = []

    def making():
        for number in range(5):
            made.append(number)
            yield number

    seeds = Seeds(making())
    assert [seeds[number] for number in (1, 0, 2, 1)] == [1, 0, 2, 1]
    assert made == [0, 1, 2]


def test_texts_are_without_a_name_until_their_turn(study):
    """Branches are numbered in the order of the queue, which nobody who walks ahead knows."""
    walker = Walker(StudyText.of(read_run_file(study)))
    messages = list(walker.messages(Task((0,))))
    assert isinstance(messages[-1], Ends)
    assert all(NAMELESS in message.text for message in messages if isinstance(message, Note))
    assert Task((0,)) == replace(Task((0,)), ancestors=((),)) != Task((0,), 1.0)
