"""Noise in the last bits: off by default, small, the same for the same number, and everywhere."""

from __future__ import annotations

import os
import subprocess
import sys

import numpy as np
import pytest

from contwalk.numerics import noise

NUMBERS = np.concatenate([np.geomspace(1e-300, 1e300, 601), [0.0, 1.0, np.inf]])


def test_there_is_none_unless_it_is_asked_for():
    assert noise.SEED is None or os.environ[noise.VARIABLE] == str(noise.SEED)
    if noise.SEED is None:
        assert all(noise.noisy(value) == value for value in NUMBERS.tolist())


@pytest.mark.parametrize("seed", [0, 1, 12345])
def test_numbers_move_by_two_units_at_most_and_each_always_alike(seed):
    moved = noise.noisy_array(NUMBERS, seed)
    ratio = np.divide(moved, NUMBERS, out=np.ones(len(NUMBERS)), where=(NUMBERS > 0) & np.isfinite(NUMBERS))
    # half a unit more for the product's own rounding
    assert np.all(np.abs(ratio - 1.0) <= (noise.MOST + 0.5) * noise.EPSILON)
    assert len(np.unique(np.rint((ratio - 1.0) / noise.EPSILON))) == 2 * noise.MOST + 1
    assert np.array_equal(noise.noisy_array(NUMBERS, seed), moved)
    assert np.array_equal(noise.noisy_array(-NUMBERS, seed), -moved)
    assert moved[-3] == 0.0
    assert moved[-1] == np.inf


def test_seeds_differ_and_conjugates_stay_conjugates():
    z = np.exp(1j * np.linspace(0.1, 3.0, 40)).reshape(8, 5)
    assert np.array_equal(noise.noisy_array(z.conj(), 3), noise.noisy_array(z, 3).conj())
    assert not np.array_equal(noise.noisy_array(z, 3), noise.noisy_array(z, 4))
    assert noise.noisy_array(z.T, 3).shape == (5, 8)
    assert np.array_equal(noise.noisy_array(z.T, 3), noise.noisy_array(z, 3).T)


PROGRAM = """
import ctypes
import numpy as np
from contwalk.fields.llvm import code_of
from contwalk.numerics import noise

name = "noise_alone"
text = noise.rounding_code("inner").replace("internal ", "")
text += f"define double @{name}(double %v) {{\\n  %r = call double @inner(double %v)\\n"
text += "  ret double %r\\n}\\n"
text += "attributes #0 = { nounwind willreturn readnone }\\n"
compiled = code_of(text, (name,)).function(name, ctypes.c_double, ctypes.c_double)
numbers = np.geomspace(1e-300, 1e300, 601)
assert [compiled(v) for v in numbers] == [noise.noisy(v) for v in numbers.tolist()]
assert np.array_equal(noise.noisy_array(numbers, noise.SEED), [noise.noisy(v) for v in numbers.tolist()])
a = np.array([[2.0, 1.0], [1.0, 3.0]])
plain = np.linalg.solve.__wrapped__(a, np.ones(2))
assert np.array_equal(np.linalg.solve(a, np.ones(2)), noise.noisy_array(plain, noise.SEED))
plain = np.linalg.eig.__wrapped__(a).eigenvalues
assert np.array_equal(np.linalg.eig(a).eigenvalues, noise.noisy_array(plain, noise.SEED))
print("alike")
"""


def test_compiled_code_python_and_linear_algebra_have_the_same_noise():
    """In a process of its own, as a user sets it."""
    environment = {**os.environ, noise.VARIABLE: "7"}
    done = subprocess.run([sys.executable, "-c", PROGRAM], env=environment, capture_output=True, text=True)
    assert done.stdout == "alike\n", done.stderr


@pytest.mark.parametrize("seed", ["abc", "-1"])
def test_what_is_no_seed_is_refused_in_a_sentence(seed, tmp_path):
    surroundings = {**os.environ, noise.VARIABLE: seed}
    command = [sys.executable, "-m", "contwalk", "continue", "runs/autobalancer_load.yaml"]
    command += ["--output", str(tmp_path / "none.h5")]
    ran = subprocess.run(command, env=surroundings, capture_output=True, text=True, check=False)
    assert ran.returncode == 2
    assert f"CONTWALK_NOISE is '{seed}'" in ran.stderr
    assert "a whole number" in ran.stderr
    assert "Traceback" not in ran.stderr
