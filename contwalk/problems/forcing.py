"""The period of what forces a system, at given parameters: a positive number, or a sentence with its line."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from contwalk.errors import NotFinite, PluginError
from contwalk.flow.forcing import answered
from contwalk.python_functions import line_of
from contwalk.system import System


def period_at(system: System, parameters: Mapping[str, float]) -> float:
    """Seconds after which the equations of a forced system repeat themselves.

    Raises
    ------
    PluginError
        If there is no such time at these parameters.
    NotFinite
        If one of these is no number: a correction has left all there is, and the plugin is not to blame.
    """
    assert system.period is not None
    for name, value in parameters.items():
        if not np.isfinite(value):
            raise NotFinite(
                f"The parameter '{name}' is {value} there.", "Nothing to mend: a shorter step is taken."
            )
    return positive(system, answered(system, parameters))


def positive(system: System, period: float) -> float:
    """A period that has been computed, if it is one.

    Raises
    ------
    PluginError
    """
    if 0.0 < period < np.inf:
        return period
    assert system.period is not None
    raise PluginError(
        f"{line_of(system.period)}period(p) is {period:.6g} at the parameters there. It must be a positive "
        "number."
    )
