"""Paper 3, Table II: eigenvalues and eigenvectors of a step, by differences of simulated steps."""

from __future__ import annotations

import numpy as np
import pytest
from contwalk_systems.planar_walker import SYSTEM
from planar_walker_figures import GAIT, REFERENCE, SECTION, complex_numbers, numbers, opening

from contwalk.flow.hybrid.motion_segment import Control
from contwalk.flow.hybrid.motions import hybrid_machine, motion_segments

pytestmark = pytest.mark.thesis

TOLERANCE, STEP = 1e-12, 1e-5
# The paper's differences have the step 5e-6: its eigenvalues are 4e-4 off, its vectors no more.
AS_PRINTED = 4e-4


def after_a_step(start: np.ndarray) -> np.ndarray:
    """The state before the next heel strike, both of shape (3,)."""
    values = {**SYSTEM.defaults(), "alpha": 0.09}
    known = dict(zip(SECTION, start.tolist(), strict=True))
    known["q2"] = opening(values["lf"]) - known["q1"]
    x = np.array([known.get(name, 0.0) for name in SYSTEM.state_names])
    motion = motion_segments(
        hybrid_machine(SYSTEM, values), 0.0, x, "two_link", 2.0, Control(TOLERANCE, np.ones(len(x)))
    )
    _, _, last = (next(motion) for _ in ("heel_strike", "knee_strike", "heel_strike"))
    assert last.transition == "heel_strike"
    return np.array([last.states[-1][SYSTEM.state_names.index(name)] for name in SECTION])


def derivative(start: np.ndarray) -> np.ndarray:
    """Of a step by its start, shape (3, 3): central differences with two steps, extrapolated to none."""
    columns = []
    for away in np.eye(3):
        coarse, fine = (
            (after_a_step(start + size * away) - after_a_step(start - size * away)) / (2.0 * size)
            for size in (STEP, 0.5 * STEP)
        )
        columns.append((4.0 * fine - coarse) / 3.0)
    return np.array(columns).T


def test_eigenvalues_and_eigenvectors_are_those_of_table_2():
    values, vectors = np.linalg.eig(derivative(numbers(GAIT["x"])))
    found = vectors[:, np.argsort(-np.abs(values))].T
    np.testing.assert_allclose(
        sorted(values, key=abs), complex_numbers(GAIT["multipliers"]).real[::-1], rtol=0, atol=1e-7
    )
    printed = REFERENCE["paper_values"]
    order = np.argsort(-np.abs(numbers(printed["multipliers"])))
    for ours, number in zip(found, order, strict=True):
        theirs = numbers(printed["eigenvectors"][number])
        same_way = np.sign(ours @ theirs) * ours / np.linalg.norm(ours)
        np.testing.assert_allclose(same_way, theirs, rtol=0, atol=AS_PRINTED)
