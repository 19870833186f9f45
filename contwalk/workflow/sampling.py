"""`contwalk sample`: many motions from drawn states and parameters, measured, as files and figures."""

from __future__ import annotations

import csv
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from contwalk.errors import StartError
from contwalk.numerics.threads import one_thread
from contwalk.problems.equilibrium.declared import named_equilibria
from contwalk.storage.failures import failures_of
from contwalk.system import System
from contwalk.system.declarations import ParameterValues
from contwalk.workflow.made_with import made_with
from contwalk.workflow.run_file.products import Product
from contwalk.workflow.run_file.sample import SampleFile
from contwalk.workflow.simulating import start_of

MOST_IMAGES = 120  # of an equilibrium under symmetries that rename: five things can be renumbered so often


@dataclass(frozen=True)
class Summary:
    """What the samples say together.

    Parameters
    ----------
    count : int
        All samples.
    measured : int
        Those with a number; `mean`, `error` (standard error of the mean), `deviation` are theirs.
    never_settled : int
        Motions that did not come to rest in time. Their numbers count: the last crossing up to then.
    never_crossed : int
        Those that did not cross the level. Where the observable was beyond it all along, the time is 0.
    failed : int
        Those that could not be integrated to their end.
    without_equilibrium : int
        Those drawn where the equilibrium does not exist.
    """

    count: int
    measured: int
    mean: float
    error: float
    deviation: float
    never_settled: int
    never_crossed: int
    failed: int
    without_equilibrium: int


@dataclass(frozen=True, eq=False)
class SampleResult:
    """What a sampling left behind."""

    samples: Any
    summary: Summary
    files: list[Path]
    figures: list[Path]


@one_thread()
def sample(
    run: SampleFile,
    *,
    threads: int | None = None,
    force: bool = False,
    figures: bool = True,
    progress: Callable[[int], None] | None = None,
) -> SampleResult:
    """Compute and measure the motions that a run file describes, and write what was found.

    Parameters
    ----------
    run : SampleFile
    threads : int, optional
        As many as there are processors by default. The result does not depend on it.
    force : bool
        Replace files that exist.
    figures : bool
        Draw the figures too.
    progress : callable, optional
        Told, now and then, how many motions more are done.

    Raises
    ------
    ContwalkError
        For bad input, before anything is written.
    """
    from contwalk.storage.failures import refuse_existing
    from contwalk.storage.trajectory import Samples, write_samples

    database, table = run.file("samples.h5"), run.file("samples.csv")
    named = (figure.options.get("file") for figure in run.figures)
    drawn = [run.output.parent / name if name else run.file("histogram.png") for name in named]
    drawn = list(dict.fromkeys(drawn)) if figures else []
    refuse_existing([database, table, *drawn], force)
    state, base, _ = start_of(run.system, run.start)
    names, draws = drawn_values(run, base)
    starts, parameters = _put(run.system, state, base, names, draws)
    units = np.array([_unit(run, row) for row in _rows(run.system, parameters)])
    found, targets = _measured(run, starts, parameters, units, threads, progress)
    values = _values(run, found, starts, parameters) / units
    label = run.sampling.time_unit.name if run.sampling.time_unit else "time"
    samples = Samples(
        system=run.system.name,
        drawn=tuple(names),
        measured=label,
        draws=draws,
        values=values,
        settled=_settled(found),
        crossed=found.crossed,
        ends=found.ended_at / units,
        header={
            "config": run.text,
            "overrides": list(run.overrides),
            "parameters": base,
            "provenance": made_with(run.path, run.system_reference, run.system),
        },
    )
    summary = _summary(samples, found, int(np.isnan(targets[:, 0, 0]).sum()))
    write_samples(database, samples)
    _write_table(samples, table)
    for path in drawn:
        _draw(run, samples, summary, path, label)
    return SampleResult(samples, summary, [database, table], drawn)


def drawn_values(run: SampleFile, base: Mapping[str, float]) -> tuple[list[str], np.ndarray]:
    """Names of what is drawn, in the order of the system, and the draws, shape (count, names).

    Every sample has a stream of random numbers of its own, made from the seed and its index: Philox, keyed by
    NumPy's SeedSequence.
    """
    sampling = run.sampling
    known = (*run.system.state_names, *run.system.parameter_names)
    names = [name for name in known if name in sampling.draw]
    low, high = (np.array([sampling.draw[name][end].value(base) for name in names]) for end in (0, 1))
    uniform = np.empty((sampling.count, len(names)))
    for index in range(sampling.count):
        seed = np.random.SeedSequence(sampling.seed, spawn_key=(index,))
        uniform[index] = np.random.Generator(np.random.Philox(seed)).random(len(names))
    return names, low + (high - low) * uniform


def _put(
    system: System, state: np.ndarray, base: Mapping[str, float], names: Sequence[str], draws: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """States and parameters of all samples: those of the start with the draws in their places."""
    count = len(draws)
    starts = np.tile(state, (count, 1))
    parameters = np.tile([base[name] for name in system.parameter_names], (count, 1))
    for column, name in enumerate(names):
        if name in system.state_names:
            starts[:, system.state_names.index(name)] = draws[:, column]
        else:
            parameters[:, system.parameter_names.index(name)] = draws[:, column]
    return starts, parameters


def _rows(system: System, parameters: np.ndarray) -> list[dict[str, float]]:
    return [dict(zip(system.parameter_names, row, strict=True)) for row in parameters.tolist()]


def _unit(run: SampleFile, parameters: Mapping[str, float]) -> float:
    unit = run.sampling.time_unit
    return 1.0 if unit is None else unit.length.value(parameters)


def _measured(
    run: SampleFile,
    starts: np.ndarray,
    parameters: np.ndarray,
    units: np.ndarray,
    threads: int | None,
    progress: Callable[[int], None] | None,
) -> tuple[Any, np.ndarray]:
    """All motions computed, and the places where each might come to rest."""
    from contwalk.flow.compiled.traced import field_of
    from contwalk.flow.ensemble.sampling import Motions, measure
    from contwalk.flow.events.motion import Machine, magnitudes

    system, sampling = run.system, run.sampling
    field = field_of(system)
    targets = resting_places(system, sampling.settled.equilibrium, _rows(system, parameters))
    first = Machine(field, parameters[0], field.constants(parameters[0]), (), system.modes[0].name)
    limits = sampling.until * units
    scales = [state.scale for state in system.states]
    weights = magnitudes(first, 0.0, starts[0], float(limits[0]), scales, "dop853")
    motions = Motions(
        field=field,
        guard=_guard(run),
        starts=starts,
        parameters=parameters,
        targets=targets,
        limits=limits,
        within=np.array([sampling.settled.within.get(name, math.inf) for name in system.state_names]),
        periods=np.array([state.period or 0.0 for state in system.states]),
        first=sampling.measure.crossing == "first",
    )
    return measure(motions, sampling.tolerance, weights, threads, progress), targets


def _guard(run: SampleFile) -> Any:
    """The observable at one instant, less the level."""
    from contwalk.flow.events.guard import Guard

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


def _settled(found: Any) -> np.ndarray:
    from contwalk.flow.ensemble.sampling_records import FOUND, SETTLED

    return np.isin(found.ended, (SETTLED, FOUND))


def _failed(found: Any) -> np.ndarray:
    from contwalk.flow.ensemble.sampling_records import GIVEN_UP, NOT_FINITE

    return np.isin(found.ended, (NOT_FINITE, GIVEN_UP))


def _values(run: SampleFile, found: Any, starts: np.ndarray, parameters: np.ndarray) -> np.ndarray:
    """Instants of the crossings; NaN where there is none, 0 where the observable was beyond all along."""
    guard, last = _guard(run), run.sampling.measure.crossing == "last"
    values = np.where(found.crossed, found.crossed_at, np.nan)
    for index in np.flatnonzero(~found.crossed) if last else ():
        value, rate, _ = guard(0.0, starts[index], parameters[index])
        if np.sign(value or rate) == guard.direction:
            values[index] = 0.0
    values[_failed(found)] = np.nan
    return values


def _summary(samples: Any, found: Any, without: int) -> Summary:
    values = samples.values[np.isfinite(samples.values)]
    deviation = float(values.std(ddof=1)) if len(values) > 1 else math.nan
    failed = _failed(found)
    return Summary(
        count=len(samples.values),
        measured=len(values),
        mean=float(values.mean()) if len(values) else math.nan,
        error=deviation / math.sqrt(len(values)) if len(values) else math.nan,
        deviation=deviation,
        never_settled=int((~samples.settled & ~failed).sum()),
        never_crossed=int((~samples.crossed).sum()),
        failed=int(failed.sum()),
        without_equilibrium=without,
    )


def _write_table(samples: Any, path: Path) -> None:
    """A line for each sample, all digits kept."""
    names = (*samples.drawn, samples.measured, "crossed", "settled", "ended")
    columns = (samples.values, samples.crossed, samples.settled, samples.ends)
    with failures_of(path, "create"), path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["sample", *names])
        rows = zip(samples.draws.tolist(), *(column.tolist() for column in columns), strict=True)
        for index, (drawn, value, crossed, settled, end) in enumerate(rows):
            words = ["true" if flag else "false" for flag in (crossed, settled)]
            writer.writerow([index, *drawn, value, *words, end])


def _draw(run: SampleFile, samples: Any, summary: Summary, path: Path, label: str) -> None:
    from contwalk import plotting

    values, wanted = samples.values[np.isfinite(samples.values)], run.sampling.measure
    way = "falls below" if wanted.direction == "falling" else "rises above"
    label = f"{wanted.crossing} time that {wanted.observable} {way} {wanted.level.text} ({label})"
    if len(values):
        plotting.save(plotting.plot_histogram(values, label=label, never_settled=summary.never_settled), path)
