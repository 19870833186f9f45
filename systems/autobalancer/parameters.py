"""Parameters with the defaults of Table 1, and the parameter sets that the study uses."""

from __future__ import annotations

from contwalk.system import Parameter

TABLE_1 = {
    "M": 1.0,
    "k": 1.0,
    "c": 0.7,
    "m": 0.01,
    "e": 1.0,
    "m1": 0.01,
    "l1": 1.0,
    "J": 0.004,
    "delta": 0.005,
    "gamma": 0.0,
    "omega": 5.0,
}
HEAVY_BALLS = {"m1": 0.05, "l1": 0.2, "J": 0.02, "delta": 0.04}

_MEANING = {
    "M": ("M", True, "mass of the rotor and of all that is fixed to it, its centre at B"),
    "k": ("k", True, "stiffness of the suspension"),
    "c": ("sqrt(k M)", True, "damping of the suspension (external damping)"),
    "m": ("M", True, "mass of the unbalanced part: the load is m e"),
    "e": ("l1", False, "eccentricity BC of the unbalanced part; negative: on the other side"),
    "m1": ("M", True, "mass of each correction mass"),
    "l1": ("l1", True, "distance of the correction masses from the ring's centre B; not zero"),
    "J": ("M", True, "I / r^2 of each correction mass, which rolls; m1 + J is not zero"),
    "delta": ("sqrt(k M)", True, "drag of each correction mass in the ring (internal damping)"),
    "gamma": ("sqrt(k M)", True, "rolling resistance of each correction mass, gamma / r^2; adds to delta"),
    "omega": ("sqrt(k/M)", False, "speed of rotation"),
}


def make_parameters(n: int) -> tuple[Parameter, ...]:
    """The parameters for n masses; from the third mass on each has an angle that selects a balanced state."""
    physical = (
        Parameter(name, TABLE_1[name], unit, (0.0 if non_negative else None, None), about)
        for name, (unit, non_negative, about) in _MEANING.items()
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


def make_presets(n: int) -> dict[str, dict[str, float]]:
    """Named parameter sets, after the tables and figures of the thesis."""
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
