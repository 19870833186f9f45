"""Units of a system's states, parameters and time, and an order of its states."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from contwalk.quantities import PERIOD
from contwalk.system import System


@dataclass(frozen=True, eq=False)
class Units:
    """What numbers become: each is multiplied by its factor, and states stand in another order.

    Parameters
    ----------
    states, parameters : mapping
        Factors by name.
    time : float
        That of times.
    order : tuple of str
        Names of the states in their order in the new units.
    names : tuple of str
        Names of the states in the plugin's own order.
    """

    states: Mapping[str, float]
    parameters: Mapping[str, float]
    time: float
    order: tuple[str, ...]
    names: tuple[str, ...]

    @property
    def factors(self) -> np.ndarray:
        """Those of the states in the plugin's own order, shape (n,)."""
        return np.array([self.states[name] for name in self.names])

    @property
    def places(self) -> list[int]:
        """Where each state of the plugin's own order stands in the new one."""
        return [self.order.index(name) for name in self.names]

    def of(self, name: str) -> float:
        """The factor of a parameter, a period, an extreme of a state or a rate of growth; 1 of all else."""
        extreme = name.partition(":")[2]
        if name == PERIOD:
            return self.time
        if name == "max_re":
            return 1.0 / self.time
        return self.parameters.get(name, self.states.get(extreme, 1.0))

    def own(self, values: np.ndarray) -> np.ndarray:
        """States in the plugin's own units and order, of shape (.., n) as those that are given."""
        return values[..., self.places] / self.factors

    def new(self, values: np.ndarray) -> np.ndarray:
        """States in the new units and order, shape (.., n), from the plugin's own."""
        scaled = values * self.factors
        return scaled[..., [self.names.index(name) for name in self.order]]


def units_of(
    system: System, states: float = 1.0, parameters: float = 1.0, time: float = 1.0, turned: bool = False
) -> Units:
    """A factor for all states, one for all parameters and one for times; `turned`: the last state first.

    A parameter that says where a neutral direction is pinned is a value of the state that it pins.
    """
    by_state = dict.fromkeys(system.state_names, states)
    by_parameter = dict.fromkeys(system.parameter_names, parameters)
    for neutral in system.neutral:
        if neutral.value is not None and neutral.pin is not None:
            by_parameter[neutral.value] = by_state[neutral.pin]
    order = system.state_names[::-1] if turned else system.state_names
    return Units(by_state, by_parameter, time, order, system.state_names)
