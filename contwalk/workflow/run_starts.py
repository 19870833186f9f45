"""Where the branches of a run begin: the entries of `start`, one `StartSpec` for each."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from contwalk.branch import LABELS
from contwalk.errors import StartError
from contwalk.system.declarations import System
from contwalk.workflow.run_model import Start
from contwalk.workflow.run_parameters import checked_values
from contwalk.workflow.run_problems import Problems, allowed
from contwalk.workflow.yaml_lines import Key

_POINT = re.compile(rf"[A-Za-z]\w*/((?:{'|'.join(LABELS)})[1-9]\d*|\d+)")


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
    file, point : Path and str, optional
        The database and its point, `b1/HB1` or `b1/12`.
    line : int, optional
        The line in the run file, where it is from there.
    """

    kind: str
    parameters: Mapping[str, float]
    given: Mapping[str, float] = field(default_factory=dict)
    name: str | None = None
    optional: bool = False
    state: np.ndarray | None = None
    until: float | str | None = None
    file: Path | None = None
    point: str | None = None
    line: int | None = None


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
        _, origin = self.problems.document.locate(key)
        line = origin if isinstance(origin, int) else None
        parameters, given = {**self.parameters, **own}, {**fixed, **own}
        if start.equilibrium is not None:
            return [
                StartSpec("equilibrium", parameters, given, name=name, optional=optional, line=line)
                for name, optional in self._equilibria((*key, "equilibrium"), start.equilibrium)
            ]
        if start.state is not None:
            state = self._state((*key, "state"), start.state)
            return [StartSpec("state", parameters, given, state=state, line=line)]
        if start.simulate is not None:
            state = self._state((*key, "simulate", "state"), start.simulate.state)
            until = start.simulate.until
            return [StartSpec("simulate", parameters, given, state=state, until=until, line=line)]
        file, point = self.base / str(start.from_), str(start.point)
        if not _POINT.fullmatch(point):
            self.problems.add(
                (*key, "point"), f"'{point}' names no point.", "Allowed: BRANCH/POINT, as b1/HB1 or b1/12."
            )
        return [StartSpec("from", parameters, given, file=file, point=point, line=line)]

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

    def _state(self, key: Key, values: Mapping[str, float]) -> np.ndarray:
        """The state as an array in the system's order; NaN where a problem has been noted."""
        names = self.system.state_names
        for name in values:
            if name not in names:
                self.problems.add(
                    (*key, name), f"'{name}' is not a state of '{self.system.name}'.", allowed(names, name)
                )
        missing = [name for name in names if name not in values]
        if missing:
            self.problems.add(
                key,
                f"gives no value for {', '.join(missing)}.",
                f"Every state is needed: {', '.join(names)}.",
            )
        return np.array([values.get(name, np.nan) for name in names])
