"""What a sweep did not find."""

from __future__ import annotations

from collections.abc import Sequence

from contwalk.branch import Branch


def lost_values(
    sweep: tuple[str, tuple[float, ...]] | None, branches: Sequence[Branch], database: str
) -> str:
    """At which values of a swept parameter the start led to nothing, and how to get there; empty if at none.

    Also if at all: then the start is wrong, and each branch says why.
    """
    if sweep is None:
        return ""
    name = sweep[0]
    starts = [branch for branch in branches if branch.info.parent is None]
    lost = [branch for branch in starts if not len(branch) and branch.outcome.status == "failed"]
    found = next((branch for branch in starts if len(branch)), None)
    if not lost or found is None:
        return ""
    values = ", ".join(f"{branch.info.parameters[name]:g}" for branch in lost)
    return (
        "Every value of the sweep begins from the same start, never from a neighbour's solution; it leads to "
        f"nothing at {name} = {values}. Where a neighbour has a branch, begin on it: "
        f"start: {{from: {database}, point: {found.name}/0}}, with {name} in `parameters`, without `sweep`, "
        "and another output."
    )
