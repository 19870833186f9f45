"""Intervals of expressions hold every value; of squares, roots and bounds they tell that a sign is kept."""

from __future__ import annotations

import math

import numpy as np
import pytest

from contwalk.fields.kernel import Kernel
from contwalk.fields.ranges import ranges
from contwalk.fields.rebind import rebound
from contwalk.fields.trace import Outputs, trace

# The expression, and an interval that is known of it.
EXPRESSIONS = {
    "x[0] ** 2 + 1.0": (1.0, math.inf),
    "x[0] * x[0]": (0.0, math.inf),
    "abs(x[0] - x[1])": (0.0, math.inf),
    "max(x[0], 0.0)": (0.0, math.inf),
    "min(x[0], -2.0)": (-math.inf, -2.0),
    "-np.sqrt(x[0] ** 2 + x[1] ** 2)": (-math.inf, 0.0),
    "np.exp(x[0]) * (2.0 + np.sin(x[1]))": (0.0, math.inf),
    "p[0] * x[0] ** 2": (0.0, math.inf),
    "x[0] ** 2 / (1.0 + x[1] ** 2)": (0.0, math.inf),
    "(x[0] ** 2 if x[1] > 0.0 else 3.0) + 1.0": (1.0, math.inf),
    "3.0 - np.tanh(x[0])": (2.0, 4.0),
    "x[0] - 1.0": (-math.inf, math.inf),
    "(x[0] - 0.5) ** 3": (-math.inf, math.inf),
    "0.5 - abs(x[0])": (-math.inf, 0.5),
    "x[0] ** 2 - x[1] ** 2": (-math.inf, math.inf),
    "p[1] * x[0] ** 2": (-math.inf, math.inf),
    "1.0 / x[0]": (-math.inf, math.inf),
    "np.sinc(x[0])": (-math.inf, math.inf),
}


def program_of(text):
    function = rebound(eval(f"lambda x, p: {text}", {"np": np}))

    def record(tracer):
        x, p = ([tracer.symbol(group, i) for i in range(2)] for group in "xp")
        return [function(x, p)]

    return trace(record)


@pytest.mark.parametrize("text", EXPRESSIONS)
def test_interval_is_the_expected_one_and_holds_all_values(text):
    program, expected = program_of(text), EXPRESSIONS[text]
    leaves = [leaf for leaf in program.leaves() if isinstance(leaf, Outputs)]
    found = [ranges(program.graph, leaf.nodes, {("p", 0): (0.0, math.inf)})[0] for leaf in leaves]
    interval = min(low for low, _ in found), max(high for _, high in found)
    assert interval == expected
    kernel, random = Kernel(program, ("x", "p"), (1,)), np.random.default_rng(1)
    for x in random.normal(0.0, 3.0, (200, 2)):
        value = kernel(x.tolist(), [0.7, -0.4])[0]
        assert interval[0] <= value <= interval[1]


def test_infinities_that_cancel_say_nothing():
    program = program_of("np.exp(x[0]) - np.exp(x[1])")
    (leaf,) = program.leaves()
    assert ranges(program.graph, leaf.nodes, {}) == [(-math.inf, math.inf)]
