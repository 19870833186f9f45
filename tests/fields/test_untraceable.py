"""What cannot be traced is refused with a sentence that names the plugin's line."""

from __future__ import annotations

import inspect

import numpy as np
import pytest
from scipy import special
from scipy.interpolate import interp1d
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


def complex_number_in_a_function(x):
    return np.arctan2(1j * x[0], x[1])


def complex_numbers_in_order(x):
    return 1.0 if 1j * x[0] < x[1] else 2.0


def imaginary_part_of_an_array(x):
    return (np.array([1j, 2.0]) * x).imag[0]


def least_squares(x):
    return np.linalg.lstsq(np.array([[1.0, x[0]], [1.0, 2.0]]), np.ones(2))[0]


def singular_values(x):
    return np.linalg.svd(x[:2].reshape(1, 2))[1]


LINES = interp1d([0.0, 1.0], [0.0, 2.0])


def straight_lines(x):
    return LINES(x[0])


def rounded_by_numpy(x):
    return np.round(x[0])


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
    complex_number_in_a_function,
    complex_numbers_in_order,
    imaginary_part_of_an_array,
    least_squares,
    singular_values,
    straight_lines,
    rounded_by_numpy,
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


def test_a_complex_result_is_refused():
    with pytest.raises(UnsupportedOperation, match="complex number stands where a real one"):
        kernel_of(lambda x: x[0] + 1j * x[1], 2)


def test_endless_loop_says_what_to_do():
    with pytest.raises(UnsupportedOperation, match="fixed number of passes"):
        kernel_of(endless_loop, 2)


def test_too_many_paths_says_what_to_do():
    with pytest.raises(UnsupportedOperation, match=r"numpy\.where"):
        kernel_of(too_many_paths, 2)
