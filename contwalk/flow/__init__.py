"""Flows of vector fields: paths, the same steps again, and their exact derivatives, as machine code.

Rules
-----
1. A field is machine code known by its address (`field`); methods are machine code that serves every field.
2. The steps of a path can be taken again from another start. They are then a smooth function of it, whose
   derivatives `tangents` gives: those of the steps, not those of the flow that the steps approximate.
3. What is compiled is kept on disk. A process that finds it there does not import numba.
4. Nothing here allocates in a loop, shares memory between calls, or holds the interpreter's lock.
"""

from contwalk.flow.compiled.compiled_field import CompiledField
from contwalk.flow.compiled.field import Field
from contwalk.flow.compiled.restricted import Restricted
from contwalk.flow.integrate import (
    METHODS,
    adaptive,
    adaptive_with_tangents,
    along,
    along_with_tangents,
    controlled,
    controlled_each,
    dense,
    errors_on,
    implicit,
    interpolation,
    tangents,
    warmup,
)
from contwalk.flow.path import ErrorControl, Path, Tangents

__all__ = [
    "METHODS",
    "CompiledField",
    "ErrorControl",
    "Field",
    "Path",
    "Restricted",
    "Tangents",
    "adaptive",
    "adaptive_with_tangents",
    "along",
    "along_with_tangents",
    "controlled",
    "controlled_each",
    "dense",
    "errors_on",
    "implicit",
    "interpolation",
    "tangents",
    "warmup",
]
