"""`contwalk verify`: what a stored run says that its records are not enough for, and its budget."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from contwalk.branch import Branch
from contwalk.errors import ContwalkError
from contwalk.storage import RunHeader
from contwalk.system import System
from contwalk.verification.checking import Record, checked
from contwalk.verification.ends import Ranges
from contwalk.verification.finding import Finding
from contwalk.workflow.run_file.yaml_lines import parse_yaml


def budget_of(branches: Sequence[Branch], times: float = 2.0, least: float = 10.0) -> float:
    """CPU seconds that a check takes at most by default: twice those of the run, but no fewer than ten."""
    return max(times * sum(float(branch.cost.get("seconds", 0.0)) for branch in branches), least)


def verify(
    system: System,
    header: RunHeader,
    records: Sequence[Record],
    seconds: float,
    progress: Callable[[Finding], None] | None = None,
) -> list[Finding]:
    """Recompute records of a run.

    Parameters
    ----------
    system : System
    header : RunHeader
        Of the database, whose run file tells the ranges.
    records : sequence of (Branch, SpecialPoint or row)
    seconds : float
        CPU that is taken at most.
    progress : callable, optional
        Told each finding when it is there.
    """
    return checked(system, records, ranges_of(header), seconds, progress)


def ranges_of(header: RunHeader) -> Ranges:
    """From where to where a run went, by parameter, as far as its run file tells it in numbers."""
    try:
        data: Any = parse_yaml(header.config, "the stored run file")[0]
    except ContwalkError:
        return {}
    found: dict[str, Any] = {}
    own = data.get("continue") if isinstance(data, dict) else None
    if isinstance(own, dict):
        wanted = own.get("range")
        found |= wanted if isinstance(wanted, dict) else {str(own.get("parameter")): wanted}
    loci = data.get("loci") if isinstance(data, dict) else None
    if isinstance(loci, dict):
        found[str(loci.get("with"))] = loci.get("range")
    if isinstance(data, dict) and data.get("path"):
        found["path"] = [0.0, 1.0]
    return {
        name: (float(ends[0]), float(ends[1]))
        for name, ends in found.items()
        if isinstance(ends, Sequence) and len(ends) == 2 and all(isinstance(end, int | float) for end in ends)
    }
