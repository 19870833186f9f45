"""Double pendulum whose lower bob strikes a wall, in mass-matrix form, and by equations solved by hand.

M(q) q'' = f(t, q, q') from Lagrange's equations of two point masses on massless rods, angles from the
vertical. The wall is at x = wall; an impact changes velocities by M(q) (q'+ - q'-) = n(q) L with n = dx/dq,
and the impulse L turns the bob's normal speed n . q' into -r times itself.
"""

import numpy as np
from peers.form import SHOOTING, Peer, Study, Value

from contwalk.system import Mode, Parameter, State, System, Transition


def mass(q, p):
    coupling = p.m2 * p.l1 * p.l2 * np.cos(q[0] - q[1])
    return np.array([[(p.m1 + p.m2) * p.l1**2, coupling], [coupling, p.m2 * p.l2**2]])


def forces(t, q, v, p):
    twist = p.m2 * p.l1 * p.l2 * np.sin(q[0] - q[1])
    drive = p.torque * np.cos(p.omega * t)
    return np.array(
        [
            drive - twist * v[1] ** 2 - (p.m1 + p.m2) * p.g * p.l1 * np.sin(q[0]) - p.c * v[0],
            twist * v[0] ** 2 - p.m2 * p.g * p.l2 * np.sin(q[1]) - p.c * v[1],
        ]
    )


def field(t, x, p, dx):
    q, v = x[:2], x[2:]
    dx[:2] = v
    dx[2:] = np.linalg.solve(mass(q, p), forces(t, q, v, p))


def clearance(t, x, p):
    return p.wall - p.l1 * np.sin(x[0]) - p.l2 * np.sin(x[1])


def strike(t, x, p, x_plus):
    q, v = x[:2], x[2:]
    normal = np.array([p.l1 * np.cos(q[0]), p.l2 * np.cos(q[1])])
    turned = np.linalg.solve(mass(q, p), normal)
    x_plus[:2] = q
    x_plus[2:] = v - (1.0 + p.r) * (normal @ v) / (normal @ turned) * turned


def field_by_hand(t, x, p, dx):
    """Cramer's rule: the determinant is m2 l1^2 l2^2 (m1 + m2 sin^2(q1 - q2))."""
    s, c = np.sin(x[0] - x[1]), np.cos(x[0] - x[1])
    both = p.m1 + p.m2
    first = (
        p.torque * np.cos(p.omega * t)
        - p.m2 * p.l1 * p.l2 * s * x[3] ** 2
        - both * p.g * p.l1 * np.sin(x[0])
        - p.c * x[2]
    )
    second = p.m2 * p.l1 * p.l2 * s * x[2] ** 2 - p.m2 * p.g * p.l2 * np.sin(x[1]) - p.c * x[3]
    determinant = p.m2 * p.l1**2 * p.l2**2 * (p.m1 + p.m2 * s**2)
    dx[0], dx[1] = x[2], x[3]
    dx[2] = (p.m2 * p.l2**2 * first - p.m2 * p.l1 * p.l2 * c * second) / determinant
    dx[3] = (both * p.l1**2 * second - p.m2 * p.l1 * p.l2 * c * first) / determinant


def strike_by_hand(t, x, p, x_plus):
    """M^-1 n by Cramer's rule; its determinant cancels."""
    c = np.cos(x[0] - x[1])
    first, second = p.l1 * np.cos(x[0]), p.l2 * np.cos(x[1])
    one = p.m2 * p.l2**2 * first - p.m2 * p.l1 * p.l2 * c * second
    two = (p.m1 + p.m2) * p.l1**2 * second - p.m2 * p.l1 * p.l2 * c * first
    share = (1.0 + p.r) * (first * x[2] + second * x[3]) / (first * one + second * two)
    x_plus[0], x_plus[1] = x[0], x[1]
    x_plus[2], x_plus[3] = x[2] - share * one, x[3] - share * two


def machine(name, moving, striking):
    return System(
        name=name,
        states=(
            State("q1", unit="rad"),
            State("q2", unit="rad"),
            State("v1", unit="rad/s"),
            State("v2", unit="rad/s"),
        ),
        parameters=(
            Parameter("torque", 8.0, unit="N m"),
            Parameter("omega", 3.0, unit="rad/s"),
            Parameter("wall", 0.6, unit="m"),
            Parameter("r", 0.8),
            Parameter("m1", 1.0, unit="kg"),
            Parameter("m2", 1.0, unit="kg"),
            Parameter("l1", 1.0, unit="m"),
            Parameter("l2", 1.0, unit="m"),
            Parameter("g", 9.81, unit="m/s2"),
            Parameter("c", 0.5, unit="N m s"),
        ),
        modes=(Mode("free", moving),),
        transitions=(Transition("strike", "free", "free", clearance, reset=striking),),
        period=lambda p: 2.0 * np.pi / p.omega,
        reference="Lagrange's equations; point masses on massless rods",
    )


SYSTEM = machine("double_pendulum", field, strike)
BY_HAND = machine("double_pendulum_by_hand", field_by_hand, strike_by_hand)

PEER = Peer(
    "Double pendulum with a wall, mass matrix",
    SYSTEM.reference,
    (
        Study(
            "",
            {
                "start": {
                    "simulate": {
                        "state": {"q1": 0.1, "q2": 0.1, "v1": 0.0, "v2": 0.0},
                        "until": "settled",
                    }
                },
                "continue": {"parameter": "torque", "range": [3.0, 14.0]},
                "diagram": {"follow": "none"},
            },
            values=(
                Value("LP", 8.4204435598750, 1e-12, SHOOTING, of="orbit"),
                Value("PD", 5.0250576827534, 1e-12, SHOOTING, of="orbit"),
                Value("LP", 4.0739517138049, 1e-12, SHOOTING, of="orbit"),
            ),
        ),
    ),
)
