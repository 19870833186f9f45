"""Declarations a plugin is made of. Data only: nothing here computes.

Rules of the contract
---------------------
1. `field(t, x, p, dx)`, `reset(t, x, p, x_plus)`, `Symmetry.map(t, x, p, x_image)` and
   `Neutral.generator(t, x, p, v)` write every entry of their last argument and return nothing;
   `guard(t, x, p)` returns a number.
2. `x` is indexed by constants, `p` is read by name (`p.omega`).
3. The functions are plain numeric Python: arithmetic, `math`, `numpy` scalars and loops with known bounds.
   Exact derivatives of every order are taken from them; a plugin never supplies one.
"""

from contwalk.column_names import RESERVED, SPLIT
from contwalk.system.modes import DIRECTIONS, Condition, Mode, Transition
from contwalk.system.names import SIDES, nearest
from contwalk.system.observables import Observable, Signal
from contwalk.system.parameter_values import ParameterValues
from contwalk.system.starts import Start, Study
from contwalk.system.symmetries import Conserved, Neutral, Symmetry
from contwalk.system.system import System
from contwalk.system.variables import ConservedValue, Parameter, State

__all__ = [
    "DIRECTIONS",
    "RESERVED",
    "SIDES",
    "SPLIT",
    "Condition",
    "Conserved",
    "ConservedValue",
    "Mode",
    "Neutral",
    "Observable",
    "Parameter",
    "ParameterValues",
    "Signal",
    "Start",
    "State",
    "Study",
    "Symmetry",
    "System",
    "Transition",
    "nearest",
]
