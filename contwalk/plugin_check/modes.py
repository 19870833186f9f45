"""Fields of modes as they are checked: each function once, however many modes share it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from contwalk.plugin_check.findings import Report
from contwalk.plugin_check.functions import check_field, field_form, traced_field
from contwalk.plugin_check.kernels import Kernels
from contwalk.plugin_check.samples import Samples
from contwalk.plugin_check.traced import Traced
from contwalk.system import Mode, System, Transition


class CheckedFields(Mapping[str, Traced]):
    """The fields of all modes whose function has been found sound; iterates over those that were checked."""

    def __init__(self, system: System) -> None:
        self._system = system
        self._checked: dict[str, Traced] = {}
        self._others: dict[str, Traced] = {}
        self._standing_in: dict[str, str] = {}
        self._kernels: dict[tuple, Kernels] = {}

    def check(self, report: Report, samples: Samples | None = None) -> None:
        """Check the field of every mode; of those that share one, that of the first.

        Without samples only its form is.
        """
        for alike in _alike(self._system.modes):
            first = alike[0]
            shared = f", which {len(alike)} modes share" if len(alike) > 1 else ""
            what = f"field of mode '{first.name}'{shared}"
            if samples is None:
                field = traced_field(report, what, first, self._system)
            else:
                field = check_field(report, what, first, self._system, samples)
            if field is not None:
                self._checked[first.name] = field
                self._standing_in |= {mode.name: first.name for mode in alike}

    def at(self, samples: Samples) -> Iterator[tuple[str, Traced, float, np.ndarray]]:
        """Names and fields of all modes with the times and states, shape (n,), at which they are tried.

        A function is tried at all sampled states in the mode that it was checked with, and at one of them, in
        turn, in each other mode: what differs there are constants.
        """
        places = list(zip(samples.times, samples.states, strict=True))
        for number, mode in enumerate(self._system.modes):
            chosen = places if mode.name in self._checked else [places[number % len(places)]]
            for t, x in chosen:
                yield mode.name, self[mode.name], t, x

    @property
    def sampled(self) -> str:
        """In words, where not all modes are tried at all sampled states; empty else."""
        others = len(self._standing_in) - len(self._checked)
        return f", at one sampled state in each of {others} that share the field of another" if others else ""

    @property
    def complete(self) -> bool:
        """Whether every mode's field is sound."""
        return len(self._standing_in) == len(self._system.modes)

    def __getitem__(self, name: str) -> Traced:
        if name in self._checked:
            return self._checked[name]
        if name not in self._standing_in:
            raise KeyError(name)
        if name not in self._others:
            mode, system = self._system.mode(name), self._system
            form, kernels = field_form(mode, system), self._shared(mode)
            self._others[name] = Traced(mode.field, system, form, mode=name, kernels=kernels)
        return self._others[name]

    def _shared(self, mode: Mode) -> Kernels:
        """The program that runs compile for all modes with the field of this one."""
        from contwalk.flow.compiled.traced import shared_program  # compiled flows

        if mode.code not in self._kernels:
            n = len(self._system.states)
            self._kernels[mode.code] = Kernels(shared_program(self._system, mode), n, n)
        return self._kernels[mode.code]

    def __contains__(self, name: object) -> bool:
        return name in self._standing_in

    def __iter__(self) -> Iterator[str]:
        return iter(self._checked)

    def __len__(self) -> int:
        return len(self._checked)


def _alike(modes: Sequence[Mode]) -> list[list[Mode]]:
    """Modes with the same function and names of constants, together."""
    found: dict[tuple, list[Mode]] = {}
    for mode in modes:
        found.setdefault(mode.code, []).append(mode)
    return list(found.values())


def distinct_transitions(system: System) -> list[Transition]:
    """The transitions, one of those that have name, guard and reset in common."""
    found: dict[tuple, Transition] = {}
    for transition in system.transitions:
        key = transition.name, transition.guard, transition.reset, transition.direction, transition.relabel
        found.setdefault(key, transition)
    return list(found.values())
