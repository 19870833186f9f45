"""The integrators that `orbit_and_monodromy.py` compares, each as a function of an orbit and a tolerance.

An integrator `prepare(orbit, tolerance)` does everything that is needed once and returns a function without
arguments that computes state and monodromy matrix after one period. All but heyoka, which differentiates
expressions by itself, evaluate the same machine code of the field and of its Jacobian.
"""

from __future__ import annotations

import ctypes
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import partial
from importlib.metadata import PackageNotFoundError, version
from typing import Any

import numpy as np
from orbits import PARAMETER, STATE, TIME, Orbit

Result = tuple[np.ndarray, np.ndarray]
Prepared = Callable[[], Result]


@dataclass(frozen=True)
class Integrator:
    """What is measured, and the tolerances at which."""

    name: str
    package: str
    prepare: Callable[[Orbit, float], Prepared]
    tolerances: Sequence[float] = field(default_factory=lambda: decades(-3, -14))

    @property
    def installed(self) -> str | None:
        """Version of the package, if it is there."""
        try:
            return version(self.package)
        except PackageNotFoundError:
            return None


def decades(first: int, last: int, parts: int = 2) -> list[float]:
    """10^first, ..., 10^last, with so many values in a decade."""
    return [10.0 ** (first - k / parts) for k in range(parts * (first - last) + 1)]


def integrators() -> list[Integrator]:
    """All of them, ours first."""
    return [
        Integrator("contwalk dop853", "contwalk", partial(_contwalk, "dop853")),
        Integrator("contwalk verner98", "contwalk", partial(_contwalk, "verner98")),
        Integrator("contwalk dop853, frozen steps", "contwalk", partial(_contwalk_frozen, "dop853")),
        Integrator("contwalk verner98, frozen steps", "contwalk", partial(_contwalk_frozen, "verner98")),
        # One machine code for each tolerance, up to minutes to make: as few as will do.
        Integrator("heyoka", "heyoka", _heyoka, decades(-4, -16, 1)[::3]),
        Integrator("numbalsoda dop853", "numbalsoda", partial(_numbalsoda, "dop853")),
        # Tighter ones it refuses.
        Integrator("numbalsoda lsoda", "numbalsoda", partial(_numbalsoda, "lsoda"), decades(-3, -12)),
        Integrator("scipy DOP853", "scipy", _scipy, decades(-3, -13)),
    ]


# -- contwalk ----------------------------------------------------------------------------------------------


def _contwalk(method: str, orbit: Orbit, tolerance: float) -> Prepared:
    """Steps chosen for the state, and differentiated."""
    from contwalk.flow import ErrorControl, Tangents, adaptive_with_tangents

    n, c = len(orbit.start), orbit.field.constants(orbit.parameters)
    given = ErrorControl(tolerance, _magnitudes(orbit)), Tangents(np.eye(n), [-1] * n), method

    def run() -> Result:
        path, derivatives = adaptive_with_tangents(orbit.field, c, 0.0, orbit.start, orbit.period, *given)
        return path.states[-1], derivatives

    return run


def _contwalk_frozen(method: str, orbit: Orbit, tolerance: float) -> Prepared:
    """The steps are known already: what an orbit costs from the second Newton iteration on."""
    from contwalk.flow import adaptive, tangents

    n, c, weights = len(orbit.start), orbit.field.constants(orbit.parameters), _magnitudes(orbit)
    identity, sources = np.eye(n), [-1] * n
    path = adaptive(
        orbit.field, c, 0.0, orbit.start, orbit.period, tolerance=tolerance, weights=weights, method=method
    )

    def run() -> Result:
        return tangents(orbit.field, c, path.times, orbit.start, identity, sources, method)

    return run


def _magnitudes(orbit: Orbit) -> np.ndarray:
    """Largest magnitude of each state along the orbit."""
    from contwalk.flow import adaptive

    c = orbit.field.constants(orbit.parameters)
    ones = np.ones(len(orbit.start))
    path = adaptive(
        orbit.field, c, 0.0, orbit.start, orbit.period, tolerance=1e-6, weights=ones, method="dop853"
    )
    return np.abs(path.states).max(axis=0)


# -- heyoka ------------------------------------------------------------------------------------------------


def _heyoka(orbit: Orbit, tolerance: float) -> Prepared:
    """Taylor's method on the variational equations that heyoka derives."""
    import heyoka

    from contwalk.fields.functions import FUNCTIONS
    from contwalk.fields.kernel import Kernel

    n = len(orbit.start)
    names = {f"{name}_": getattr(heyoka, name) for name in FUNCTIONS if hasattr(heyoka, name)}
    exec(Kernel(orbit.program, [TIME, STATE, PARAMETER]).text, names)
    states = heyoka.make_vars(*(f"x{i}" for i in range(n)))
    rates = names["evaluate"]([heyoka.time], states, list(orbit.parameters))
    equations = heyoka.var_ode_sys(list(zip(states, rates, strict=True)), heyoka.var_args.vars)
    start = np.concatenate([orbit.start, np.eye(n).ravel()])
    integrator = heyoka.taylor_adaptive(equations, start, tol=tolerance)

    def run() -> Result:
        integrator.time = 0.0
        integrator.state[:] = start
        integrator.propagate_until(orbit.period)
        end = integrator.state.copy()
        return end[:n], end[n:].reshape(n, n)

    return run


# -- packages that know nothing of tangents: the variational equations as part of the state ------------------


def _augmented(orbit: Orbit) -> Callable[[np.ndarray, np.ndarray, np.ndarray], None]:
    """Compiled rates of the state and, row by row, of the matrix: `rates(y, dy, data)`.

    `data` begins with the field's constants; the rest is room for its values and its Jacobian.
    """
    import numba

    address = orbit.field.rhs_jac_address
    pointers = [ctypes.c_void_p] * 3
    value_and_jacobian = ctypes.CFUNCTYPE(None, ctypes.c_double, *pointers)(address)
    n, constants = orbit.field.n, len(orbit.field.constants(orbit.parameters))
    row_ptr, col = orbit.field.row_ptr, orbit.field.col

    @numba.njit(error_model="numpy")
    def rates(y: np.ndarray, dy: np.ndarray, data: np.ndarray) -> None:
        out = data[constants:]
        value_and_jacobian(0.0, y.ctypes, data.ctypes, out.ctypes)
        dy[:n] = out[:n]
        for i in range(n):
            row = dy[n + n * i : n + n * (i + 1)]
            row[:] = 0.0
            for entry in range(row_ptr[i], row_ptr[i + 1]):
                factor, begin = out[n + entry], n + n * col[entry]
                for k in range(n):
                    row[k] += factor * y[begin + k]

    return rates


def _data(orbit: Orbit) -> np.ndarray:
    constants = orbit.field.constants(orbit.parameters)
    return np.concatenate([constants, np.zeros(orbit.field.n + len(orbit.field.col))])


def _scipy(orbit: Orbit, tolerance: float) -> Prepared:
    import numba
    from scipy.integrate import solve_ivp

    n, rates, data = len(orbit.start), _augmented(orbit), _data(orbit)
    start = np.concatenate([orbit.start, np.eye(n).ravel()])

    @numba.njit
    def compiled(y: np.ndarray, given: np.ndarray) -> np.ndarray:
        dy = np.empty_like(y)
        rates(y, dy, given)
        return dy

    def run() -> Result:
        end = solve_ivp(
            lambda t, y: compiled(y, data),
            (0.0, orbit.period),
            start,
            method="DOP853",
            rtol=tolerance,
            atol=tolerance,
        ).y[:, -1]
        return end[:n], end[n:].reshape(n, n)

    return run


def _numbalsoda(method: str, orbit: Orbit, tolerance: float) -> Prepared:
    import numba
    import numbalsoda

    n, rates, data = len(orbit.start), _augmented(orbit), _data(orbit)
    size, length = n + n * n, len(data)

    @numba.cfunc(numbalsoda.lsoda_sig)
    def right_hand_side(t: float, y: Any, dy: Any, given: Any) -> None:
        rates(numba.carray(y, (size,)), numba.carray(dy, (size,)), numba.carray(given, (length,)))

    solver, address = getattr(numbalsoda, method), right_hand_side.address
    start = np.concatenate([orbit.start, np.eye(n).ravel()])
    times = np.array([0.0, orbit.period])
    kept = right_hand_side  # the machine code lives as long as this object

    def run() -> Result:
        states, finished = solver(address, start, times, data, rtol=tolerance, atol=tolerance, mxstep=10**6)
        end = states[-1] if finished and kept else np.full(size, math.nan)
        return end[:n], end[n:].reshape(n, n)

    return run
