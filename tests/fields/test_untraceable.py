"""What cannot be traced is refused with a sentence that names the plugin's line."""

from __future__ import annotations

import inspect

import numpy as np
import pytest
from scipy import special
from traced_kernels import kernel_of

from contwalk.errors import PluginError, UnsupportedOperation


def bessel(x):
    return special.jv(0, x[0])


def whole_number(x):
    return int(x[0]) + x[1]


def table_lookup(x):
    return np.array([1.0, 2.0, 3.0])[x[0]]


def endless_loop(x):
    v = x[0]
    while v > 1e-3:
        v = v / 2.0
    return v


def too_many_paths(x):
    total = 0.0
    for k in range(10):
        total = total + (x[0] if x[0] > 0.1 * k * x[1] else 1.0)
    return total


def eigenvalues(x):
    return np.linalg.eigvalsh(np.array([[x[0], 1.0], [1.0, x[1]]]))


def numpy_function_without_derivative(x):
    return np.spacing(x[0])


def solve_of_the_wrong_shape(x):
    return np.linalg.solve(np.array([[x[0], 1.0], [0.0, x[1]]]), np.array([1.0, 2.0, 3.0]))


def table_with_moving_places(x):
    return np.interp(0.5, [0.0, x[0]], [1.0, 2.0])


def table_out_of_order(x):
    return np.interp(x[0], [0.0, 2.0, 1.0], [1.0, 2.0, 3.0])


def positions(x):
    return np.where(x > 0.0)


def text(x):
    return f"{x[0]:.3f}" + x[1]


def rounded(x):
    return round(x[0])


def complex_number(x):
    return (x[0] + 1j * x[1]).real


def missing_name(x):
    return x[0] + undefined  # noqa: F821 - on purpose


def undefined_state(x):
    return x[7]


REFUSED = (
    bessel,
    whole_number,
    endless_loop,
    too_many_paths,
    eigenvalues,
    numpy_function_without_derivative,
    solve_of_the_wrong_shape,
    table_with_moving_places,
    table_out_of_order,
    positions,
    text,
    rounded,
    complex_number,
)
RAISES = (table_lookup, missing_name, undefined_state)


def lines_of(function):
    source, first = inspect.getsourcelines(function)
    return range(first, first + len(source))


@pytest.mark.parametrize("function", REFUSED, ids=lambda f: f.__name__)
def test_refused_with_a_sentence(function):
    with pytest.raises(UnsupportedOperation) as caught:
        kernel_of(function, 2)
    assert caught.value.remedy
    if "paths" in caught.value.sentence:
        return  # no single line is to blame
    file, line = caught.value.sentence.split(", line ")
    assert file == __file__
    assert int(line.split(":")[0]) in lines_of(function)


@pytest.mark.parametrize("function", RAISES, ids=lambda f: f.__name__)
def test_exception_names_the_plugins_line(function):
    """What Python or numpy themselves refuse is the plugin's own exception, with its line."""
    with pytest.raises(PluginError) as caught:
        kernel_of(function, 2)([0.5, 0.5])
    file, line = caught.value.sentence.split(" at ", 1)[1].split(", line ")
    assert file == __file__
    assert int(line.split(":")[0]) in lines_of(function)


def test_endless_loop_says_what_to_do():
    with pytest.raises(UnsupportedOperation, match="fixed number of passes"):
        kernel_of(endless_loop, 2)


def test_too_many_paths_says_what_to_do():
    with pytest.raises(UnsupportedOperation, match=r"numpy\.where"):
        kernel_of(too_many_paths, 2)
