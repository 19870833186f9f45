"""Which parts of a program its CPU time goes to.

A profiler that counts calls makes those of Python seem dear and compiled ones cheap. Here the timer of the
process interrupts it, and what has been spent since the last time counts for the functions that are running
then: a call of compiled code is interrupted when it returns.
"""

from __future__ import annotations

import inspect
import signal
import time
from collections.abc import Sequence
from dataclasses import dataclass
from importlib import import_module
from operator import attrgetter
from types import CodeType, FrameType
from typing import Any

INTERVAL = 0.002


@dataclass(frozen=True)
class Part:
    """A part of a program.

    Parameters
    ----------
    name : str
    functions : sequence of str
        As `package.module:Class.function`; whatever they call belongs to them.
    modules : sequence of str
        Modules, or packages, all of whose functions do.
    """

    name: str
    functions: Sequence[str] = ()
    modules: Sequence[str] = ()

    @property
    def codes(self) -> set[CodeType]:
        """Code of the functions."""
        return {_function(name).__code__ for name in self.functions}

    def has(self, module: str) -> bool:
        """Whether a module belongs to it."""
        return any(module == own or module.startswith(f"{own}.") for own in self.modules)


def _function(name: str) -> Any:
    module, _, path = name.partition(":")
    *owners, last = path.split(".")
    owner = attrgetter(".".join(owners))(import_module(module)) if owners else import_module(module)
    found = inspect.getattr_static(owner, last)
    return inspect.unwrap(getattr(found, "fget", None) or getattr(found, "func", None) or found)


class Shares:
    """CPU seconds of parts, between `start` and `stop`; what the main thread runs is seen.

    Attributes
    ----------
    total : float
    within : list of float
        Of each part, with all that it calls.
    own : list of float
        Of each part, without what it spends in another one.
    """

    def __init__(self, parts: Sequence[Part]) -> None:
        self.parts, self.total = parts, 0.0
        self.own, self.within = [0.0] * len(parts), [0.0] * len(parts)
        self._numbers: dict[CodeType, int] = {code: i for i, p in enumerate(parts) for code in p.codes}
        self._last, self._before = 0.0, signal.SIG_DFL

    def start(self) -> None:
        """Look, from now on."""
        self._before = signal.signal(signal.SIGPROF, self._seen)
        self._last = time.process_time()
        signal.setitimer(signal.ITIMER_PROF, INTERVAL, INTERVAL)

    def stop(self) -> None:
        """Look no more."""
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        signal.signal(signal.SIGPROF, self._before)

    def _seen(self, _: int, frame: FrameType | None) -> None:
        now = time.process_time()
        spent, self._last = now - self._last, now
        running = list(dict.fromkeys(self._running(frame)))
        self.total += spent
        for number in running:
            self.within[number] += spent
        if running:
            self.own[running[0]] += spent

    def _running(self, frame: FrameType | None) -> list[int]:
        """Numbers of the parts that run, the innermost first."""
        found = []
        while frame is not None:
            number = self._number(frame)
            if number >= 0:
                found.append(number)
            frame = frame.f_back
        return found

    def _number(self, frame: FrameType) -> int:
        code = frame.f_code
        if code not in self._numbers:
            module = frame.f_globals.get("__name__", "")
            self._numbers[code] = next((i for i, part in enumerate(self.parts) if part.has(module)), -1)
        return self._numbers[code]
