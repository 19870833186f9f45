"""Functions that cannot be traced, with what to write instead."""

from __future__ import annotations

import types
from collections.abc import Callable, Mapping
from typing import Any

from contwalk.errors import UnsupportedOperation
from contwalk.fields.dispatch import symbolic

_EIGENVALUES = (
    "Of 2 x 2 matrices write the formula. That a matrix becomes singular is numpy.linalg.det(a) == 0; "
    "a guard may return that determinant."
)
LINEAR_ALGEBRA = {
    "lstsq": "Solve the normal equations: numpy.linalg.solve(a.T @ a, a.T @ b).",
    "pinv": "Of full rank it is numpy.linalg.solve(a.T @ a, a.T), or a.T @ numpy.linalg.inv(a @ a.T).",
    "cholesky": "numpy.linalg.solve of a symmetric matrix does that by itself.",
    "qr": "Use numpy.linalg.solve.",
    "svd": "Use numpy.linalg.solve, or numpy.linalg.det.",
    "slogdet": "Use numpy.linalg.det.",
    "matrix_rank": "Choose by a determinant: numpy.linalg.det(a) > 0.",
    "cond": "Choose by a determinant: numpy.linalg.det(a) > 0.",
    "eig": _EIGENVALUES,
    "eigh": _EIGENVALUES,
    "eigvals": _EIGENVALUES,
    "eigvalsh": _EIGENVALUES,
    "svdvals": _EIGENVALUES,
}
_STEPS = "A step at the halves is numpy.floor(x + 0.5)."
_LOOKED_UP = "A table is numpy.interp, or a CubicSpline made beforehand; choices are numpy.where."
ROUNDED = {
    "round": _STEPS,
    "around": _STEPS,
    "rint": _STEPS,
    "searchsorted": _LOOKED_UP,
    "digitize": _LOOKED_UP,
    "piecewise": _LOOKED_UP,
    "select": _LOOKED_UP,
    "roots": "Make the root a state, or write its formula.",
}


def refusals(module: types.ModuleType, remedies: Mapping[str, str]) -> dict[str, Callable[..., Any]]:
    """Functions of these names of a module that refuse stand-ins for numbers, each with its remedy."""
    return {
        name: refusal(f"{module.__name__}.{name}", getattr(module, name), remedy)
        for name, remedy in remedies.items()
        if hasattr(module, name)
    }


def refusal(name: str, own: Callable[..., Any], remedy: str) -> Callable[..., Any]:
    """A function that refuses stand-ins for numbers."""

    def call(*arguments: Any, **options: Any) -> Any:
        if symbolic(*(a for a in arguments if not callable(a))):
            raise UnsupportedOperation(f"{name} gets what depends on the state or a parameter.", remedy)
        return own(*arguments, **options)

    return call
