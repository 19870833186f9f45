"""Random machines with their studies, one a seed: what they are made of, as data that can be shrunk."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
from random_recipe import Recipe
from random_terms import Factor, Term, factors, linear, number
from random_wide import WIDE

# From this seed on machines are drawn of wide ranges and equal units, one of each kind in turn.
FIRST_WIDE = 100_000


def _state(values: np.ndarray | list[float]) -> str:
    return "{" + ", ".join(f"x{i}: {round(float(v), 3)}" for i, v in enumerate(values)) + "}"


def _parametrised(rng: np.random.Generator, terms: list[list[Term]]) -> None:
    """`lam` takes part in one to three terms, `mu` in some others."""
    for which, count in (("p.lam", int(rng.integers(1, 4))), ("p.mu", int(rng.integers(0, 3)))):
        for _ in range(count):
            i = int(rng.integers(len(terms)))
            k = int(rng.integers(len(terms[i])))
            term = terms[i][k]
            if not term.more:
                terms[i][k] = Term(term.coefficient, term.factors, (which,))


def _bounded(rng: np.random.Generator, terms: list[list[Term]]) -> None:
    """A cubic that keeps most states from growing without bound."""
    for i, row in enumerate(terms):
        if rng.random() < 0.85:
            row.append(Term(-round(float(rng.uniform(0.2, 1.2)), 2), (Factor("power", i, 3),)))


def _values(rng: np.random.Generator) -> dict[str, float]:
    return {"lam": round(float(rng.uniform(-0.3, 0.3)), 2), "mu": round(float(rng.uniform(0.3, 1.5)), 2)}


def _smooth_terms(rng: np.random.Generator, states: int, kind: str) -> list[list[Term]]:
    terms = linear(rng, states, damping=float(rng.uniform(0.1, 0.8)), density=min(0.8, 2.2 / states))
    for row in terms:
        row += [Term(number(rng), factors(rng, states, kind)) for _ in range(int(rng.integers(1, 3)))]
    _bounded(rng, terms)
    if rng.random() < 0.5:  # a pair that turns, so that Hopf points are no rarity
        turn = round(float(rng.uniform(0.5, 2.0)), 2)
        terms[0].append(Term(-turn, (Factor("power", 1, 1),)))
        terms[1].append(Term(turn, (Factor("power", 0, 1),)))
    if rng.random() < 0.7:  # growth that crosses damping
        for i in range(int(rng.integers(1, states + 1))):
            terms[i].append(Term(1.0, (Factor("power", i, 1),), ("p.lam",)))
    return terms


def _size(rng: np.random.Generator) -> int:
    """Two to six states, the small ones more often."""
    return int(rng.choice([2, 3, 4, 5, 6], p=[0.3, 0.3, 0.2, 0.1, 0.1]))


def _modes(terms: list[list[Term]]) -> dict[str, tuple[tuple[Term, ...], ...]]:
    return {"flow": tuple(tuple(row) for row in terms)}


def _of_equilibria(rng: np.random.Generator, seed: int, kind: str) -> Recipe:
    """From the origin, an equilibrium for every parameter; or from a random point made one by constants."""
    states = _size(rng)
    terms, values = _smooth_terms(rng, states, kind), _values(rng)
    _parametrised(rng, terms)
    x = np.zeros(states)
    if kind == "trigonometric" or rng.random() < 0.6:
        x = rng.uniform(-0.8, 0.8, states)
        for row in terms:
            here = sum(_value(term, x, values) for term in row)
            row.append(Term(round(-here, 6)))
    return Recipe(seed, kind, states, values, _modes(terms), "{state: " + _state(x) + "}", (-1.2, 1.8))


def _value(term: Term, x: np.ndarray, values: Mapping[str, float]) -> float:
    product = term.coefficient
    for name in term.more:
        product *= values[name.removeprefix("p.")]
    for f in term.factors:
        product *= {
            "power": lambda v, k: v**k,
            "sin": lambda v, k: np.sin(k * v),
            "cos": lambda v, k: np.cos(k * v),
        }[f.kind](x[f.state], f.number)
    return float(product)


def _polynomial(rng: np.random.Generator, seed: int) -> Recipe:
    return _of_equilibria(rng, seed, "polynomial")


def _trigonometric(rng: np.random.Generator, seed: int) -> Recipe:
    return _of_equilibria(rng, seed, "trigonometric")


def _mirrored(rng: np.random.Generator, terms: list[list[Term]], turned: frozenset[int]) -> list[list[Term]]:
    """Only the terms that a change of sign of some states allows."""
    return [[t for t in row if t.odd_in(turned) == (i in turned)] for i, row in enumerate(terms)]


def _symmetric(rng: np.random.Generator, seed: int) -> Recipe:
    """A declared inversion or mirror of some states, or two halves that may be exchanged."""
    kind = ("inversion", "mirror", "exchange")[int(rng.integers(3))]
    states = _size(rng) if kind != "exchange" else int(rng.choice([2, 4, 6], p=[0.4, 0.5, 0.1]))
    smooth = ("polynomial", "trigonometric")[int(rng.integers(2))]
    terms, values = _smooth_terms(rng, states, smooth), _values(rng)
    if kind == "exchange":
        half = states // 2
        terms = terms[:half]
        _parametrised(rng, terms)
        places = {i: (i + half) % states for i in range(states)}
        terms += [[term.moved(places) for term in row] for row in terms[:half]]
        body = [f"x_image[{i}] = x[{places[i]}]" for i in range(states)]
        x = np.zeros(states)
    else:
        count = states if kind == "inversion" else int(rng.integers(1, states))
        turned = frozenset(range(states - count, states))
        terms = _mirrored(rng, terms, turned)
        _parametrised(rng, terms)
        body = [f"x_image[{i}] = {'-' if i in turned else ''}x[{i}]" for i in range(states)]
        x = np.zeros(states)
    for row in terms:  # cosines are not zero at the origin
        here = sum(_value(term, x, values) for term in row)
        if here:
            row.append(Term(round(-here, 6)))
    return Recipe(
        seed,
        "symmetric",
        states,
        values,
        _modes(terms),
        "{state: " + _state(x) + "}",
        (-1.2, 1.8),
        functions={"image": ("t, x, p, x_image", tuple(body))},
        declared=('symmetries=(Symmetry("image", "spatial", image),)',),
    )


def _forced(rng: np.random.Generator, seed: int) -> Recipe:
    """A damped machine that is driven; from the origin or from where a simulation settles."""
    states = int(rng.choice([2, 3, 4], p=[0.6, 0.3, 0.1]))
    smooth = ("polynomial", "trigonometric")[int(rng.integers(2))]
    terms = linear(rng, states, damping=float(rng.uniform(0.2, 0.7)), density=0.7)
    for row in terms:
        row.append(Term(number(rng, 0.1, 0.8), factors(rng, states, smooth)))
    _bounded(rng, terms)
    values = _values(rng) | {"force": round(float(rng.uniform(0.05, 0.5)), 2)}
    values["omega"] = round(float(rng.uniform(0.7, 2.5)), 2)
    free = ("lam", "force")[int(rng.integers(2))]
    _parametrised(rng, terms)
    terms[int(rng.integers(states))].append(Term(1.0, (), ("p.force", "cos(p.omega*t)")))
    state = _state(np.zeros(states))
    start = "{state: " + state + "}" if rng.random() < 0.5 else "{simulate: {state: " + state + "}}"
    return Recipe(
        seed,
        "forced",
        states,
        values,
        _modes(terms),
        start,
        (-0.8, 1.2) if free == "lam" else (0.0, 1.5),
        free=free,
        functions={"period": ("p", ("return 2.0*pi/p.omega",))},
        declared=("period=period",),
        depth=1,
        max_points=100,
    )


def _fire(rng: np.random.Generator, seed: int) -> Recipe:
    """A first state that is driven up to a threshold and set back there, with others that it disturbs."""
    states = int(rng.choice([2, 3], p=[0.7, 0.3]))
    terms = linear(rng, states, damping=float(rng.uniform(0.2, 0.6)), density=0.6)
    for row in terms[1:]:
        row.append(Term(number(rng, 0.1, 0.5), factors(rng, states, "trigonometric")))
    _bounded(rng, terms)
    terms[0].append(Term(1.0, (), ("p.lam",)))
    terms[0].append(Term(round(float(rng.uniform(0.1, 0.4)), 2), (Factor("power", 0, 2),)))
    body = ["x_plus[0] = p.mu"]
    body += [
        f"x_plus[{i}] = {round(float(rng.uniform(0.3, 1.0)), 2)}*x[{i}] + {number(rng, 0.05, 0.4)}*x[0]"
        for i in range(1, states)
    ]
    values = {"lam": round(float(rng.uniform(1.5, 2.5)), 2), "mu": round(float(rng.uniform(-0.5, 0.4)), 2)}
    return Recipe(
        seed,
        "fire",
        states,
        values,
        _modes(terms),
        "{simulate: {state: " + _state(np.zeros(states)) + ", until: settled}}",
        (0.8, 3.5),
        functions={"level": ("t, x, p", ("return 1.0 - x[0]",)), "back": ("t, x, p, x_plus", tuple(body))},
        declared=('transitions=(Transition("fires", "flow", "flow", level, reset=back),)',),
        depth=1,
        max_points=100,
    )


def _impact(rng: np.random.Generator, seed: int) -> Recipe:
    """A driven oscillator that may hit a wall; at times with a third state that lags behind it."""
    states = 2 if rng.random() < 0.7 else 3
    terms = [
        [Term(1.0, (Factor("power", 1, 1),))],
        [
            Term(-1.0, (Factor("power", 0, 1),)),
            Term(-round(float(rng.uniform(0.05, 0.4)), 2), (Factor("power", 1, 1),)),
            Term(number(rng, 0.05, 0.5), factors(rng, 2, "trigonometric")),
            Term(-round(float(rng.uniform(0.05, 0.4)), 2), (Factor("power", 0, 3),)),
            Term(1.0, (), ("p.lam", "cos(p.omega*t)")),
        ],
    ]
    if states == 3:
        terms[1].append(Term(number(rng, 0.1, 0.5), (Factor("power", 2, 1),)))
        terms.append([Term(-0.7, (Factor("power", 2, 1),)), Term(number(rng), (Factor("power", 0, 1),))])
    values = {
        "lam": round(float(rng.uniform(0.4, 1.2)), 2),
        "omega": round(float(rng.uniform(0.6, 2.4)), 2),
        "gap": round(float(rng.uniform(0.2, 0.8)), 2),
        "rebound": round(float(rng.uniform(0.3, 0.9)), 2),
    }
    body = ["x_plus[0] = x[0]", "x_plus[1] = -p.rebound*x[1]", *["x_plus[2] = x[2]"] * (states - 2)]
    return Recipe(
        seed,
        "impact",
        states,
        values,
        _modes(terms),
        "{simulate: {state: " + _state(np.zeros(states)) + ", until: settled}}",
        (0.05, 1.8),
        functions={
            "period": ("p", ("return 2.0*pi/p.omega",)),
            "clearance": ("t, x, p", ("return p.gap - x[0]",)),
            "rebounds": ("t, x, p, x_plus", tuple(body)),
        },
        declared=(
            "period=period",
            'transitions=(Transition("hits", "flow", "flow", clearance, reset=rebounds),)',
        ),
        depth=1,
        max_points=100,
    )


def _relay(rng: np.random.Generator, seed: int) -> Recipe:
    """Two modes that switch at two levels of a state; at times each the image of the other."""
    states = int(rng.choice([2, 3]))
    terms = linear(rng, states, damping=float(rng.uniform(0.3, 0.8)), density=0.6)
    for row in terms:
        row.append(Term(number(rng, 0.05, 0.3), factors(rng, states, "polynomial")))
    _bounded(rng, terms)
    mirrored = rng.random() < 0.5
    if mirrored:
        terms = _mirrored(rng, terms, frozenset(range(states)))
    push = round(float(rng.uniform(0.8, 1.6)), 2)
    low = push if mirrored else round(float(rng.uniform(0.8, 1.6)), 2)
    up, down = [list(row) for row in terms], [list(row) for row in terms]
    up[0].append(Term(push, (), ("p.lam",)))
    down[0].append(Term(-low, (), ("p.lam",)))
    if rng.random() < 0.5:
        kick = round(float(rng.uniform(0.1, 0.5)), 2)
        resets = {
            name: (
                "t, x, p, x_plus",
                ("x_plus[0] = x[0]", f"x_plus[1] = x[1] {sign} {kick}", *["x_plus[2] = x[2]"] * (states - 2)),
            )
            for name, sign in (("kick_down", "-"), ("kick_up", "+"))
        }
    else:
        resets = {}
    given = [f", reset={name}" for name in resets] or ["", ""]
    declared = [
        f'transitions=(Transition("off", "up", "down", top{given[0]}), '
        f'Transition("on", "down", "up", bottom{given[1]}))'
    ]
    functions: dict[str, tuple[str, tuple[str, ...]]] = {
        "top": ("t, x, p", ("return p.mu - x[0]",)),
        "bottom": ("t, x, p", ("return p.mu + x[0]",)),
        **resets,
    }
    if mirrored:
        functions["image"] = ("t, x, p, x_image", tuple(f"x_image[{i}] = -x[{i}]" for i in range(states)))
        declared.append(
            'symmetries=(Symmetry("image", "spatial", image, modes={"up": "down", "down": "up"}, '
            'events={"off": "on", "on": "off"}),)'
        )
    values = {"lam": 1.0, "mu": round(float(rng.uniform(0.1, 0.5)), 2)}
    return Recipe(
        seed,
        "relay",
        states,
        values,
        {"up": tuple(tuple(r) for r in up), "down": tuple(tuple(r) for r in down)},
        "{simulate: {state: " + _state(np.zeros(states)) + ", until: settled}}",
        (0.5, 2.0),
        functions=functions,
        declared=tuple(declared),
        depth=1,
        max_points=100,
    )


_FAMILIES: dict[str, tuple[float, Callable[[np.random.Generator, int], Recipe]]] = {
    "polynomial": (0.30, _polynomial),
    "trigonometric": (0.18, _trigonometric),
    "symmetric": (0.22, _symmetric),
    "forced": (0.12, _forced),
    "fire": (0.06, _fire),
    "impact": (0.06, _impact),
    "relay": (0.06, _relay),
}


def recipe(seed: int) -> Recipe:
    """The machine and study of a seed."""
    if seed >= FIRST_WIDE:
        return list(WIDE.values())[seed % len(WIDE)](np.random.default_rng([20261129, seed]), seed)
    rng = np.random.default_rng([20260704, seed])
    names = list(_FAMILIES)
    family = str(rng.choice(names, p=[_FAMILIES[name][0] for name in names]))
    return _FAMILIES[family][1](rng, seed)
