"""The choice of a method, and the sentence that says why."""

from __future__ import annotations

import numpy as np
import pytest
from small_flows import field_of

from contwalk.flow.method import Choice, choose


def chosen(mu: float, tolerance: float) -> Choice:
    field = field_of(lambda t, x, p: [x[1], p[0] * (1.0 - x[0] ** 2) * x[1] - x[0]], 2, 1)
    end = max(10.0, 2.0 * mu)
    weights = [2.0, max(1.0, 1.5 * mu)]
    return choose(field, field.constants([mu]), 0.0, [2.0, 0.0], end, tolerance, weights)


@pytest.mark.parametrize("mu", [0.01, 1.0, 5.0])
@pytest.mark.parametrize(("tolerance", "method"), [(1e-8, "dop853"), (1e-12, "verner98")])
def test_mild_oscillations_are_explicit(mu: float, tolerance: float, method: str) -> None:
    choice = chosen(mu, tolerance)
    assert choice.method == method
    assert choice.stability_limited < 0.02
    assert np.isnan(choice.implicit_work)  # not tried
    assert f"of {len(choice.path.times) - 1} steps limited by stability" in choice.reason


@pytest.mark.parametrize("mu", [100.0, 1000.0])
def test_relaxation_oscillations_are_implicit(mu: float) -> None:
    choice = chosen(mu, 1e-7)
    assert choice.method == "radau9"
    assert choice.stability_limited > 0.9
    assert choice.reason.startswith("Radau IIA of order 9: ")
    assert choice.reason.endswith("explicit steps were limited by stability")
    assert choice.path.status == "ok"


def test_the_cheaper_one_is_taken_where_both_arrive() -> None:
    choice = chosen(20.0, 1e-6)
    assert choice.stability_limited > 0.5
    assert choice.method == "dop853"
    assert choice.explicit_work < choice.implicit_work


def test_the_choice_is_the_same_every_time() -> None:
    first, second = chosen(50.0, 1e-9), chosen(50.0, 1e-9)
    assert (first.method, first.reason, first.implicit_work) == (
        second.method,
        second.reason,
        second.implicit_work,
    )
