"""Declared neutral directions: do fields carry them along, and do transitions take them to themselves?

A direction may be neutral for some parameters, or at equilibria, only: where it is, each branch finds at its
start. What is neutral nowhere is an error; what all fields carry along and a transition breaks is a warning.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from contwalk.fields.derivative import directional
from contwalk.fields.graph import Graph
from contwalk.fields.ranges import ranges
from contwalk.fields.trace import Outputs, trace
from contwalk.plugin_check import neutral_somewhere
from contwalk.plugin_check.events import traced_reset
from contwalk.plugin_check.findings import Report, place_of
from contwalk.plugin_check.functions import EPSILON, check_map
from contwalk.plugin_check.guards import parameter_bounds, traced_guard
from contwalk.plugin_check.modes import CheckedFields, distinct_transitions
from contwalk.plugin_check.samples import Samples, named_equilibria
from contwalk.plugin_check.states_at_event import states_at_event
from contwalk.plugin_check.traced import Form, Traced, traced, vector_form
from contwalk.system import Neutral, System, Transition

# Both sides agree to this part of their terms, as along the orbits of a run.
NEUTRAL = 1e-10
# Bounds of rounding errors are of first order and of single operations.
FACTOR = 100.0
# An equilibrium that is named is one to this part of the terms of A g.
AT_REST = 1e-7
# Values that switch a term off, or make a factor that of nothing.
TRIED = (0.0, 1.0)
# A generator this small against its size at sampled states has no direction.
VANISHED = 1e-6


def check_neutral(
    report: Report, neutral: Neutral, system: System, fields: CheckedFields, samples: Samples
) -> None:
    """Check the generator, and that Df v = Dv f in all modes, DG v(x) = +-v(G(x)) and Dh v = 0 at events."""
    what = words(neutral)
    generator = check_map(report, what, neutral.generator, system, samples, _form(system))
    if (
        generator is None
        or not fields.complete
        or not check_somewhere(report, what, generator, fields, samples)
    ):
        return
    lost = _lost_along(generator, fields, samples)
    place = place_of(neutral.generator)
    if lost:
        # It may be neutral for other parameters, or at equilibria that nobody names: that is no mistake.
        where = _where_neutral(generator, fields, system, samples)
        if where:
            report.ok(what, f"is neutral {where}; at the defaults {lost}.", place)
            return
        report.warning(
            what,
            f"Nothing shows it to be neutral: {lost}, and no parameters and no equilibrium were found with "
            "which it is. It is held only where a branch begins that shows it to be neutral, and else it has "
            "no effect. Correct its generator or the field, or remove it, unless you know where it is.",
            place,
        )
        return
    report.ok(what, f"is carried along by the fields of all modes{fields.sampled}.", place)
    for transition in distinct_transitions(system):
        if transition.role != "watched":
            _check_event(report, what, generator, transition, system, fields, samples)


def words(neutral: Neutral) -> str:
    """The declaration in findings."""
    return f"neutral direction '{neutral.name}'"


def traced_generator(report: Report, neutral: Neutral, system: System) -> Traced | None:
    """The generator; None, and a finding, where it cannot be used."""
    return traced(report, words(neutral), neutral.generator, system, _form(system))


def _form(system: System) -> Form:
    return vector_form(system, "generator", "v")


def check_somewhere(
    report: Report, what: str, generator: Traced, fields: CheckedFields, samples: Samples
) -> bool:
    """Whether a direction may be neutral at all; a finding where expressions show that it is nowhere.

    Equilibria, motions and orbits all need the bracket Df v - Dv f to vanish: at an equilibrium it is A v.
    """
    place = place_of(generator.function)
    if generator.system.period is None and 0 in generator.depends():
        sentence = "It depends on t: a direction is a function of the state and the parameters."
        report.error(what, sentence, place)
        return False
    if _is_zero(generator):
        report.error(
            what,
            "It is zero everywhere, which is no direction. Write its entries into v, or remove it.",
            place,
        )
        return False
    entries = list[str]()
    for each in generator.system.modes:  # of many modes only the first is traced, as a rule
        entry = _always_changes(generator, fields[each.name], samples)
        if entry is None:
            return True
        entries.append(entry)
    mode, entry = generator.system.modes[0].name, entries[0]
    report.error(
        what,
        f"It is neutral nowhere: moved along it, {entry} changes in mode '{mode}', whatever the state and "
        "the parameters are. Correct its generator or the field, or remove it.",
        place,
    )
    return False


def _is_zero(generator: Traced) -> bool:
    value = generator.program.graph.value
    return all(value(node) == 0.0 for leaf in generator.outputs() for node in leaf.nodes)


def _always_changes(generator: Traced, field: Traced, samples: Samples) -> str | None:
    """The rate that moving along a direction changes everywhere; None where there is none."""
    n, bounds = len(field.form.names), parameter_bounds(field.system)
    both = trace(lambda tracer: [*field.recorded(tracer), *generator.recorded(tracer)])
    common = set(range(n))
    for leaf in both.leaves():
        if isinstance(leaf, Outputs):
            changes = ranges(both.graph, tuple(_bracket_nodes(both.graph, leaf, field.existing)), bounds)
            common &= {i for i, (low, high) in enumerate(changes) if low > 0.0 or high < 0.0}
    seen = [i for i in sorted(common) if _differs(generator, field, i, samples)]
    return field.form.entry(seen[0]) if seen else None


def _bracket_nodes(graph: Graph, leaf: Outputs, existing: Sequence[int]) -> list[int]:
    """Nodes of Df v - Dv f, from those of f and v in one graph."""
    n = len(leaf.nodes) // 2
    f, v = leaf.nodes[:n], leaf.nodes[n:]
    along = directional(graph, f, {graph.input("x", i): v[i] for i in existing})
    flowing = {graph.input("x", i): f[i] for i in existing} | {graph.input("t", 0): graph.one}
    turned = directional(graph, v, flowing)
    return [graph.sub(a, b) for a, b in zip(along, turned, strict=True)]


def _differs(generator: Traced, field: Traced, i: int, samples: Samples) -> bool:
    """Whether a rate is another one after a move: what cancels but for rounding changes nothing."""
    for t, x in zip(samples.times, samples.states, strict=True):
        apart, terms = _bracket(generator, field, t, field.given(x), samples)
        if abs(apart[i]) > NEUTRAL * terms[i]:
            return True
    return False


def varied(samples: Samples, system: System) -> Iterator[tuple[str, Samples]]:
    """The samples with one parameter after the other at a value that may make a direction neutral."""
    for parameter in system.parameters:
        for value in TRIED:
            if parameter.conserved or value == parameter.default or not parameter.allows(value):
                continue
            given = samples.parameters | {parameter.name: value}
            yield (
                f"with {parameter.name} = {value:g}",
                replace(samples, parameters=given, values=list(given.values())),
            )


def _where_neutral(generator: Traced, fields: CheckedFields, system: System, samples: Samples) -> str:
    """Where a direction is neutral that is not so everywhere at the defaults, in words; empty if nowhere."""
    named = "at equilibria that are named"
    if _at_rest(generator, fields, system, samples):
        return named
    for how, other in varied(samples, system):
        if not _lost_along(generator, fields, other):
            return how
        if _at_rest(generator, fields, system, other):
            return f"{how}, {named}"
    return _found_neutral(generator, fields, system, samples)


def _found_neutral(generator: Traced, fields: CheckedFields, system: System, samples: Samples) -> str:
    """Where, other than at the defaults, a direction is neutral, by least squares; empty if nowhere."""
    defaults = np.array(samples.values)
    starts, units, low, high = neutral_somewhere.parameter_starts(system, defaults)

    sizes = _brackets(generator, fields, samples)[1]
    sizes = np.where(sizes > 0.0, sizes, 1.0)

    def along_motions(values: np.ndarray) -> np.ndarray:
        return _brackets(generator, fields, replace(samples, values=values.tolist()))[0] / sizes

    found = neutral_somewhere.zero_of(along_motions, starts, units, low, high)
    if found is not None:
        return neutral_somewhere.in_words(system, defaults, found)
    return _found_at_rest(generator, fields[system.modes[0].name], system, samples)


def _brackets(generator: Traced, fields: CheckedFields, samples: Samples) -> tuple[np.ndarray, np.ndarray]:
    """The bracket at sampled states in all modes, and the size of its terms, shape (k,) each."""
    found = [_bracket(generator, field, t, field.given(x), samples) for _, field, t, x in fields.at(samples)]
    apart, terms = zip(*found, strict=True)
    return np.concatenate(apart), np.concatenate(terms)


def _at(
    generator: Traced, field: Traced, x: np.ndarray, values: list[float]
) -> tuple[np.ndarray, np.ndarray, float, float]:
    """f and A v at a state, shape (n,) each, the length of v and the size of the terms of A v."""
    v, by = generator.values(0.0, x, values), field.slopes(0.0, x, values)[:, 1:]
    terms = float((np.abs(by) @ np.abs(v)).max(initial=0.0))
    return field.values(0.0, x, values), by @ v, float(np.linalg.norm(v)), terms


def _found_at_rest(generator: Traced, field: Traced, system: System, samples: Samples) -> str:
    """An equilibrium of the first mode at which A v = 0 and v is a direction, in words; empty if none."""
    n, defaults = len(samples.scales), np.array(samples.values)
    seen = [_at(generator, field, x, samples.values) for x in samples.states]
    long, steep = (float(np.median([each[k] for each in seen])) or 1.0 for k in (2, 3))
    fast = np.median([field.roundings(0.0, x, samples.values) for x in samples.states], axis=0)
    fast = np.where(fast > 0.0, fast, 1.0)

    def at_rest(u: np.ndarray) -> np.ndarray:
        rates, turned, length, _ = _at(generator, field, field.given(u[:n]), u[n:].tolist())
        lost = 0.0 if length > VANISHED * long else 1.0
        return np.concatenate([rates / fast, turned / steep, [lost]])

    starts, units, low, high = neutral_somewhere.parameter_starts(system, defaults)
    both = [np.concatenate([x, p]) for x, p in zip(samples.states, starts, strict=True)]
    anywhere = np.full(n, np.inf)
    found = neutral_somewhere.zero_of(
        at_rest,
        both,
        np.concatenate([samples.scales, units]),
        np.concatenate([-anywhere, low]),
        np.concatenate([anywhere, high]),
    )
    if found is None:
        return ""
    named = ", ".join(
        f"{name} = {value:.4g}" for name, value in zip(system.state_names, found[:n], strict=True)
    )
    others = neutral_somewhere.in_words(system, defaults, found[n:])
    return f"{others + ', ' if others else ''}at the equilibrium {named}"


# -- fields ----------------------------------------------------------------------------------------------


def _lost_along(generator: Traced, fields: CheckedFields, samples: Samples) -> str:
    """How the field of a mode does not carry a direction along, in words; empty where all do."""
    for mode, field, t, x in fields.at(samples):
        apart, terms = _bracket(generator, field, t, field.given(x), samples)
        if not (np.isfinite(apart).all() and np.isfinite(terms).all()):
            continue
        wrong = np.abs(apart) > NEUTRAL * terms
        if wrong.any():
            i = int(np.argmax(np.abs(apart) / np.maximum(terms, np.finfo(float).tiny)))
            return f"{field.form.entry(i)} changes along it in mode '{mode}', by {apart[i]:.4g}"
    return ""


def _bracket(
    generator: Traced, field: Traced, t: float, x: np.ndarray, samples: Samples
) -> tuple[np.ndarray, np.ndarray]:
    """Df v - Dv f in the states that exist, and the size of its terms."""
    here = list(field.existing)
    v, turned = generator.values(t, x, samples.values)[here], generator.slopes(t, x, samples.values)
    f, slopes = field.values(t, x, samples.values)[here], field.slopes(t, x, samples.values)
    by, own = slopes[here, 1:][:, here], turned[here, 1:][:, here]
    apart, terms = np.zeros(len(x)), np.zeros(len(x))
    apart[here] = by @ v - own @ f - turned[here, 0]
    terms[here] = np.abs(by) @ np.abs(v) + np.abs(own) @ np.abs(f) + np.abs(turned[here, 0])
    # What changes a rate by less than its rounding, over a shift as long as states are large, is nothing.
    steep = float(np.max(np.abs(v) / samples.scales[here], initial=0.0))
    noise = FACTOR * EPSILON * field.roundings(t, x, samples.values) * steep
    return apart, terms + noise / NEUTRAL


def _at_rest(generator: Traced, fields: CheckedFields, system: System, samples: Samples) -> bool:
    """Whether A v = 0 at an equilibrium that the system names, at the defaults."""
    field = fields[system.modes[0].name]
    for x in named_equilibria(system, samples.parameters):
        v = generator.values(0.0, x, samples.values)
        by = field.slopes(0.0, x, samples.values)[:, 1:]
        if not (np.isfinite(v).all() and np.any(v) and np.isfinite(by).all()):
            continue
        if np.all(np.abs(by @ v) <= AT_REST * float((np.abs(by) @ np.abs(v)).max())):
            return True
    return False


# -- events ----------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class _Event:
    """A transition with its functions; `relabel` is the map by which it swaps names."""

    transition: Transition
    guard: Traced
    reset: Traced | None
    relabel: Traced | None
    existing: list[int]

    def landed(self, t: float, x: np.ndarray, samples: Samples) -> tuple[np.ndarray, np.ndarray]:
        """The state after it and the derivative of it by the state before."""
        after, slope = x, np.eye(len(x))
        for each in (self.reset, self.relabel):
            if each is not None:
                slope = each.slopes(t, after, samples.values)[:, 1:] @ slope
                after = each.values(t, after, samples.values)
        kept = np.zeros(len(x))
        kept[self.existing] = 1.0
        return kept * after, kept[:, None] * slope


def _check_event(
    report: Report,
    what: str,
    generator: Traced,
    transition: Transition,
    system: System,
    fields: CheckedFields,
    samples: Samples,
) -> None:
    silent = Report()
    guard, reset = traced_guard(silent, "guard", transition, system), traced_reset(silent, transition, system)
    if guard is None or (transition.reset is not None and reset is None):
        return  # told where it is checked itself
    relabel = None
    if transition.relabel is not None:
        symmetry = system.symmetry(transition.relabel)
        relabel = traced(silent, "map", symmetry.map, system, vector_form(system, "map", "x_image"))
    existing = list(system.states_of(transition.target))
    event = _Event(transition, guard, reset, relabel, existing)
    field = fields[transition.source]
    lost = _lost_at(event, generator, field, samples)
    if lost is None:
        return
    where = next(
        (how for how, other in varied(samples, system) if _lost_at(event, generator, field, other) is None),
        "",
    )
    sentence, function = lost
    sentence = f"Transition '{transition.name}' does not keep it: {sentence}"
    place = place_of(function)
    if where:
        report.ok(what, f"{sentence} at the defaults; {where} it does.", place)
        return
    report.warning(
        what,
        f"{sentence}, though the fields of all modes carry it along. Orbits that meet this event do not come "
        "in families along it, and it is not held. Correct the generator, the guard or the reset, unless it "
        "is meant for solutions without this event.",
        place,
    )


def _lost_at(
    event: _Event, generator: Traced, field: Traced, samples: Samples
) -> tuple[str, Callable[..., Any]] | None:
    """What an event does to a direction, in words, and the function that does it; None where it keeps it."""
    signs = {1.0, -1.0}
    for t, x in states_at_event(event.transition, event.guard, field, samples):
        v = event.guard.given(generator.values(t, x, samples.values))
        slope = event.guard.slopes(t, x, samples.values)[0, 1:]
        after, carried = event.landed(t, x, samples)
        w = generator.values(t, after, samples.values)
        if not all(np.isfinite(each).all() for each in (v, slope, after, carried, w)):
            continue
        moved, terms = float(slope @ v), float(np.abs(slope) @ np.abs(v))
        if abs(moved) > NEUTRAL * terms:
            return f"its guard changes along it, by {moved:.4g}", event.transition.guard
        expected = np.zeros(len(x))
        expected[event.existing] = w[event.existing]
        came, size = carried @ v, np.abs(carried) @ np.abs(v) + np.abs(expected)
        wrong = {sign: np.abs(came - sign * expected) > NEUTRAL * size for sign in signs}
        signs = {sign for sign in signs if not wrong[sign].any()}
        if not signs:
            i = int(np.argmax(wrong.get(1.0, next(iter(wrong.values())))))
            name = generator.form.names[i]
            sentence = (
                f"{name} moves by {came[i]:.4g} after it, where the direction there has {expected[i]:.4g}"
            )
            return sentence, event.transition.reset or event.transition.guard
    return None
