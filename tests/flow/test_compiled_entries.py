"""Under what text a kernel is kept: that of all functions that are compiled into it, and of their numbers."""

from __future__ import annotations

from importlib import import_module

import pytest
from numba.extending import is_jitted

from contwalk.flow.compiled.compiled_field import EACH
from contwalk.flow.compiled.entry_points import Entry, modules_behind
from contwalk.flow.ensemble.sampling import _BATCH
from contwalk.flow.explicit.runge_kutta import ADAPTIVE
from contwalk.flow.hybrid.walk import WALK
from contwalk.flow.radau.radau_iia import _ADAPTIVE, _TANGENTS
from contwalk.problems.hybrid.condensed import ELIMINATE

ENTRIES = (WALK, ADAPTIVE, _ADAPTIVE, _TANGENTS, _BATCH, EACH, ELIMINATE)


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
    """`from package import plan` and `from package.walk_plan import (...)`."""
    assert {"contwalk.flow.explicit.plan", "contwalk.flow.hybrid.walk_plan"} <= set(
        modules_behind(WALK.module)
    )
