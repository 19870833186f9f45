"""Where the branches of a run begin: the entries of `start`, one `StartSpec` for each."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from contwalk.branch import LABELS
from contwalk.errors import DatabaseError, StartError
from contwalk.system.declarations import System
from contwalk.workflow.file_names import database_named
from contwalk.workflow.run_file.document import Key
from contwalk.workflow.run_file.parameters import checked_values
from contwalk.workflow.run_file.problems import Problems, allowed

if TYPE_CHECKING:
    from contwalk.workflow.run_file.model import Start

# A point of a database, as b1/HB1 or b1/12.
POINT = re.compile(rf"[A-Za-z]\w*/((?:{'|'.join(LABELS)})[1-9]\d*|\d+)")


@dataclass(frozen=True, eq=False)
class StartSpec:
    """One start.

    Parameters
    ----------
    kind : str
        `equilibrium` (named by the system), `state`, `simulate` or `from` (a point of another database).
    parameters : mapping
        Values of all parameters. On a parameter path they are those at the lower end of the range.
    given : mapping
        The values among them that the run file gives itself. A start of kind `from` has the parameters
        stored with its point, changed by these; the free parameter is among them only if this start gives
        it.
    name : str, optional
        The named equilibrium.
    optional : bool
        It comes from `equilibrium: all`, so that it may not exist at these parameters.
    state : ndarray of shape (n,), optional
        For `state`, and where `simulate` sets out.
    until : float or "settled", optional
        How long to simulate, in seconds.
    mode : str, optional
        The mode that `state` is of; the first one where the run file names none.
    at : str, optional
        The transition that `state` comes right before: it happens first.
    file, point : Path and str, optional
        The database and its point, `b1/HB1` or `b1/12`.
    where : str
        Its place in the run file, as `run.yaml, line 4, key start`; empty where it is from none.
    """

    kind: str
    parameters: Mapping[str, float]
    given: Mapping[str, float] = field(default_factory=dict)
    name: str | None = None
    optional: bool = False
    state: np.ndarray | None = None
    until: float | str | None = None
    mode: str | None = None
    at: str | None = None
    file: Path | None = None
    point: str | None = None
    where: str = ""

    @contextmanager
    def errors_placed(self) -> Iterator[None]:
        """Errors of what it names, a database or an equilibrium, with its place in the run file."""
        try:
            yield
        except (StartError, DatabaseError) as error:
            place = f"{self.where}: " if self.where else ""
            raise type(error)(f"{place}{error.sentence}", error.remedy) from error


@dataclass(frozen=True)
class StartReader:
    """What the entries of `start` are checked against.

    `parameters` are those of the run, `given` the ones among them that the file gives, `varying` the
    parameters that the continuation changes and `settable` whether a start may still set those.
    """

    problems: Problems
    system: System
    base: Path
    parameters: Mapping[str, float]
    given: Mapping[str, float]
    varying: tuple[str, ...]
    settable: bool

    def read(self, starts: tuple[Start, ...]) -> tuple[StartSpec, ...]:
        """All starts of the run, a named equilibrium each."""
        return tuple(
            spec for index, start in enumerate(starts) for spec in self._entry(("start", index), start)
        )

    def _entry(self, key: Key, start: Start) -> list[StartSpec]:
        own = checked_values(self.problems, (*key, "parameters"), self.system, start.parameters)
        for name in own if not self.settable else ():
            if name in self.varying:
                self.problems.add(
                    (*key, "parameters", name), f"'{name}' is set by the path.", "Remove it here."
                )
        fixed = {name: value for name, value in self.given.items() if name not in self.varying}
        where = self.problems.document.where(key)
        parameters, given = {**self.parameters, **own}, {**fixed, **own}
        if start.equilibrium is not None:
            return [
                StartSpec("equilibrium", parameters, given, name=name, optional=optional, where=where)
                for name, optional in self._equilibria((*key, "equilibrium"), start.equilibrium)
            ]
        if start.state is not None:
            mode = self._mode(key, start.mode, start.at)
            state = self._state((*key, "state"), start.state, mode)
            return [StartSpec("state", parameters, given, state=state, mode=mode, at=start.at, where=where)]
        if start.simulate is not None:
            inner, key = start.simulate, (*key, "simulate")
            mode = self._mode(key, inner.mode, inner.at)
            state = self._state((*key, "state"), inner.state, mode)
            until, at = inner.until, inner.at
            return [
                StartSpec(
                    "simulate", parameters, given, state=state, until=until, mode=mode, at=at, where=where
                )
            ]
        file, point = database_named(self.base, str(start.from_)), str(start.point)
        if not POINT.fullmatch(point):
            self.problems.add(
                (*key, "point"), f"'{point}' names no point.", "Allowed: BRANCH/POINT, as b1/HB1 or b1/12."
            )
        return [StartSpec("from", parameters, given, file=file, point=point, where=where)]

    def _equilibria(self, key: Key, names: tuple[str, ...]) -> list[tuple[str, bool]]:
        """Names of equilibria, each with whether it may be missing."""
        known = [start.name for start in self.system.starts]
        if names == ("all",) and "all" not in known:
            if not known:
                self.problems.add(
                    key,
                    f"system '{self.system.name}' names no equilibria.",
                    "Give the state itself, as in start: {state: {...}}.",
                )
            return [(name, True) for name in known]
        for index, name in enumerate(names):
            try:
                self.system.start(name)
            except StartError as error:
                self.problems.add((*key, index), error.sentence, error.remedy)
            if name in names[:index]:
                self.problems.add((*key, index), f"'{name}' is listed twice.", "Keep one of them.")
        return [(name, False) for name in names]

    def _mode(self, key: Key, mode: str | None, at: str | None) -> str:
        """The mode that a state is of: the one named, else that of the transition, else the first."""
        system = self.system
        modes, acting = [m.name for m in system.modes], list(dict.fromkeys(t.name for t in system.acting))
        if mode is not None and mode not in modes:
            self.problems.add(
                (*key, "mode"), f"'{mode}' is no mode of '{system.name}'.", allowed(modes, mode)
            )
            return modes[0]
        if at is not None and at not in acting:
            known = bool(system.sources(at))
            sentence = f"'{at}' is watched and changes nothing." if known else f"'{at}' is no transition."
            self.problems.add((*key, "at"), sentence, allowed(acting, at))
            return mode or modes[0]
        sources = () if at is None else system.sources(at)
        if at is not None and mode is None and len(sources) > 1:
            self.problems.add(
                (*key, "at"),
                f"'{at}' leads out of several modes.",
                f"Name the one it leads out of with mode: {' | '.join(sources[:5])}.",
            )
        if mode is not None and sources and mode not in sources:
            self.problems.add(
                (*key, "mode"), f"is {mode}, but '{at}' leads out of mode {sources[0]}.", "Leave it out."
            )
        return mode or (sources[0] if sources else modes[0])

    def _state(self, key: Key, values: Mapping[str, float], mode: str) -> np.ndarray:
        """The state as an array in the system's order; NaN where a problem has been noted.

        States that do not exist in the mode may be left out, and are 0.
        """
        system, names = self.system, self.system.state_names
        existing = [names[i] for i in system.states_of(mode)]
        for name in values:
            if name not in names:
                self.problems.add(
                    (*key, name), f"'{name}' is not a state of '{system.name}'.", allowed(names, name)
                )
            elif name not in existing and values[name] != 0.0:
                self.problems.add(
                    (*key, name),
                    f"'{name}' does not exist in mode '{mode}'.",
                    "Leave it out, or name its mode.",
                )
        missing = [name for name in existing if name not in values]
        if missing:
            self.problems.add(
                key,
                f"gives no value for {', '.join(missing)}.",
                f"Every state is needed: {', '.join(existing)}.",
            )
        return np.array([values.get(name, np.nan if name in existing else 0.0) for name in names])
