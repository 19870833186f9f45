"""What differs, as a record: where, what, by how much, and a sentence."""

from __future__ import annotations

from dataclasses import dataclass

# What may differ; the words of the JSON document.
MODEL, PARAMETER, BRANCH, POINT, VALUE, KIND, END = (
    "model",
    "parameter",
    "branch",
    "special_point",
    "value",
    "kind",
    "end",
)
CRITICALITY, STABILITY, ADMISSIBILITY, ROWS = "criticality", "stability", "admissibility", "rows"


@dataclass(frozen=True)
class Difference:
    """One thing that differs.

    Parameters
    ----------
    what : str
        `model`, `parameter`, `branch`, `special_point`, `value`, `kind`, `end`, `criticality`, `stability`,
        `admissibility` or `rows`.
    text : str
        A sentence.
    a, b : str
        Where in A and in B: `b1` or `b1/PD1`; empty where there is nothing.
    quantity : str
        The name of a value that differs.
    value_a, value_b, difference, allowed : float, optional
        The values, how far they are apart, and the sum of the claimed errors.
    """

    what: str
    text: str
    a: str = ""
    b: str = ""
    quantity: str = ""
    value_a: float | None = None
    value_b: float | None = None
    difference: float | None = None
    allowed: float | None = None


def apart(difference: float, allowed: float) -> str:
    """`2.1e-09 apart, 2.1 times their errors`."""
    times = f", {difference / allowed:.3g} times their errors together" if allowed > 0.0 else ""
    return f"{difference:.2g} apart{times}"
