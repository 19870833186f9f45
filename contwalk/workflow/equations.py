"""What decides the points of a branch, as text: equations, defaults, and what is measured of each point."""

from __future__ import annotations

import ast
import functools
import hashlib
import inspect
import json
import linecache
import sys
import textwrap
import types
from collections.abc import Callable, Iterator, Mapping
from dataclasses import is_dataclass
from typing import Any

import numpy as np

from contwalk import object_cache
from contwalk.fields.codegen import source
from contwalk.memory import remembered
from contwalk.problems.equilibrium.equilibrium import Equilibrium
from contwalk.python_functions import is_own, original, values_used
from contwalk.workflow.run_file.reading import RunFile


def equations_hash(run_file: RunFile) -> str:
    """Hash of everything about the system that decides a branch, whichever files it is spread over."""
    system = run_file.system
    texts = [equations_text(run_file), json.dumps(system.defaults(), sort_keys=True)]
    for observable in system.observables:
        texts += [observable.name, repr(observable.at), *function_texts(observable.function)]
    for kind in system.point_types:
        methods = [member for member in vars(type(kind)).values() if isinstance(member, types.FunctionType)]
        texts += [type(kind).__name__, kind.label, repr(kind) if is_dataclass(kind) else ""]
        texts += [text for method in methods for text in function_texts(method)]
    return hashlib.sha256("\n".join(texts).encode()).hexdigest()


# A run asks once whether its equations can be traced, and once more for their hash.
_KNOWN: dict[int, tuple[RunFile, str]] = {}


def equations_text(run_file: RunFile) -> str:
    """The traced equations as text, so that a change in any function that they call shows.

    Raises
    ------
    UnsupportedOperation, SystemDefinitionError
        With the line of the plugin.
    """
    # What is kept keeps its run file, and so its identity.
    return remembered(_KNOWN, id(run_file), 1, lambda: (run_file, _equations_text(run_file)))[1]


def _equations_text(run_file: RunFile) -> str:
    given = run_file.system, run_file.parameters, run_file.free, run_file.parameter_path
    if run_file.system.has_events:
        from contwalk.problems.hybrid.source_text import equations_text as hybrid_text

        free = None if run_file.parameter_path is not None else run_file.free
        return hybrid_text(run_file.system, free)
    if run_file.system.period is None:
        return Equilibrium(*given).kernels.residual.text
    from contwalk.problems.orbit.periodic_orbit import PeriodicOrbit

    passage = PeriodicOrbit(*given).passages[0]
    return source(passage.program, (*passage.groups, "u", "t"))


def function_texts(function: Callable[..., Any]) -> Iterator[str]:
    """A function that is not traced, and the plugin's helpers and constants that it uses.

    Observables get whole motions and may do anything with them. Their text is that of their source without
    comments and layout, which is the same under every version of Python.
    """
    yield from _texts(function, set())


def _texts(value: Any, seen: set[int]) -> Iterator[str]:
    """The texts of a value and of what it holds or uses; nothing of what cannot be told from its address."""
    if id(value) in seen:
        return
    seen.add(id(value))
    if isinstance(value, functools.partial):
        for held in (value.func, value.args, value.keywords):
            yield from _texts(held, seen)
    elif isinstance(value, bool | int | float | complex | str | bytes | None):
        yield repr(value)
    elif isinstance(value, np.ndarray):
        yield repr(value.tolist())
    elif isinstance(value, Mapping):
        for key in value:
            yield repr(key)
            yield from _texts(value[key], seen)
    elif isinstance(value, tuple | list):
        for held in value:
            yield from _texts(held, seen)
    elif isinstance(python := original(value), types.FunctionType) and not is_own(python):
        yield _source_of(python)
        yield from _texts((python.__defaults__, python.__kwdefaults__), seen)
        for name, used in values_used(python):
            yield name
            yield from _texts(used, seen)


@functools.lru_cache(maxsize=1024)  # observables share helpers
def _source_of(function: types.FunctionType) -> str:
    """The source of a function as Python would write it; its code where there is none, or none of its own.

    It is kept on disk under the text of its file, and where it stands in it: to read it takes longer.
    """
    code = function.__code__
    linecache.checkcache(code.co_filename)
    lines, place = linecache.getlines(code.co_filename), (code.co_name, str(code.co_firstlineno))
    name = object_cache.key("source of a function", sys.version, *place, "".join(lines))
    kept = object_cache.load_values(name) if lines else None
    if kept is None:
        kept = [_written(function)]
        if lines:
            object_cache.store_values(name, kept)
    return str(kept[0])


def _written(function: types.FunctionType) -> str:
    """As `_source_of`, read."""
    try:
        return ast.unparse(ast.parse(textwrap.dedent(inspect.getsource(function))))
    except (OSError, TypeError, SyntaxError):  # made by exec; a lambda within an expression
        code = function.__code__
        constants = [c for c in code.co_consts if not isinstance(c, types.CodeType)]
        return f"{code.co_code.hex()} {constants!r}"
