"""Programs in the lanes of vectors: in each lane what the program computes, bitwise."""

from __future__ import annotations

import ctypes
import math

import numpy as np
import pytest

from contwalk.fields.lanes import LANES, has_lanes, lanes_text
from contwalk.fields.llvm import code_of
from contwalk.fields.machine_code import function, module
from contwalk.fields.rebind import rebound
from contwalk.fields.trace import trace
from contwalk.flow.compiled.addresses import address


def arithmetic(t, x, p):
    return [x[0] * x[1] - p[0] / (x[2] + 3.0), -x[1] + t, 2.0, x[0]]


def functions(t, x, p):
    return [math.sin(x[0]) * math.cos(x[0]), math.sqrt(abs(x[1])), math.exp(p[1] * x[2]), x[0] ** 2.5]


def undefined(t, x, p):
    return [math.log(x[0]), math.atan2(x[1], x[2]), math.sqrt(x[1]), 1.0 / x[2]]


def chosen(t, x, p):
    both = np.where((x[0] < x[1]) & ~(x[2] < p[0]), x[0], 1.5)
    return [both, max(x[0], x[1]), np.sign(x[2]), np.floor(3.0 * x[0])]


def branching(t, x, p):
    return [x[0] if x[1] < p[0] else math.sin(x[0]), t, x[1], x[2]]


def text_of(f) -> str:
    copy = rebound(f)

    def outputs(tracer):
        x = np.array([tracer.symbol("x", i) for i in range(3)], dtype=object)
        p = np.array([tracer.symbol("p", i) for i in range(2)], dtype=object)
        return copy(tracer.symbol("t", 0), x, p)

    program = trace(outputs)
    graph = program.graph
    inputs = {graph.input("x", i): ("x", i) for i in range(3)} | {
        graph.input("p", i): ("c", i) for i in range(2)
    }
    inputs[graph.input("t", 0)] = ("t", 0)
    return module([function("one", program, ("x", "c"), inputs, time=True)])


@pytest.mark.parametrize("skipped", [0, 2])
@pytest.mark.parametrize("f", [arithmetic, functions, undefined, chosen])
def test_each_lane_is_the_program(f, skipped):
    text = text_of(f)
    assert has_lanes(text)
    pointers = (ctypes.c_void_p,) * 3
    one = code_of(text, ("one",)).function("one", None, ctypes.c_double, *pointers)
    lanes = lanes_text(text, "lanes", 3, skipped)
    several = code_of(lanes, ("lanes",)).function("lanes", None, *pointers)
    rng = np.random.default_rng(7)
    for scale in (1.0, 1e-3, 1e3):
        x, c = scale * rng.normal(size=(4, LANES)), np.array([0.3, -0.2])
        x[2, 1] = 0.0  # some have no value
        out, whole = np.empty((4 - skipped, LANES)), np.empty(4)
        several(address(x), address(c), address(out))
        for lane in range(LANES):
            one(x[3, lane], address(np.ascontiguousarray(x[:3, lane])), address(c), address(whole))
            assert out[:, lane].tobytes() == whole[skipped:].tobytes()


def test_a_program_with_branches_has_none():
    assert not has_lanes(text_of(branching))
