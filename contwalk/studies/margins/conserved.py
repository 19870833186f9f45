"""What is conserved and changed by a push: nothing of that is forgotten, however long a motion goes on."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from contwalk.studies.margins.solution import Instant, Solution
from contwalk.system import System
from contwalk.system.declarations import ParameterValues

# Of the change by the magnitude of a state: less is rounding.
ROUNDED = 1e-9


def changed_quantities(
    system: System, solution: Solution, pushes: Iterable[tuple[Instant, np.ndarray]]
) -> list[str]:
    """Names of the conserved quantities that pushes change, each of shape (n,) at an instant."""
    pushes = list(pushes)
    return [
        quantity.name
        for quantity in system.conserved
        if any(_changes(system, solution, quantity.name, *push) for push in pushes)
    ]


def _changes(system: System, solution: Solution, name: str, instant: Instant, push: np.ndarray) -> bool:
    """Whether a push changes a quantity by more than rounding."""
    (quantity,) = [each for each in system.conserved if each.name == name]
    function, p = quantity.of(instant.mode), ParameterValues(**solution.parameters)

    def value(by: np.ndarray) -> float:
        try:
            return float(function(instant.time, instant.state + by, p))
        except (ArithmeticError, ValueError):  # it has none there
            return np.nan

    before = value(np.zeros(len(push)))
    single = [abs(value(by) - before) for by in np.diag(solution.magnitudes)]
    return abs(value(push) - before) > ROUNDED * float(np.nanmax([0.0, *single]))
