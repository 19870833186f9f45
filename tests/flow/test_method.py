"""The choice of a method, and the sentence that says why."""

from __future__ import annotations

import math

import numpy as np
import pytest
from small_flows import field_of

from contwalk.flow import Field, adaptive, along
from contwalk.flow.integrate import controlled
from contwalk.flow.method import (
    PATIENCE,
    TRIAL_STEPS,
    Carried,
    Choice,
    choose,
    explicit_work,
    implicit_work,
)
from contwalk.flow.path import ErrorControl, Path


def chosen(mu: float, tolerance: float) -> Choice:
    field = field_of(lambda t, x, p: [x[1], p[0] * (1.0 - x[0] ** 2) * x[1] - x[0]], 2, 1)
    end = max(10.0, 2.0 * mu)
    weights = [2.0, max(1.0, 1.5 * mu)]
    return choose(field, field.constants([mu]), 0.0, [2.0, 0.0], end, ErrorControl(tolerance, weights))


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


def chain(bodies: int) -> Field:
    """Bodies between walls, joined by springs p0 and dampers p1; the first is driven."""

    def rates(t, x, p):
        x, v = x[:bodies], x[bodies:]
        left, right = [0.0, *x[:-1]], [*x[1:], 0.0]
        slower, faster = [0.0, *v[:-1]], [*v[1:], 0.0]
        forces = [
            p[0] * (a - 2.0 * b + c) - b**3 + p[1] * (d - 2.0 * e + f)
            for a, b, c, d, e, f in zip(left, x, right, slower, v, faster, strict=True)
        ]
        forces[0] = forces[0] + p[2] * np.sin(t)
        return [*v, *forces]

    return field_of(rates, 2 * bodies, 3, [0, 1])


@pytest.mark.parametrize(("damping", "end", "method"), [(0.1, 40.0, "dop853"), (3e5, 40.0, "radau9")])
def test_a_chain_of_28_states(damping: float, end: float, method: str) -> None:
    """Dampers of 3e5 have rates up to 1.2e6: explicit steps of 5e-6, against some tens of implicit ones."""
    field, n = chain(14), 28
    c, start = field.constants([5.0, damping, 1.0]), np.zeros(28)
    start[:14] = np.sin(np.arange(14.0))
    carried = Carried(field, n + 2)
    choice = choose(field, c, 0.0, start, end, ErrorControl(1e-8, np.ones(n)), carried)
    assert choice.method == method
    assert choice.path.status == "ok"


def test_tangents_count() -> None:
    """At 28 states an implicit step with 30 tangents costs many explicit ones, without them it does not."""
    field = chain(14)
    c, start, n = field.constants([5.0, 3.0, 1.0]), np.full(28, 0.1), 28
    carried = Carried(field, 30)
    paths = {m: adaptive(field, c, 0.0, start, 40.0, 1e-8, np.ones(n), m) for m in ("dop853", "radau9")}
    alone = implicit_work(field, paths["radau9"]) / explicit_work(field, paths["dop853"])
    together = implicit_work(field, paths["radau9"], carried) / explicit_work(field, paths["dop853"], carried)
    assert together > 1.2 * alone


def test_steps_to_be_taken_again_are_not_at_the_limit_of_stability() -> None:
    """At mu = 20 the explicit pair is cheaper, but on its own steps a neighbouring motion grows."""
    field = field_of(lambda t, x, p: [x[1], p[0] * (1.0 - x[0] ** 2) * x[1] - x[0]], 2, 1)
    c, weights = field.constants([20.0]), [2.0, 30.0]
    choice = choose(field, c, 0.0, [2.0, 0.0], 40.0, ErrorControl(1e-6, weights), Carried(field, 2))
    assert choice.method == "dop853"
    assert "limited by stability" in choice.reason
    own, steady = choice.path.times, choice.path.steady
    assert len(steady) - 1 == math.ceil(1.25 * (len(own) - 1))
    assert (steady[0], steady[-1]) == (own[0], own[-1])
    beside = np.array([2.002, 0.0])
    exact = adaptive(field, c, 0.0, beside, 40.0, 1e-12, weights, "radau9").states[-1]
    on_own, on_steady = (along(field, c, times, beside, "dop853")[-1] for times in (own, steady))
    assert np.abs(on_steady - exact).max() < 0.1 * np.abs(on_own - exact).max()
    farther = np.array([2.01, 0.0])
    assert not np.isfinite(along(field, c, own, farther, "dop853")[-1]).all()
    assert np.isfinite(along(field, c, steady, farther, "dop853")[-1]).all()


def test_steps_that_accuracy_limits_are_as_they_are() -> None:
    field = field_of(lambda t, x, p: [x[1], -x[0]], 2, 1)
    path = adaptive(field, field.constants([0.0]), 0.0, [1.0, 0.0], 10.0, 1e-9, [1.0, 1.0], "dop853")
    assert path.steady is path.times


def test_the_choice_is_the_same_every_time() -> None:
    first, second = chosen(50.0, 1e-9), chosen(50.0, 1e-9)
    assert (first.method, first.reason, first.implicit_work) == (
        second.method,
        second.reason,
        second.implicit_work,
    )


def test_where_a_motion_repels_the_implicit_method_is_given_up(monkeypatch: pytest.MonkeyPatch) -> None:
    """Deviations of 1e15 have roundings above the tolerance: it took all steps that are allowed."""
    spent: dict[str, int] = {"dop853": 0, "radau9": 0}

    def counted(*given: object) -> Path:
        path = controlled(*given)
        spent[str(given[-1])] += len(path.times) - 1 + path.rejected
        return path

    monkeypatch.setattr("contwalk.flow.method.controlled", counted)
    # A spiral until e^36.
    field = field_of(lambda t, x, p: [3.0 * x[0] - 40.0 * x[1], 40.0 * x[0] + 3.0 * x[1]], 2, 1)
    control = ErrorControl(1e-6, [1.0, 1.0], far_out=True)
    choice = choose(field, field.constants([0.0]), 0.0, [1.0, 0.0], 12.0, control)
    assert choice.method == "dop853"
    assert choice.path.status == "ok"
    # An implicit step takes more than an explicit one.
    assert spent["radau9"] < PATIENCE * TRIAL_STEPS
