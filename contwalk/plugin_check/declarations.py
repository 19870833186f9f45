"""Declarations: units and meanings, presets, the period, observables, starts."""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from contwalk.errors import ContwalkError, StartError
from contwalk.fields.rebind import rebound
from contwalk.fields.trace import Tracer, trace
from contwalk.plugin_check.digits import told_apart
from contwalk.plugin_check.findings import NOWHERE, Place, Report, place_of, place_of_error, split_place
from contwalk.plugin_check.samples import Samples
from contwalk.plugin_check.traced import AGAIN, Traced, number_form, traced
from contwalk.problems.equilibrium.declared import resting
from contwalk.python_functions import plain
from contwalk.system import Observable, Start, System
from contwalk.system.declarations import ParameterValues

_UNIT_AT = {"State": 1, "Parameter": 2, "Observable": 2}  # position of `unit` among the arguments
_KINDS = {"State": "state", "Parameter": "parameter", "Observable": "observable"}
_NO_UNIT = 'No unit is given. Write unit="m", or unit="1" if it has none.'
_NO_MEANING = 'No meaning is given. Write about="one line".'
# Closed forms are good to 1e-12 or so; a printed constant in one may have six digits.
ZERO = 1e-6
INSTANTS = (1, 5)


class Written:
    """Where the plugin's files declare states, parameters and observables, and those without a unit."""

    def __init__(self, files: Iterable[Path]) -> None:
        self.places: dict[tuple[str, str], Place] = {}
        self.without_unit: list[tuple[str, str, Place]] = []
        for file in dict.fromkeys(files):
            try:
                tree = ast.parse(file.read_text(encoding="utf-8"))
            except (OSError, ValueError, SyntaxError):
                continue  # not source text, such as a compiled module
            for node in ast.walk(tree):
                if isinstance(node, ast.Call):
                    self._read(node, str(file))

    def _read(self, call: ast.Call, file: str) -> None:
        function = getattr(call.func, "id", getattr(call.func, "attr", ""))
        if function not in _UNIT_AT:
            return
        given: dict[str | None, ast.expr] = {keyword.arg: keyword.value for keyword in call.keywords}
        first = call.args[0] if call.args else given.get("name")
        name = str(first.value) if isinstance(first, ast.Constant) else ""
        place = (file, call.lineno)
        if name:
            self.places[_KINDS[function], name] = place
        unpacked = None in given or any(isinstance(argument, ast.Starred) for argument in call.args)
        if not unpacked and "unit" not in given and len(call.args) <= _UNIT_AT[function]:
            self.without_unit.append((_KINDS[function], name, place))

    def place(self, kind: str, name: str) -> Place:
        """Where this one is declared, if that can be read off."""
        return self.places.get((kind, name), NOWHERE)


def check_words(report: Report, system: System, written: Written) -> None:
    """Units and meanings of states and parameters."""
    before = len(report.findings)
    lacking: dict[str, list[tuple[str, str]]] = {_NO_UNIT: [], _NO_MEANING: []}
    for kind, entries in (("state", system.states), ("parameter", system.parameters)):
        for entry in entries:
            unstated = any(entry.name == name and kind == other for other, name, _ in written.without_unit)
            if unstated or not isinstance(entry.unit, str) or not entry.unit.strip():
                lacking[_NO_UNIT].append((kind, entry.name))
            if not entry.about.strip():
                lacking[_NO_MEANING].append((kind, entry.name))
    for sentence, those in lacking.items():
        if those:
            report.warning(_named(those), sentence, written.place(*those[0]))
    for kind, name, place in written.without_unit:
        if not name:
            report.warning(f"a {kind}", 'No unit is given. Write unit="1" if it has none.', place)
    if not system.reference.strip():
        report.warning(
            f"system '{system.name}'",
            'It has no reference. Say with reference="..." where its equations come from.',
        )
    if len(report.findings) == before:
        report.ok("units and meanings", "are given for all states and parameters.")


def _named(those: Sequence[tuple[str, str]]) -> str:
    """Kinds and names in words: one line for all that lack the same."""
    if len(those) == 1:
        return "{} '{}'".format(*those[0])
    kinds = dict.fromkeys(kind for kind, _ in those)
    parts = [(kind, [name for other, name in those if other == kind]) for kind in kinds]
    return " and ".join(f"{kind}{'s' * (len(names) > 1)} {', '.join(names)}" for kind, names in parts)


def check_presets(report: Report, system: System) -> None:
    """Presets within the bounds of the parameters."""
    before = len(report.findings)
    by_name = {parameter.name: parameter for parameter in system.parameters}
    for preset, values in system.presets.items():
        wrong = [
            f"{name} = {value!r} lies outside {by_name[name].interval()}"
            for name, value in values.items()
            if not by_name[name].allows(value)
        ]
        if wrong:
            report.error(f"preset '{preset}'", f"{'; '.join(wrong)}. Change the preset, or the bounds.")
    if system.presets and len(report.findings) == before:
        report.ok("presets", f"{', '.join(system.presets)} lie within the bounds.")


def check_period(report: Report, system: System) -> float | None:
    """The period of the forcing at the defaults; None for an autonomous system, or a wrong one."""
    if system.period is None:
        return None
    place = place_of(system.period)
    try:
        function = plain(system.period)
        period, again = (float(function(ParameterValues(**system.defaults()))) for _ in range(2))
    except (Exception, SystemExit) as error:
        report.error(
            "period",
            f"period(p) raises {type(error).__name__}: {error}. It must return a positive number.",
            place_of_error(error, system.period),
        )
        return None
    if not (np.isfinite(period) and period > 0.0):
        report.error("period", f"period(p) is {period} at the defaults. It must be a positive number.", place)
        return None
    if again != period:
        report.error("period", AGAIN, place)
        return None
    if _period_can_be_traced(report, system.period, system.parameter_names):
        report.ok("period", f"is {system.lasting(period)} at the defaults.", place)
    return period


def _period_can_be_traced(report: Report, period: Callable[..., float], names: Iterable[str]) -> bool:
    """Whether exact derivatives can be taken of the period, as of a field; a finding where they cannot."""
    function = rebound(period)

    def record(tracer: Tracer) -> list[Any]:
        symbols = {name: tracer.symbol("p", k) for k, name in enumerate(names)}
        return [function(ParameterValues(**symbols))]

    try:
        trace(record)
    except ContwalkError as error:
        where, sentence = split_place(error.sentence, place_of(period))
        report.error("period", f"{sentence} {error.remedy}", where)
        return False
    return True


def check_repeats(
    report: Report, what: str, field: Traced, samples: Samples, period: float, turned: bool = False
) -> None:
    """Does a function of a forced system, such as its field, repeat after its period?

    A guard that is passed in both directions may be `turned`, with the other sign, as sin(pi t / T) is.
    Asked at the defaults, and again with ones in place of zeros: a force that is off by default would repeat
    after any time.
    """
    declared = field.system.period
    assert declared is not None
    switched_on = {p.name: 1.0 for p in field.system.parameters if p.default == 0.0 and p.allows(1.0)}
    for parameters, where in ((samples.parameters, "at the defaults"), (switched_on, _listed(switched_on))):
        values = samples.parameters | parameters
        if parameters is switched_on:
            if not switched_on:
                return
            try:
                period = float(plain(declared)(ParameterValues(**values)))
            except (Exception, SystemExit):
                return
        if not (np.isfinite(period) and period > 0.0):
            return
        sentence = _repeats_not(field, samples, list(values.values()), period, turned)
        if sentence:
            report.error(what, f"{sentence}, {where}. Correct one of them.", place_of(field.function))
            return


def _entry(function: Traced, i: int) -> str:
    return function.form.entry(i) if function.form.argument else "its value"


def _listed(parameters: dict[str, float]) -> str:
    return f"with {', '.join(f'{name} = {value:g}' for name, value in parameters.items())}"


def _repeats_not(field: Traced, samples: Samples, values: list[float], period: float, turned: bool) -> str:
    """What differs a period later, in words; empty where nothing does."""
    for k, x in enumerate(samples.states):
        t = period * (k + 0.37) / len(samples.states)  # anywhere, but at no simple fraction of the period
        now, later = (field.values(time, x, values) for time in (t, t + period))
        if turned and (now * later < 0.0).all():
            later = -later
        rounding = field.roundings(t, x, values)
        slope = np.abs(field.slopes(t, x, values)[:, 0])
        # Rounding of the period and of t, times the rate of the forcing.
        allowed = 1e3 * np.finfo(float).eps * (rounding + slope * (t + period) + np.abs(now))
        if np.isfinite(now).all() and np.isfinite(later).all() and (np.abs(later - now) > allowed).any():
            i = int(np.argmax(np.abs(later - now) - allowed))
            one, other = told_apart(float(now[i]), float(later[i]))
            return (
                f"It does not repeat after period(p) = {period:.10g}: {_entry(field, i)} is "
                f"{one} at t = {t:.4g} and {other} a period later"
            )
    return ""


def check_observable(report: Report, observable: Observable, system: System, samples: Samples) -> None:
    """A finite number for a motion of one instant and of several, and differentiable at an equilibrium."""
    what, place = f"observable '{observable.name}'", place_of(observable.function)
    p, function = ParameterValues(**samples.parameters), plain(observable.function)
    for instants in INSTANTS:
        x = samples.states[:instants]
        try:
            with np.errstate(all="ignore"):
                values = [function(np.linspace(0.0, 1.0, instants), x.copy(), p) for _ in range(2)]
            value = values[0]
            finite = np.ndim(value) == 0 and np.isfinite(float(value))
        except (Exception, SystemExit) as error:
            report.error(
                what,
                f"For a motion of {_instants(instants)} it raises {type(error).__name__}: {error}. "
                f"It gets t of shape ({instants},) and x of shape ({instants}, {len(system.states)}), "
                "and returns a number.",
                place_of_error(error, observable.function),
            )
            return
        if not finite:
            report.error(
                what,
                f"For a motion of {_instants(instants)} it gives {value!r}. "
                "It must return one finite number.",
                place,
            )
            return
        if values[1] != value:
            report.error(what, AGAIN, place)
            return
    if system.period is not None:
        usable = True
    else:
        form = number_form("observable(t, x, p)")
        usable = traced(report, what, observable.function, system, form, instants=1) is not None
    if usable:
        report.ok(what, "gives a finite number.", place)


def _instants(number: int) -> str:
    return "1 instant" if number == 1 else f"{number} instants"


def check_start(report: Report, start: Start, system: System, field: Traced | None, samples: Samples) -> None:
    """Are the named equilibria zeros of the field at the default parameters, or guesses that lead to some?

    A forced system's are constant solutions: zeros of the field at all times.
    """
    what, place = f"start '{start.name}'", place_of(start.states)
    forced = system.period is not None
    try:
        states = system.named_states(start.name, samples.parameters)
    except ContwalkError as error:
        missing = isinstance(error, StartError)
        sentence = f"not checked: {error.sentence}" if missing else str(error)
        where = place_of_error(error.__cause__ or error, start.states)
        report.add("ok" if missing else "error", what, sentence, where)
        return
    except (Exception, SystemExit) as error:
        report.error(
            what,
            f"It raises {type(error).__name__}: {error}. Return [] where it does not exist.",
            place_of_error(error, start.states),
        )
        return
    if field is None:
        return
    for t in (0.0, *samples.times) if forced else (0.0,):
        for x in states:
            rates = _rates_left(field, t, x, samples)
            if rates is None:
                continue
            near = None if forced else _corrected(system, x, samples)
            if near is None:
                kind, when = ("a constant solution", f" at t = {t:.4g}") if forced else ("an equilibrium", "")
                report.error(what, f"It is not {kind} at the defaults: {rates} there{when}.", place)
            else:
                report.warning(
                    what,
                    f"It is a guess at the defaults: {rates} there. Newton's method corrects it wherever it "
                    f"is used, here by {_farthest(system, x, near)}.",
                    place,
                )
            return
    one, several = ("constant solution", "constant solutions") if forced else ("equilibrium", "equilibria")
    report.ok(what, f"gives {len(states)} {one if len(states) == 1 else several} at the defaults.", place)


def _corrected(system: System, x: np.ndarray, samples: Samples) -> np.ndarray | None:
    """The equilibrium that Newton's method finds from a start; None where it finds none."""
    try:
        return resting(system, x, samples.parameters)
    except ContwalkError:  # what is wrong with the equations is another finding
        return None


def _farthest(system: System, x: np.ndarray, near: np.ndarray) -> str:
    """The largest change of a state, in words."""
    i = int(np.argmax(np.abs(near - x)))
    return f"{abs(near[i] - x[i]):.2g} in {system.state_names[i]}"


def _rates_left(field: Traced, t: float, x: np.ndarray, samples: Samples) -> str | None:
    """The rate that is farthest from zero at a state, in words; None where all are zero."""
    value = field.values(t, x, samples.values)
    slope = np.abs(field.slopes(t, x, samples.values)[:, 1:])
    allowed = ZERO * (slope @ np.maximum(np.abs(x), samples.scales))
    if (np.abs(value) <= allowed).all():
        return None
    i = int(np.argmax(np.where(np.isfinite(value), np.abs(value) - allowed, np.inf)))
    return f"{_entry(field, i)} is {value[i]:.6g}"
