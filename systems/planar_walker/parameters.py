"""Parameters with the defaults of Table I, and the parameter sets of the figures."""

from __future__ import annotations

from contwalk.system import Parameter

TABLE_1 = {
    "m1": 1.013,
    "m2": 2.35,
    "i1": 0.0393,
    "i2": 0.000231,
    "l1": 0.3132,
    "l2": 0.35,
    "l1x": 0.0432,
    "l1y": 0.1663,
    "l2x": 0.0,
    "l2y": 0.091,
    "lf": 0.123,
    "rf": 0.12,
    "g": 9.81,
    "alpha": 0.09,
}

_MEANING = {
    "m1": ("kg", True, "mass of a shank with its foot"),
    "m2": ("kg", True, "mass of a thigh"),
    "i1": ("kg m2", True, "moment of inertia of a shank about its centre of mass"),
    "i2": ("kg m2", True, "moment of inertia of a thigh about its centre of mass"),
    "l1": ("m", True, "from the knee down to the height of the foot's centre, along the shank"),
    "l2": ("m", True, "from the hip to the knee"),
    "l1x": ("m", False, "centre of mass of the shank, forward of the line of the shank"),
    "l1y": ("m", False, "centre of mass of the shank, below the knee"),
    "l2x": ("m", False, "centre of mass of the thigh, forward of the line of the thigh"),
    "l2y": ("m", False, "centre of mass of the thigh, below the hip"),
    "lf": ("m", False, "centre of the circular foot, forward of the line of the shank"),
    "rf": ("m", False, "radius of the foot; negative: its curve opens downwards"),
    "g": ("m/s2", True, "gravity"),
    "alpha": ("rad", False, "inclination of the slope, downhill to the right"),
    "mu": ("1", True, "coefficient of friction that is available at impacts; it does not act on the motion"),
}

PARAMETERS = tuple(
    Parameter(name, default, unit, (0.0 if non_negative else None, None), about)
    for name, default in {**TABLE_1, "mu": 3.0}.items()
    for unit, non_negative, about in (_MEANING[name],)
)

# Figure 6 is the small end of the path of figure 5; figure 4 has the parameters of Table I.
PRESETS = {
    "table1": dict(TABLE_1),
    "fig6": TABLE_1 | {"rf": 0.01, "lf": 0.105},
}
