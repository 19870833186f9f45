"""The first orbit of a branch, or why there is none."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from contwalk.branch import Outcome
from contwalk.continuation.settings import Settings
from contwalk.diagram import not_begun
from contwalk.diagram.opening import Opening
from contwalk.errors import NotFinite, PluginError, StartError
from contwalk.problems.conserving import with_own_values
from contwalk.problems.initial.recurrence import AtRest
from contwalk.problems.orbit.discretization import Discretization
from contwalk.problems.parameter_line import Ends, ParameterLine
from contwalk.studies.opening import opened
from contwalk.studies.opening_eventful import eventful
from contwalk.studies.opening_smooth import smooth
from contwalk.studies.orbit_start import OrbitStart
from contwalk.system import Neutral, System

# Values of a conserved quantity that differ by more than this part are two.
OTHER = 1e-6


def opened_orbit(
    system: System,
    parameters: Mapping[str, float],
    free: str,
    state: np.ndarray,
    settings: Settings,
    path: Ends | None = None,
    at: float | None = None,
    discretization: Discretization | None = None,
    *,
    period: float | None = None,
    until: float | str | None = None,
    mode: str | None = None,
    event: str | None = None,
    subharmonic: int = 1,
    pins: Sequence[Neutral] | None = None,
) -> Opening | Outcome:
    """The branch of orbits through the one near a state, or why there is none.

    Parameters
    ----------
    system, parameters, free, path, at
        As for `opening.opened`.
    period : float, optional
        Seconds, of an autonomous system's orbit or for a subharmonic one.
    until : float or "settled", optional
        Simulate from the state so long first, and take the orbit that the motion settles on.
    mode, event : str, optional
        Of a hybrid system, the mode that the state is in, or the transition that it is right before.
    subharmonic, pins
        Of smooth orbits, as for `initial.orbit_from_state.orbit_at`.
    """
    line = ParameterLine.of(system, parameters, free, path)
    given = system, line, at, state, settings, discretization
    start = OrbitStart(*given, until, period, mode, event, subharmonic, pins)
    try:
        found = eventful(start) if system.has_events else smooth(start)
    except AtRest as rest:
        begins = parameters, free, rest.state, settings, line.ends, at, discretization
        found = _resting(opened(system.beginning_in(rest.mode), *begins))
    except (PluginError, NotFinite) as error:
        found = not_begun.no_start(error.reason, error.sentence)
    except StartError as error:
        found = not_begun.refused(error.sentence, error.remedy)
    if not isinstance(found, Outcome) or found.reason != "no_convergence":
        return found
    asked = _other_values(system, start.values, state, mode or system.modes[0].name)
    return replace(found, message=f"{found.message} {asked}".strip())


def _other_values(system: System, values: Mapping[str, float], state: np.ndarray, mode: str) -> str:
    """What a start has of conserved quantities of which something else is asked for, in words."""
    given = [name for name in system.conserved_names if not np.isnan(values[name])]
    if not given:
        return ""
    own = with_own_values(system, {**values, **dict.fromkeys(given, np.nan)}, state, mode)
    sentences = [
        f"The start has {name} = {own[name]:.6g}, and {values[name]:.6g} is asked for."
        for name in given
        if abs(own[name] - values[name]) > OTHER * max(abs(own[name]), abs(values[name]))
    ]
    return " ".join(sentences)


def _resting(opening: Opening | Outcome) -> Opening | Outcome:
    """The branch of equilibria that begins where a simulation has come to rest."""
    if isinstance(opening, Outcome):
        return opening
    said = "The simulation came to rest at an equilibrium: the equilibria are followed."
    return replace(opening, message=f"{said} {opening.message}".strip())
