"""Parameters with the defaults of Tables 1 and 3, and the parameter sets that the study uses."""

from __future__ import annotations

from collections.abc import Mapping

from contwalk.system import Parameter

_BOTH = {
    "m": 0.01,
    "e": 1.0,
    "m1": 0.01,
    "l1": 1.0,
    "J": 0.004,
    "delta": 0.005,
    "gamma": 0.0,
    "omega": 5.0,
}
TABLE_1 = {"M": 1.0, "k": 1.0, "c": 0.7, **_BOTH}
TABLE_3 = {"M": 1.0, "k1": 1.0, "k2": 0.5, "c1": 0.7, "c2": 0.35, **_BOTH}
STIFF = {"k2": 100.0, "c2": 0.7}
HEAVY_BALLS = {"m1": 0.05, "l1": 0.2, "J": 0.02, "delta": 0.04}

_MEANING = {
    "M": ("M", True, "mass of the rotor and of all that is fixed to it, its centre at B"),
    "k": ("k", True, "stiffness of the suspension"),
    "c": ("sqrt(k M)", True, "damping of the suspension (external damping)"),
    "k1": ("k", True, "stiffness of the suspension along the first direction (of x1)"),
    "k2": ("k", True, "stiffness of the suspension along the second direction (of x2), across the first"),
    "c1": ("sqrt(k M)", True, "damping of the suspension along the first direction (external damping)"),
    "c2": ("sqrt(k M)", True, "damping of the suspension along the second direction (external damping)"),
    "m": ("M", True, "mass of the unbalanced part: the load is m e"),
    "e": ("l1", False, "eccentricity BC of the unbalanced part; negative: on the other side"),
    "m1": ("M", True, "mass of each correction mass"),
    "l1": ("l1", True, "distance of the correction masses from the ring's centre B; not zero"),
    "J": ("M", True, "I / r^2 of each correction mass, which rolls; m1 + J is not zero"),
    "delta": ("sqrt(k M)", True, "drag of each correction mass in the ring (internal damping)"),
    "gamma": ("sqrt(k M)", True, "rolling resistance of each correction mass, gamma / r^2; adds to delta"),
    "omega": ("sqrt(k/M)", False, "speed of rotation"),
}


def make_parameters(n: int, table: Mapping[str, float]) -> tuple[Parameter, ...]:
    """The parameters of a table; from the third mass on each has an angle that selects a balanced state."""
    physical = (
        Parameter(name, default, unit, (0.0 if non_negative else None, None), about)
        for name, default in table.items()
        for unit, non_negative, about in (_MEANING[name],)
    )
    held = (
        Parameter(
            f"angle{i}",
            # Spread over the ring: for every n the balanced state exists at the default load.
            round(2.5 + 2.4 * (i - 3), 1),
            "rad",
            about=f"angle at which mass {i} is held: selects a member of the family of balanced states",
        )
        for i in range(3, n + 1)
    )
    return (*physical, *held)


def make_isotropic_presets(n: int) -> dict[str, dict[str, float]]:
    """Named parameter sets of the isotropic suspension, after the tables and figures of the thesis."""
    presets = {
        "table1": TABLE_1,
        "fig7": TABLE_1 | {"c": 0.1},
        "fig9": TABLE_1 | {"c": 2.7, "delta": 0.002},
        "heavy": TABLE_1 | {"m1": 0.02, "l1": 0.5, "J": 0.008, "m": 0.014, "c": 2.0},
        "fig13_line2": TABLE_1 | HEAVY_BALLS,
        "table2_system1": TABLE_1 | {"c": 1.8, "delta": 0.003},
        "table2_system2": TABLE_1,
        "table2_system3": TABLE_1 | HEAVY_BALLS,
    }
    if n >= 3:
        presets["fig25"] = TABLE_1 | {"delta": 0.0007}
    return {name: dict(values) for name, values in presets.items()}


def make_anisotropic_presets() -> dict[str, dict[str, float]]:
    """Named parameter sets of the anisotropic suspension; figures 18 and 20 are those of Table 3."""
    presets = {
        "table3": TABLE_3,
        "fig18": TABLE_3,
        "fig19": TABLE_3 | STIFF | {"m": 0.014},
        "fig20": TABLE_3,
        "fig21": TABLE_3 | STIFF,
    }
    return {name: dict(values) for name, values in presets.items()}
