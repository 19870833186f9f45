"""`contwalk verify`: every located special point of a database recomputed."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from contwalk.branch import Branch, SpecialPoint
from contwalk.errors import ContwalkError
from contwalk.numerics.threads import one_thread
from contwalk.problems.orbit.discretization import Discretization, of_orbits
from contwalk.storage import RunHeader
from contwalk.studies.comparison import LOST, Comparison
from contwalk.studies.verification import compared
from contwalk.system import System
from contwalk.workflow.run_file.yaml_lines import parse_yaml

DEFAULT_ACCURACY = 1e-8


def points_of(branches: Sequence[Branch]) -> list[tuple[Branch, SpecialPoint]]:
    """The points that are recomputed: all special points but ends."""
    return [(branch, point) for branch in branches for point in branch.special_points if point.label != "EP"]


@one_thread()
def verify(
    system: System,
    header: RunHeader,
    points: Sequence[tuple[Branch, SpecialPoint]],
    method: str = "",
    progress: Callable[[Comparison], None] | None = None,
) -> list[Comparison]:
    """Recompute special points of a run.

    Parameters
    ----------
    system : System
    header : RunHeader
        Of the database, which tells what accuracy was asked and what is marked.
    points : sequence of (Branch, SpecialPoint)
    method : str
        The integrator for orbits; one that a point was not computed with by default.
    progress : callable, optional
        Told each comparison when it is there.
    """
    steps, marks = discretization_of_run(header), marks_of_run(header)
    result = []
    for branch, point in points:
        comparison = _compared(system, branch, point, steps, method, marks)
        if progress is not None:
            progress(comparison)
        result.append(comparison)
    return result


def _compared(
    system: System,
    branch: Branch,
    point: SpecialPoint,
    steps: Discretization,
    method: str,
    marks: Mapping[str, Sequence[float | str]],
) -> Comparison:
    """One comparison; a computation that breaks down has not found the point again."""
    try:
        with np.errstate(all="ignore"):  # what is not finite shows in what comes out
            return compared(system, branch, point, steps, method, marks)
    except (ArithmeticError, ValueError) as error:
        return Comparison(
            branch.name,
            point.name,
            branch.info.free[0],
            float(point.unknowns[-1]) if point.unknowns else float("nan"),
            verdict=LOST,
            reason=f"the second computation broke down: {error}",
        )


def discretization_of_run(header: RunHeader) -> Discretization:
    """What a stored run asked of its orbits."""
    engine = dict(header.provenance.get("engine", {}))
    given = of_orbits(engine)
    accuracy = float(header.provenance.get("accuracy", DEFAULT_ACCURACY))
    return Discretization(accuracy=accuracy, **given)


def marks_of_run(header: RunHeader) -> Mapping[str, Sequence[float | str]]:
    """The marked values in a stored run file, by name; none where it cannot be read."""
    try:
        data = parse_yaml(header.config, "the stored run file")[0]
    except ContwalkError:
        return {}
    written = data.get("mark") if isinstance(data, dict) else None
    if not isinstance(written, dict):
        return {}
    return {str(n): values if isinstance(values, list) else [values] for n, values in written.items()}
