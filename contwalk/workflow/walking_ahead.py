"""A branch of a run file from the run file's text and the branch's number: the same wherever it is walked."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from contwalk.branch import Outcome, SpecialPoint
from contwalk.diagram.ahead import NAMELESS, Message, Task, messages_of
from contwalk.diagram.branch_in_progress import Start
from contwalk.diagram.branch_walk import BranchWalk
from contwalk.diagram.growing import grown
from contwalk.memory import remembered
from contwalk.numerics.threads import one_thread
from contwalk.workflow.plans import all_places, coverage_of, start_at, studies_of
from contwalk.workflow.run_file.reading import read_run_text
from contwalk.workflow.study_text import StudyText

# Starts are kept for the branches that leave theirs.
MOST_STARTS = 64


class Seeds:
    """Starts in their order, each made when it, or a later one, is asked for: some take simulations."""

    def __init__(self, starts: Iterator[Start]) -> None:
        self._starts, self._made = starts, list[Start]()

    def __getitem__(self, number: int) -> Start:
        while len(self._made) <= number:
            self._made.append(next(self._starts))
        return self._made[number]


class Walker:
    """The branches of one run file, walked in this process.

    Raises
    ------
    PluginError
        If the plugin is not the one that the run began with.
    """

    def __init__(self, study: StudyText) -> None:
        run_file = read_run_text(study.text, study.path, study.overrides)
        study.check(run_file.system_reference, run_file.system)
        self._coverage = coverage_of(run_file)
        self._walk = BranchWalk(self._coverage)
        self._places = all_places(studies_of(run_file))
        self._known: dict[tuple[int, ...], Start] = {}
        self._seeds: dict[tuple[int, ...], Seeds] = {}

    def messages(self, task: Task) -> Iterator[Message]:
        """All that is to be told of a branch, as it is found."""
        yield from messages_of(self._walk, self._start(task), task.side, task.allowed)

    def _start(self, task: Task) -> Start:
        """The start of a branch: one of the run's, or one that grows out of another branch."""
        return remembered(self._known, task.number, MOST_STARTS, lambda: self._begun(task))

    def _begun(self, task: Task) -> Start:
        *above, last = task.number
        if not above:
            return start_at(*self._places[last])
        parent = Task(tuple(above), None, task.ancestors[:-1])
        seeds = remembered(
            self._seeds, parent.number, MOST_STARTS, lambda: self._grown(parent, task.ancestors[-1])
        )
        return seeds[last]

    def _grown(self, task: Task, special_points: Sequence[SpecialPoint]) -> Seeds:
        """What grows out of the branch of a start with these special points."""
        start = self._start(task)
        assert not isinstance(start.opening, Outcome)
        return Seeds(grown(self._coverage, start, start.opening.problem, NAMELESS, special_points))


def failed_elsewhere(why: str) -> str:
    """A sentence on a branch that others have failed at; of `why`, a traceback perhaps, the end counts."""
    last = why.strip().splitlines()[-1].rstrip(".") if why.strip() else "nothing was told"
    return f"A branch is computed in the run's own process, because others have failed at it: {last}."


_WALKERS: dict[StudyText, Walker] = {}


@one_thread()
def walked(study: StudyText, task: Task) -> list[Message]:
    """All that is to be told of a branch of a run file: pure, and to be sent to any process.

    What a process has prepared for a run file is kept for its next branch.
    """
    return list(remembered(_WALKERS, study, 1, lambda: Walker(study)).messages(task))
