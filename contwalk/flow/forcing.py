"""What a plugin answers when it is asked for the period of its force."""

from __future__ import annotations

from collections.abc import Mapping

from contwalk.errors import called
from contwalk.system import System
from contwalk.system.declarations import ParameterValues


def answered(system: System, parameters: Mapping[str, float]) -> float:
    """What `period(p)` of a forced system says: seconds, if it is a positive number.

    Raises
    ------
    PluginError
        If it fails.
    """
    assert system.period is not None
    return float(called("period", system.period, ParameterValues(**parameters)))
