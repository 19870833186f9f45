"""`contwalk verify`: what a stored run says that its records are not enough for, and its budget."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from contwalk.branch import Branch
from contwalk.errors import ContwalkError
from contwalk.storage import RunHeader
from contwalk.verification.ends import Ranges
from contwalk.workflow.run_file.yaml_lines import parse_yaml


def budget_of(branches: Sequence[Branch], times: float = 2.0, least: float = 10.0) -> float:
    """CPU seconds that a check takes at most by default: twice those of the run, but no fewer than ten."""
    return max(times * sum(float(branch.cost.get("seconds", 0.0)) for branch in branches), least)


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
