"""Numbers read off a motion: t of shape (k,), x of shape (k, 2 n + 4)."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from contwalk.system import Observable

from .masses import AB1, AB2, BETA


def make_observables(n: int) -> tuple[Observable, ...]:
    """Observables of the autobalancer with n masses."""
    swings = tuple(
        Observable(
            f"swing{i}",
            _swing(BETA + i - 1),
            "rad",
            f"half the peak-to-peak value of beta{i} over the motion",
        )
        for i in range(1, n + 1)
    )
    spread = Observable("spread", _spread, "rad", "beta2 - beta1 where it is least; zero: the masses meet")
    return (
        Observable("amplitude", _amplitude, "l1", "largest distance AB over the motion"),
        Observable("load_ratio", _load_ratio(n), "1", f"load over capacity, m e / ({n} m1 l1)"),
        *((spread,) if n >= 2 else ()),
        *swings,
    )


def _amplitude(t: Any, x: Any, p: Any) -> Any:
    return np.sqrt(x[:, AB1] * x[:, AB1] + x[:, AB2] * x[:, AB2]).max()


def _spread(t: Any, x: Any, p: Any) -> Any:
    return (x[:, BETA + 1] - x[:, BETA]).min()


def _swing(column: int) -> Callable[..., Any]:
    def swing(t: Any, x: Any, p: Any) -> Any:
        return 0.5 * (x[:, column].max() - x[:, column].min())

    return swing


def _load_ratio(n: int) -> Callable[..., Any]:
    def load_ratio(t: Any, x: Any, p: Any) -> Any:
        return p.m * p.e / (n * p.m1 * p.l1)

    return load_ratio
