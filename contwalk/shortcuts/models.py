"""`@cw.model`: a function with named arguments as a system."""

from __future__ import annotations

import ast
import hashlib
import inspect
import types
from collections.abc import Callable, Mapping
from typing import Any, overload

import numpy as np

from contwalk.errors import SystemDefinitionError
from contwalk.plugin_check.at_load import refuse_unsound
from contwalk.python_functions import line_of, place_of
from contwalk.system import Mode, Parameter, State, System
from contwalk.system.loading import made
from contwalk.system.names import nearest

TIME = "t"
_ARGUMENTS = (inspect.Parameter.POSITIONAL_ONLY, inspect.Parameter.POSITIONAL_OR_KEYWORD)


@overload
def model(
    function: Callable[..., Any],
    /,
    *,
    start: Mapping[str, float] | None = None,
    period: float | Callable[..., float] | None = None,
    about: str | Mapping[str, str] | None = None,
    map: bool = False,
    **parameters: float,
) -> System: ...
@overload
def model(
    function: None = None,
    /,
    *,
    start: Mapping[str, float] | None = None,
    period: float | Callable[..., float] | None = None,
    about: str | Mapping[str, str] | None = None,
    map: bool = False,
    **parameters: float,
) -> Callable[[Callable[..., Any]], System]: ...
def model(
    function: Callable[..., Any] | None = None,
    /,
    *,
    start: Mapping[str, float] | None = None,
    period: float | Callable[..., float] | None = None,
    about: str | Mapping[str, str] | None = None,
    map: bool = False,
    **parameters: float,
) -> Any:
    """Make a system of a function: its arguments are the states, its keyword-only arguments parameters.

    Parameters
    ----------
    function : callable, optional
        Where all parameters have defaults of their own, as in `@cw.model` alone.
    start : mapping, optional
        Values of states where motions may begin.
    period : float or callable, optional
        Of a forced system, whose function has an argument `t` as well: a number, or a function of parameters
        by their names, as `lambda omega: 2 * math.pi / omega`.
    about : str or mapping, optional
        What the system is; or a line for states and parameters by their names.
    map : bool
        Whether the function returns the next state, and not the rates.
    **parameters : float
        Default of each parameter.

    Returns
    -------
    callable
        The decorator; over a function, the system itself: a `System`, which all verbs take.

    Raises
    ------
    SystemDefinitionError
        With the function's line.

    Examples
    --------
    >>> @cw.model(A=1.0, B=1.5)
    ... def brusselator(x, y, *, A, B):
    ...     return A - (B + 1) * x + x**2 * y, B * x - x**2 * y
    """

    def decorated(function: Callable[..., Any]) -> System:
        return _system(function, parameters, start or {}, period, about, map)

    return decorated if function is None else decorated(function)


def _system(
    function: Callable[..., Any],
    given: Mapping[str, float],
    start: Mapping[str, float],
    period: float | Callable[..., float] | None,
    about: str | Mapping[str, str] | None,
    is_map: bool,
) -> System:
    if not isinstance(function, types.FunctionType):
        raise SystemDefinitionError(
            f"@cw.model is over {type(function).__name__}.", "Put it over a function of the states."
        )
    arguments = inspect.signature(function).parameters.values()
    states = [a.name for a in arguments if a.kind in _ARGUMENTS and a.name != TIME]
    timed = any(a.name == TIME for a in arguments)
    values = {
        a.name: given.get(a.name, a.default) for a in arguments if a.kind == inspect.Parameter.KEYWORD_ONLY
    }
    _check(function, states, values, given, start)
    _check_returned(function, states, {**values, TIME: 0.0} if timed else values)
    told = about if isinstance(about, Mapping) else {}
    for name in told:
        if name not in (*states, *values):
            near = nearest(name, [*states, *values])
            raise _wrong(function, f"about names '{name}', which is no argument", near)
    system = System(
        name=function.__name__,
        states=tuple(State(name, start=start.get(name), about=told.get(name, "")) for name in states),
        parameters=tuple(Parameter(name, value, about=told.get(name, "")) for name, value in values.items()),
        modes=(_mode(function, states, list(values), timed, is_map),),
        period=_period(function, period, list(values)),
        about=about if isinstance(about, str) else "",
        reference=line_of(function).removesuffix(": "),
    )
    refuse_unsound(system)
    return made(system, _hash(function, period, system))


def _wrong(function: Callable[..., Any], what: str, remedy: str = "") -> SystemDefinitionError:
    return SystemDefinitionError(f"{line_of(function)}{what}.", remedy)


def _check(
    function: Callable[..., Any],
    states: list[str],
    values: Mapping[str, Any],
    given: Mapping[str, float],
    start: Mapping[str, float],
) -> None:
    name = function.__name__
    form = "As in def name(x, y, *, A, B): states, a star, parameters."
    for argument in inspect.signature(function).parameters.values():
        if argument.kind in (inspect.Parameter.VAR_POSITIONAL, inspect.Parameter.VAR_KEYWORD):
            raise _wrong(function, f"{name} takes *{argument.name}, whose names are not known", form)
        if argument.kind in _ARGUMENTS and argument.default is not inspect.Parameter.empty:
            raise _wrong(
                function, f"the state {argument.name} has a default", "Defaults of states are start={...}."
            )
    if not states:
        raise _wrong(function, f"{name} has no arguments that could be states", form)
    for parameter in given:
        if parameter not in values:
            raise _wrong(
                function,
                f"@cw.model gives {parameter}, which is no keyword-only argument of {name}",
                nearest(parameter, list(values)) or form,
            )
    for parameter, value in values.items():
        if value is inspect.Parameter.empty:
            raise _wrong(function, f"the parameter {parameter} has no default", f"@cw.model({parameter}=1.0)")
    for state in start:
        if state not in states:
            raise _wrong(function, f"start names '{state}', which is no state", nearest(state, states))


def _check_returned(function: Callable[..., Any], states: list[str], given: Mapping[str, Any]) -> None:
    """Refuse a function that returns another number of values than it has states."""
    try:
        found = function(**dict.fromkeys(states, 1.0), **given)
    except Exception:  # what raises there may do so nowhere else; tracing tells of what always raises
        return
    values = list(found) if isinstance(found, tuple | list | np.ndarray) else [] if found is None else [found]
    if len(values) != len(states):
        raise _wrong(
            function,
            f"{function.__name__} returns {len(values)} value{'s' * (len(values) != 1)} for {len(states)} "
            f"state{'s' * (len(states) != 1)}",
            f"Return one for each, in the order {', '.join(states)}.",
        )


def _mode(
    function: Callable[..., Any], states: list[str], parameters: list[str], timed: bool, is_map: bool
) -> Mode:
    """The mode whose field calls the function with its own names."""
    words = [f"{name}=x[{i}]" for i, name in enumerate(states)]
    words += [f"{TIME}=t"] * timed + [f"{name}=p.{name}" for name in parameters]
    entries = ", ".join(f"dx[{i}]" for i in range(len(states)))
    written = f"{entries if len(states) > 1 else 'dx[:]'} = model({', '.join(words)})"
    field = _compiled(f"def field(t, x, p, dx):\n    {written}", {"model": function}, "field", function)
    return Mode("motion", field, kind="map" if is_map else "flow")


def _compiled(
    text: str, names: Mapping[str, Any], what: str, function: Callable[..., Any]
) -> Callable[..., Any]:
    """A function from a text of our own that calls a user's function by names that Python has checked.

    It stands where that one does: lines that are told are the user's.
    """
    module = types.ModuleType("plugin_of_a_function")
    module.__dict__.update(names)
    file, line = place_of(function)
    tree = ast.parse(text)
    for part in ast.walk(tree):
        if hasattr(part, "lineno"):
            part.lineno = part.end_lineno = line or 1  # type: ignore[attr-defined]
            part.col_offset = part.end_col_offset = 0  # type: ignore[attr-defined]
    exec(compile(tree, file or "the model", "exec"), module.__dict__)
    found: Callable[..., Any] = module.__dict__[what]
    return found


def _period(
    function: Callable[..., Any], period: float | Callable[..., float] | None, parameters: list[str]
) -> Callable[..., float] | None:
    if period is None:
        return None
    if not callable(period):
        value = float(period)
        return lambda p: value
    wanted = list(inspect.signature(period).parameters)
    for name in wanted:
        if name not in parameters:
            raise _wrong(function, f"period takes {name}, which is no parameter", nearest(name, parameters))
    words = ", ".join(f"{name}=p.{name}" for name in wanted)
    return _compiled(f"def period(p):\n    return given({words})", {"given": period}, "period", function)


def _hash(function: types.FunctionType, period: Any, system: System) -> str:
    """What tells a model from another of its name."""
    texts = [repr(system.defaults()), repr(system.state_names)]
    for each in (function, period):
        try:
            texts.append(inspect.getsource(each))
        except (OSError, TypeError):
            texts.append(repr(getattr(getattr(each, "__code__", None), "co_code", each)))
    return hashlib.sha256("\n".join(texts).encode()).hexdigest()
