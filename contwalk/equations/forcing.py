"""The period of a model that is forced by sines and cosines of the time, all with one frequency."""

from __future__ import annotations

from contwalk.equations.model import Defined, Model
from contwalk.equations.names import TIME, needs
from contwalk.equations.nodes import Node, calls_in, name, names_in, node, number, parts_of, replaced

_PERIODIC = ("sin", "cos")


def period_of(model: Model) -> Defined | None:
    """2 pi over the frequency; None where nothing depends on the time.

    Where the model depends on it otherwise there is none either, and a note says so.
    """
    used = needs(model)
    roots = [entry.value for entry in model.rates.values()]
    todo = {n for root in roots for n in (*names_in(root), *calls_in(root))}
    todo |= {other for one in todo for other in used.get(one, ())}
    bodies = [entry.value for n, entry in model.quantities.items() if n in todo]
    functions = [function for n, function in model.functions.items() if n in todo]
    bodies += [function.body for function in functions if TIME not in function.arguments]
    whole = [*roots, *bodies]
    if not any(TIME in names_in(root) for root in whole):
        return None
    frequencies: list[Node] = []
    if all(_collected(model, root, frequencies) for root in whole):
        frequency = frequencies[0]
        one = all(other == frequency for other in frequencies)
        if one and not names_in(frequency) & {*model.rates, *model.quantities}:
            line = next(iter(model.rates.values())).line
            two_pi = node("*", number(2.0), name("pi"))
            return Defined(node("/", two_pi, node("call", frequency, value="abs")), line)
    model.notes.append(
        "The model depends on the time t, and no period of that is told: it can be simulated. "
        "To continue it, add a function period(p) to the plugin, and period=period to SYSTEM."
    )
    return None


def _collected(model: Model, root: Node, frequencies: list[Node]) -> bool:
    """Whether the time stands in sines and cosines alone; their frequencies are added to the list."""
    if root.kind == "name":
        return root.value != TIME
    if root.kind == "call" and root.value in _PERIODIC and TIME in names_in(root):
        times = sum(part.kind == "name" and part.value == TIME for part in parts_of(root))
        found = _factor(root.parts[0]) if times == 1 else None
        if found is not None:
            frequencies.append(found)
        return found is not None
    if root.kind == "call" and root.value in model.functions and TIME in names_in(root):
        function = model.functions[str(root.value)]
        given = dict(zip(function.arguments, root.parts, strict=False))  # their number is checked later
        return _collected(model, replaced(function.body, given), frequencies)
    return all(_collected(model, part, frequencies) for part in root.parts)


def _factor(root: Node) -> Node | None:
    """What the time, which stands in an expression once, is multiplied by; None where that is not all."""
    if root.kind == "name":
        return number(1.0)
    inside = [part for part in root.parts if TIME in names_in(part)]
    if len(inside) != 1:
        return None
    found = _factor(inside[0])
    if found is None:
        return None
    one = found == number(1.0)
    if root.kind in ("+", "-", "negative"):
        return found
    other = next((part for part in root.parts if part is not inside[0]), None)
    if root.kind == "*" and other is not None:
        return other if one else node("*", found, other)
    if root.kind == "/" and root.parts[0] is inside[0] and other is not None:
        return node("/", found, other)
    return None
