"""What a ray of pushes is, and its row: a pure function of the study and the ray, wherever it is computed."""

from __future__ import annotations

import hashlib
import json
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from contwalk.errors import ContwalkError
from contwalk.numerics.threads import one_thread
from contwalk.studies.margins.borders import borders_on
from contwalk.studies.margins.solution import Solution
from contwalk.studies.margins.survival import SURVIVED, Rule, Survival
from contwalk.system import load_system

# Of the magnitude of a state: where the search on a ray begins.
BEGIN = 0.05


@dataclass(frozen=True)
class Ray:
    """A push one way at an instant.

    Parameters
    ----------
    number, instant : int
    state : str
        The one that is pushed, or the name of a direction.
    sign : int
        +1 or -1.
    vector : tuple of float
        The push of size 1, for all n states.
    unit : float
        The size at which a state is pushed by its own magnitude, and none by more.
    """

    number: int
    instant: int
    state: str
    sign: int
    vector: tuple[float, ...]
    unit: float


@dataclass(frozen=True, eq=False)
class Study:
    """What all rays share; it can be sent to another process.

    Parameters
    ----------
    reference, model, base : str, mapping, str
        From which the system is loaded there.
    source : str
        Hash of its files.
    solution : Solution
    rule : Rule
    accuracy, scan, farthest
        Of the search for borders; see `borders_on`.
    """

    reference: str
    model: dict[str, Any]
    base: str
    source: str
    solution: Solution
    rule: Rule
    accuracy: float
    scan: int
    farthest: float

    @cached_property
    def key(self) -> str:
        """Tells studies apart that one worker computes rays of."""
        content = [
            self.reference,
            str(sorted(self.model.items())),
            self.base,
            self.source,
            str(sorted(self.solution.parameters.items())),
            *(instant.state.tobytes().hex() + instant.mode for instant in self.solution.instants),
            repr((self.rule, self.accuracy, self.scan, self.farthest)),
        ]
        return hashlib.sha256(json.dumps(content).encode()).hexdigest()


def row_of(study: Study, ray: Ray) -> dict[str, Any]:
    """The row of a ray; the same wherever it is computed.

    Raises
    ------
    ContwalkError
        If the system here is not the one of the study.
    """
    with one_thread():
        survival = survival_of(study)
        instant = study.solution.instants[ray.instant]
        along = ray.sign * np.array(ray.vector)
        verdicts: dict[float, str] = {}

        def survives(size: float) -> bool:
            verdicts[size] = survival.verdict(instant, size * along)
            return verdicts[size] == SURVIVED

        farthest = study.farthest * ray.unit
        found = borders_on(survives, BEGIN * ray.unit, farthest, study.accuracy, study.scan)
    first = found.borders[0] if found.borders else None
    lost = [size for size, ended in verdicts.items() if ended != SURVIVED and (first is None or size > first)]
    return {
        "number": ray.number,
        "instant": ray.instant,
        "fraction": instant.fraction,
        "state": ray.state,
        "sign": ray.sign,
        "vector": list(ray.vector),
        "border": first,
        "several": found.several,
        "borders": list(found.borders),
        "ends": verdicts[min(lost)] if lost else SURVIVED,
        "simulations": found.simulations,
        "farthest": found.farthest,
    }


# Tests of studies by their keys, with their machines, made once in each process.
_TESTS: dict[str, Survival] = {}
MOST_TESTS = 4


def survival_of(study: Study) -> Survival:
    """The test of a study, made where it is first asked for.

    Raises
    ------
    ContwalkError
        If the system here is not the one of the study.
    """
    if study.key not in _TESTS:
        system = load_system(study.reference, dict(study.model), Path(study.base))
        if system.source != study.source:
            raise ContwalkError(
                f"The system '{study.reference}' is another one here than where the study was begun.",
                "Install the same files wherever runs are computed.",
            )
        while len(_TESTS) >= MOST_TESTS:
            _TESTS.pop(next(iter(_TESTS)))
        _TESTS[study.key] = Survival(system, study.solution, study.rule)
    return _TESTS[study.key]
