"""Parameters with the defaults of Paper 7, Table V, and the parameter sets of the studies."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from contwalk.system import Parameter

from .model import BALANCED, CLIPPED, LOCKED, MIRRORED, REBOUND, SPRUNG, Model

COMPONENTS = ("xx", "yy", "zz", "xy", "xz", "yz")


def _body(name: str, mass: float, centre: tuple[float, ...], moments: tuple[float, ...]) -> dict[str, float]:
    """Mass, centre of mass and inertia of a body; its products of inertia are zero in both tables."""
    return {
        f"m_{name}": mass,
        **{f"{name}_{axis}": value for axis, value in zip("xyz", centre, strict=True)},
        **{f"I_{name}_{c}": value for c, value in zip(COMPONENTS, (*moments, 0.0, 0.0, 0.0), strict=True)},
    }


# Paper 7, Table V. Its hips have the wrong sign: leg 1 is on the side of positive x.
OVERLAP = {
    **_body("torso", 0.8, (0.0, 0.0, 0.0), (2.0, 2.018, 2.4)),
    **_body("thigh", 2.354, (0.0, -0.091, 0.0), (0.008, 0.001, 0.01)),
    **_body("shank", 1.013, (0.0, -0.1663, 0.0432), (0.0393, 0.001, 0.01)),
    "hip_x": 0.1,
    "knee_y": -0.35,
    "toe_outer_x": 0.0,
    "toe_outer_y": -0.3132,
    "toe_outer_z": 0.105,
    "toe_inner_x": -0.15,
    "toe_inner_y": -0.3132,
    "toe_inner_z": 0.105,
    "k_knee": 500.0,
    "c_knee": 20.0,
    "c_hip": 0.04,
    "k_x": 5000.0,
    "k_y": 5000.0,
    "k_z": 5000.0,
    "c_x": 500.0,
    "c_y": 500.0,
    "c_z": 500.0,
    "alpha": 0.08,
    "g": 9.81,
}
# Paper 8, appendix 6.1; the hips, printed as 0.1295, are at 29/224.
NO_OVERLAP = {
    **_body("torso", 5.0, (0.0, 0.0, 0.0), (0.3, 0.3, 0.3)),
    **_body("thigh", 2.2, (0.0, -0.14, 0.0), (0.02, 0.001, 0.01)),
    **_body("shank", 1.013, (0.0, -0.08, 0.0432), (0.012, 0.001, 0.01)),
    "hip_x": 29.0 / 224.0,
    "knee_y": -0.35,
    "toe_outer_x": -0.016,
    "toe_outer_y": -0.3164,
    "toe_outer_z": 0.105,
    "toe_inner_x": -0.102,
    "toe_inner_y": -0.3174,
    "toe_inner_z": 0.105,
    "k_knee": 100.0,
    "c_knee": 1.0,
    "c_hip": 0.04,
    "k_x": 6000.0,
    "k_y": 13000.0,
    "k_z": 6000.0,
    "c_x": 500.0,
    "c_y": 770.0,
    "c_z": 500.0,
    "alpha": 0.08,
    "g": 9.81,
}
# Paper 8, figure 9: the walker whose feet overlap, with a torso of equal moments of inertia.
FIGURE_9 = OVERLAP | {"I_torso_yy": 2.0, "I_torso_zz": 2.0}
TABLES = {"overlap": OVERLAP, "figure9": FIGURE_9, "no_overlap": NO_OVERLAP}

_OF_A_LEG = ("thigh", "shank", "hip_", "knee_y", "toe_")
_ODD = ("_x", "_xy", "_xz")  # what changes its sign in a mirror across the hip line
_LOPSIDED = tuple(f"{torso}{odd}" for torso, odd in (("torso", "_x"), ("I_torso", "_xy"), ("I_torso", "_xz")))


def make_parameters(model: Model) -> tuple[Parameter, ...]:
    """The parameters of a machine, with the defaults of the walker whose feet overlap."""
    return tuple(Parameter(name, value, *_meaning(name)) for name, value in _values(OVERLAP, model).items())


def make_presets(model: Model) -> dict[str, dict[str, float]]:
    """The parameter sets of the studies."""
    return {name: _values(table, model) for name, table in TABLES.items()}


def _values(table: Mapping[str, float], model: Model) -> dict[str, float]:
    """Values of a table by the names that a machine gives its parameters."""
    return dict(pair for name, value in table.items() for pair in _named(name, value, table, model))


def _named(name: str, value: float, table: Mapping[str, float], model: Model) -> Iterator[tuple[str, float]]:
    if model.torso == BALANCED and name.startswith(("torso_", "I_torso_")):
        if name == "I_torso_xx":
            yield "I_torso", value
    elif (model.legs == MIRRORED and name in _LOPSIDED) or (model.hip == LOCKED and name == "c_hip"):
        return
    elif model.legs == MIRRORED or not any(part in name for part in _OF_A_LEG) or name == "c_hip":
        yield name, value
    else:
        for leg in (1, 2):
            mirrored = leg == 2 and name.endswith(_ODD)
            yield _of_leg(name, leg), -value if mirrored and value else value
    if name == "c_knee" and model.knee_damper == REBOUND:
        yield "c_knee_rebound", value
    if name == "c_y" and model.ground_damper == CLIPPED:
        yield "c_y_rebound", value
    if name == "c_hip" and model.hip == SPRUNG:
        yield "k_hip", 0.0
        yield "hip_rest", 0.0


def _of_leg(name: str, leg: int) -> str:
    """Name of a parameter of one leg: `m_thigh` -> `m_thigh1`, `toe_inner_x` -> `toe12_x`."""
    for part, number in (("toe_outer", f"toe{leg}1"), ("toe_inner", f"toe{leg}2")):
        if name.startswith(part):
            return name.replace(part, number)
    for part in ("thigh", "shank", "hip", "knee"):
        if part in name:
            return name.replace(part, f"{part}{leg}")
    raise ValueError(name)


_WORDS = {"torso": "torso", "thigh": "thigh", "shank": "shank"}
_AXES = {"x": "along the hip line", "y": "along axis 2", "z": "along axis 3, forwards"}
_WAYS = {"x": "to the side", "y": "away from the slope", "z": "downhill"}
_MEANING = {
    "alpha": ("rad", (None, None), "inclination of the slope"),
    "g": ("m/s2", (0.0, None), "gravity"),
    "k_knee": ("N m/rad", (0.0, None), "stiffness of a knee in hyperextension"),
    "c_knee": ("N m s/rad", (0.0, None), "damping of a knee in hyperextension"),
    "c_knee_rebound": (
        "N m s/rad",
        (0.0, None),
        "damping of a knee that moves off its stop: with none it is a stop, with much it sticks",
    ),
    "c_y_rebound": ("N s/m", (0.0, None), "damping of the ground of a toe that moves out of it"),
    "c_hip": ("N m s/rad", (0.0, None), "damping between torso and each thigh"),
    "k_hip": ("N m/rad", (0.0, None), "stiffness between torso and each thigh"),
    "hip_rest": ("rad", (None, None), "angle of a thigh from the torso where its hip spring rests"),
    "I_torso": ("kg m2", (0.0, None), "moment of inertia of the torso about any axis through T"),
}


def _meaning(name: str) -> tuple[str, tuple[float | None, float | None], str]:
    """Unit, bounds and meaning of a parameter."""
    if name in _MEANING:
        return _MEANING[name]
    kind, _, rest = name.partition("_")
    if kind == "m":
        return "kg", (0.0, None), f"mass of {_body_words(rest)}"
    if kind == "I":
        body, _, component = rest.partition("_")
        bounds = (0.0, None) if component[0] == component[1] else (None, None)
        words = f"component {component} of the inertia of {_body_words(body)} about its centre of mass"
        return "kg m2", bounds, words
    if kind == "k":
        return "N/m", (0.0, None), f"stiffness of the ground {_WAYS[rest]}"
    if kind == "c":
        return "N s/m", (0.0, None), f"damping of the ground {_WAYS[rest]}"
    return "m", (None, None), _place_words(kind, rest)


def _body_words(body: str) -> str:
    number = body.lstrip("abcdefghijklmnopqrstuvwxyz")
    word = body.removesuffix(number)
    if number:
        return f"{word} {number}"
    return "the torso" if word == "torso" else f"a {word}"


def _place_words(kind: str, rest: str) -> str:
    """Meaning of a coordinate of a point."""
    word = kind.rstrip("12")
    number = kind.removeprefix(word)
    which, _, axis = rest.rpartition("_")
    # Of mirrored legs the coordinates are those of leg 1, which is on the side of positive x.
    outwards = not number and word != "torso"
    direction = "along the hip line, outwards" if outwards and axis == "x" else _AXES[axis]
    if word == "toe":
        toe = f"toe {number}" if number else f"the {which} toe"
        return f"{toe} from its knee, {direction}"
    if word == "hip":
        return f"hip joint{_numbered(number)} from T, {direction}"
    if word == "knee":
        return f"knee joint{_numbered(number)} from its hip joint, {direction}"
    origin = {"torso": "T", "thigh": "the hip joint", "shank": "the knee joint"}[word]
    return f"centre of mass of {_body_words(kind)} from {origin}, {direction}"


def _numbered(number: str) -> str:
    return f" {number}" if number else ""
