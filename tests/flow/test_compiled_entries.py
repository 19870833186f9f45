"""Under what text a kernel is kept: that of all functions that are compiled into it, and of their numbers."""

from __future__ import annotations

import ctypes
from importlib import import_module

import numpy as np
import pytest
from numba.extending import is_jitted

from contwalk.flow.compiled.compiled_field import EACH
from contwalk.flow.compiled.entry_points import Entry
from contwalk.flow.ensemble.sampling import _BATCH
from contwalk.flow.explicit.explicit_call import ExplicitCall, StepControl
from contwalk.flow.explicit.runge_kutta import ADAPTIVE, INTERPOLATE
from contwalk.flow.hybrid.event_integrator import INTEGRATE
from contwalk.flow.hybrid.event_records import ModeRecord
from contwalk.flow.radau.radau_call import RadauCall
from contwalk.flow.radau.radau_iia import _ADAPTIVE, _TANGENTS
from contwalk.module_texts import modules_behind
from contwalk.problems.orbit.condensed import ELIMINATE

ENTRIES = (INTEGRATE, ADAPTIVE, INTERPOLATE, _ADAPTIVE, _TANGENTS, _BATCH, EACH, ELIMINATE)


def called(function):
    """Functions for numba that a function calls, directly or not, and itself."""
    found, todo = set(), [function]
    while todo:
        function = todo.pop()
        if function not in found:
            found.add(function)
            used = [function.__globals__.get(name) for name in function.__code__.co_names]
            todo += [one.py_func for one in used if is_jitted(one)]
    return found


@pytest.mark.parametrize("entry", ENTRIES, ids=lambda entry: entry.name)
def test_a_kernel_is_compiled_anew_when_any_function_in_it_changes(entry: Entry):
    """Else a new version would run the machine code of the old one."""
    function = getattr(import_module(entry.module), entry.name)
    assert {one.__module__ for one in called(function)} <= set(modules_behind(entry.module))


def test_modules_of_numbers_are_behind_a_kernel_whether_imported_whole_or_by_name():
    """`from package import guard_taylor_records` and `from package.explicit_call import (...)`."""
    assert {"contwalk.flow.explicit.explicit_call", "contwalk.flow.hybrid.guard_taylor_records"} <= set(
        modules_behind(INTEGRATE.module)
    )


def test_compiled_code_is_told_by_name_what_more_than_eight_arguments_would_say():
    """Functions for numba and entries: numbers that are told by their places are mistaken for each other."""
    for entry in ENTRIES:
        function = getattr(import_module(entry.module), entry.name)
        assert max(one.__code__.co_argcount for one in called(function)) <= 8
        assert len(entry.arguments) <= 8


def test_a_record_has_the_fields_that_its_annotations_name_and_no_others():
    """Integers and doubles in their order, all zero at first; a name that is none is refused."""
    control = StepControl(time=2.5)
    assert (control.time, control.length, control.error, control.undefined) == (2.5, 0.0, 0.0, 0.0)
    assert [name for name, _ in StepControl._fields_] == ["time", "length", "error", "undefined"]
    with pytest.raises(AttributeError):
        control.lenght = 1.0
    with pytest.raises(AttributeError):
        StepControl(tiem=1.0)
    control.clear()
    assert control.time == 0.0


@pytest.mark.parametrize("kind", [ExplicitCall, StepControl, RadauCall, ModeRecord], ids=lambda k: k.__name__)
def test_numba_sees_the_fields_of_a_record_where_the_interpreter_does(kind):
    seen = np.dtype(kind)
    assert seen.itemsize == ctypes.sizeof(kind)
    for name, declared in kind._fields_:
        assert seen.fields[name] == (np.dtype(declared), getattr(kind, name).offset)
