"""The motions of a sampling: where they set out and what they are measured by, each from its number alone.

So any of them can be computed anywhere, from the run file's text.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from contwalk.errors import StartError
from contwalk.flow.compiled.traced import field_of
from contwalk.flow.ensemble.sampling import Measured, Motions, measure
from contwalk.flow.events.guard import Guard
from contwalk.flow.events.motion import Machine, magnitudes
from contwalk.memory import remembered
from contwalk.numerics.threads import one_thread
from contwalk.problems.equilibrium.declared import named_equilibria
from contwalk.system import System
from contwalk.system.declarations import ParameterValues
from contwalk.workflow.run_file.products import Product
from contwalk.workflow.run_file.sample import SampleFile, read_sampling_text
from contwalk.workflow.simulating import start_of
from contwalk.workflow.study_text import StudyText

MOST_IMAGES = 120  # of an equilibrium under symmetries that rename: five things can be renumbered so often


@dataclass(frozen=True, eq=False)
class Draws:
    """What was drawn for k samples, and where their motions set out.

    Parameters
    ----------
    names : tuple of str
        What is drawn, in the order of the system.
    base : dict
        All parameters of the run's start, with nothing drawn.
    state : ndarray, shape (n,)
        Of the run's start, with nothing drawn.
    values : ndarray, shape (k, names)
    starts : ndarray, shape (k, n)
    parameters : ndarray, shape (k, m)
        All of the system's, in its order.
    units : ndarray, shape (k,)
        Seconds in the unit that times are told in.
    """

    names: tuple[str, ...]
    base: dict[str, float]
    state: np.ndarray
    values: np.ndarray
    starts: np.ndarray
    parameters: np.ndarray
    units: np.ndarray

    def of(self, numbers: Sequence[int]) -> Draws:
        """Those of some of the samples, by their places among these."""
        chosen = np.array(numbers, dtype=int)
        parts = {name: getattr(self, name)[chosen] for name in ("values", "starts", "parameters", "units")}
        return replace(self, **parts)


def drawn(run: SampleFile, numbers: Sequence[int]) -> Draws:
    """The samples of these numbers: the run's start with the draws in their places.

    Every sample has a stream of random numbers of its own, made from the seed and its number: Philox, keyed
    by NumPy's SeedSequence.

    Raises
    ------
    ContwalkError
        If there is no such start.
    """
    sampling, system = run.sampling, run.system
    state, base, _ = start_of(system, run.start)
    known = (*system.state_names, *system.parameter_names)
    names = tuple(name for name in known if name in sampling.draw)
    low, high = (np.array([sampling.draw[name][end].value(base) for name in names]) for end in (0, 1))
    uniform = np.empty((len(numbers), len(names)))
    for row, number in enumerate(numbers):
        seed = np.random.SeedSequence(sampling.seed, spawn_key=(number,))
        uniform[row] = np.random.Generator(np.random.Philox(seed)).random(len(names))
    values = low + (high - low) * uniform
    starts = np.tile(state, (len(numbers), 1))
    parameters = np.tile([base[name] for name in system.parameter_names], (len(numbers), 1))
    for column, name in enumerate(names):
        if name in system.state_names:
            starts[:, system.state_names.index(name)] = values[:, column]
        else:
            parameters[:, system.parameter_names.index(name)] = values[:, column]
    units = np.array([_unit(run, row) for row in _rows(system, parameters)])
    return Draws(names, base, state, values, starts, parameters, units)


def _rows(system: System, parameters: np.ndarray) -> list[dict[str, float]]:
    return [dict(zip(system.parameter_names, row, strict=True)) for row in parameters.tolist()]


def _unit(run: SampleFile, parameters: Mapping[str, float]) -> float:
    unit = run.sampling.time_unit
    return 1.0 if unit is None else unit.length.value(parameters)


@dataclass(frozen=True, eq=False)
class Found:
    """What became of k samples.

    Parameters
    ----------
    motions : Measured
    there : ndarray of bool, shape (k,)
        Whether there is the equilibrium that each may rest at.
    """

    motions: Measured
    there: np.ndarray


def measured(
    run: SampleFile,
    draws: Draws,
    threads: int | None = None,
    finished: Callable[[range, Found], None] | None = None,
) -> Found:
    """The motions computed; `finished` is given parts of them by their places, as soon as they are known."""
    system, sampling = run.system, run.sampling
    field = field_of(system)
    targets = resting_places(system, sampling.settled.equilibrium, _rows(system, draws.parameters))
    motions = Motions(
        field=field,
        guard=level_guard(run),
        starts=draws.starts,
        parameters=draws.parameters,
        targets=targets,
        limits=sampling.until * draws.units,
        within=np.array([sampling.settled.within.get(name, math.inf) for name in system.state_names]),
        periods=np.array([state.period or 0.0 for state in system.states]),
        first=sampling.measure.crossing == "first",
    )
    there = ~np.isnan(targets[:, 0, 0])

    def part(places: range, found: Measured) -> None:
        if finished is not None:
            finished(places, Found(found, there[places.start : places.stop]))

    return Found(measure(motions, sampling.tolerance, _weights(run, field), threads, part), there)


def _weights(run: SampleFile, field: Any) -> np.ndarray:
    """Magnitudes of the states on the first of all motions, shape (n,)."""
    first, scales = drawn(run, range(1)), [state.scale for state in run.system.states]
    values = first.parameters[0]
    machine = Machine(field, values, field.constants(values), (), run.system.modes[0].name)
    limit = float(run.sampling.until * first.units[0])
    return magnitudes(machine, 0.0, first.starts[0], limit, scales, "dop853")


_RUNS: dict[StudyText, SampleFile] = {}


@one_thread()
def measured_elsewhere(study: StudyText, numbers: Sequence[int]) -> Found:
    """As `measured` of the samples of these k numbers, shape (k,): pure, and to be sent to any process.

    Raises
    ------
    PluginError
        If the plugin is not the one that the run began with.
    """
    run = remembered(_RUNS, study, 1, lambda: _read(study))
    return measured(run, drawn(run, numbers), threads=1)


def _read(study: StudyText) -> SampleFile:
    run = read_sampling_text(study.text, study.path, study.overrides)
    study.check(run.system_reference, run.system)
    return run


def level_guard(run: SampleFile) -> Any:
    """The observable at one instant, less the level."""
    wanted = run.sampling.measure
    (function,) = [o.function for o in run.system.observables if o.name == wanted.observable]
    level = wanted.level

    def beyond(t: Any, x: Any, p: Any) -> Any:
        return function(np.array([t]), x.reshape(1, -1), p) - _at(level, p)

    return Guard(run.system, wanted.observable, beyond, wanted.direction)


def _at(product: Product, p: Any) -> Any:
    """A product of parameters that may be symbols."""
    result = 1.0
    for factor, divides in product.factors:
        plain = getattr(p, factor) if isinstance(factor, str) else factor
        result = result / plain if divides else result * plain
    return result


def resting_places(system: System, name: str, parameters: Sequence[Mapping[str, float]]) -> np.ndarray:
    """The named equilibria and their images under symmetries that rename: (k, most, n), NaN where fewer."""
    found: list[list[np.ndarray]] = []
    for row in parameters:
        try:
            states = named_equilibria(system, name, row)
        except StartError:
            states = []
        found.append(_images(system, states, ParameterValues(**row)))
    most = max(1, *(len(places) for places in found)) if found else 1
    result = np.full((len(found), most, len(system.states)), np.nan)
    for index, places in enumerate(found):
        if places:
            result[index, : len(places)] = places
    return result


def _images(system: System, states: Sequence[np.ndarray], p: ParameterValues) -> list[np.ndarray]:
    maps = [symmetry.map for symmetry in system.symmetries if symmetry.role == "relabel"]
    found = [np.asarray(state, dtype=float) for state in states]
    for place in found:  # grows while it is gone through
        for image_of in maps:
            image = np.empty_like(place)
            image_of(0.0, place, p, image)
            if len(found) < MOST_IMAGES and not any(np.allclose(image, other) for other in found):
                found.append(image)
    return found
