"""The 3D walker by definition, in many digits: where its bodies are, Kane's equations, and its energy.

Nothing of the plugin's equations enters: bodies are placed by rotation matrices, velocities and
accelerations are differences of places along a motion in 60 digits, which leaves them good to 25.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import mpmath
from mpmath import cos, matrix, mpf, sin

mpmath.mp.dps = 60
STEP = mpf(10) ** -15
LIMBS = ((1, 6, 7), (2, 8, 9))  # leg, index of the angles of its thigh and its knee


def about_axis(axis: int, angle: Any) -> matrix:
    """Rotation about axis 0, 1 or 2."""
    c, s = cos(angle), sin(angle)
    if axis == 0:
        return matrix([[1, 0, 0], [0, c, -s], [0, s, c]])
    if axis == 1:
        return matrix([[c, 0, s], [0, 1, 0], [-s, 0, c]])
    return matrix([[c, -s, 0], [s, c, 0], [0, 0, 1]])


@dataclass(frozen=True)
class Machine:
    """Parameters with legs of their own (`legs: free`), and whether the hips are in gear."""

    p: dict[str, float]
    geared: bool = False

    def point(self, name: str) -> matrix:
        return matrix([mpf(self.p.get(f"{name}_{axis}", 0.0)) for axis in "xyz"])

    def inertia(self, name: str) -> matrix:
        xx, yy, zz, xy, xz, yz = (mpf(self.p[f"I_{name}_{c}"]) for c in ("xx", "yy", "zz", "xy", "xz", "yz"))
        return matrix([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])

    def placed(self, q: list[Any]) -> tuple[dict[str, tuple[matrix, matrix]], dict[str, matrix]]:
        """Bodies (rotation, centre of mass) and toes, in N."""
        v = about_axis(2, q[5]) * about_axis(1, q[4])
        t = matrix(q[:3])
        pitch = (q[6] + q[8]) / 2 if self.geared else q[3]
        torso = v * about_axis(0, pitch)
        bodies = {"torso": (torso, t + torso * self.point("torso"))}
        toes = {}
        for leg, thigh_at, knee_at in LIMBS:
            thigh = v * about_axis(0, q[thigh_at])
            shank = thigh * about_axis(0, q[knee_at])
            hip = t + v * self.point(f"hip{leg}")
            knee = hip + thigh * self.point(f"knee{leg}")
            bodies[f"thigh{leg}"] = thigh, hip + thigh * self.point(f"thigh{leg}")
            bodies[f"shank{leg}"] = shank, knee + shank * self.point(f"shank{leg}")
            for toe in (1, 2):
                toes[f"{leg}{toe}"] = knee + shank * self.point(f"toe{leg}{toe}")
        return bodies, toes

    def q_dot(self, q: list[Any], u: list[Any]) -> list[Any]:
        """Velocity of T and angular velocity of the torso are given along the axes of V."""
        moved = about_axis(2, q[5]) * about_axis(1, q[4]) * matrix(u[:3])
        tangent = sin(q[4]) / cos(q[4])
        return [*moved, u[3] + tangent * u[5], u[4], u[5] / cos(q[4]), *u[6:]]

    def along(self, q: list[Any], q_dot: list[Any], q_dots: list[Any], s: Any) -> list[Any]:
        return [a + s * b + s * s * c / 2 for a, b, c in zip(q, q_dot, q_dots, strict=True)]


def spin(before: matrix, now: matrix, after: matrix) -> matrix:
    """Angular velocity of a rotation, from three instants."""
    w = (after - before) / (2 * STEP) * now.T
    return matrix([w[2, 1] - w[1, 2], w[0, 2] - w[2, 0], w[1, 0] - w[0, 1]]) / 2


def dot(a: matrix, b: matrix) -> Any:
    return sum(x * y for x, y in zip(a, b, strict=True))


def partials(machine: Machine, q: list[Any], u: list[Any]) -> dict[str, tuple[matrix, matrix]]:
    """Velocities of centres and toes, and angular velocities of bodies, at these speeds."""
    q_dot = machine.q_dot(q, u)
    still = [mpf(0)] * 10
    ends = [machine.placed(machine.along(q, q_dot, still, s)) for s in (-STEP, mpf(0), STEP)]
    found = {}
    for name, (rotation, _) in ends[1][0].items():
        speed = (ends[2][0][name][1] - ends[0][0][name][1]) / (2 * STEP)
        found[name] = speed, spin(ends[0][0][name][0], rotation, ends[2][0][name][0])
    for toe in ends[1][1]:
        found[toe] = (ends[2][1][toe] - ends[0][1][toe]) / (2 * STEP), matrix(3, 1)
    return found


def inertia_forces(
    machine: Machine, q: list[Any], u: list[Any], u_dot: list[Any]
) -> dict[str, tuple[matrix, matrix]]:
    """m a and the rate of the angular momentum of each body."""

    def moved(s: Any) -> list[Any]:
        return [a + s * b for a, b in zip(u, u_dot, strict=True)]

    q_dot = machine.q_dot(q, u)
    ahead = machine.q_dot(machine.along(q, q_dot, [mpf(0)] * 10, STEP), moved(STEP))
    behind = machine.q_dot(machine.along(q, q_dot, [mpf(0)] * 10, -STEP), moved(-STEP))
    q_dots = [(a - b) / (2 * STEP) for a, b in zip(ahead, behind, strict=True)]
    bodies = {k: machine.placed(machine.along(q, q_dot, q_dots, k * STEP))[0] for k in (-2, -1, 0, 1, 2)}
    found = {}
    for name in bodies[0]:
        inertia = machine.inertia(name)
        momenta = []
        for k in (-1, 1):
            r = bodies[k][name][0]
            momenta.append(r * inertia * r.T * spin(bodies[k - 1][name][0], r, bodies[k + 1][name][0]))
        acceleration = (bodies[1][name][1] - 2 * bodies[0][name][1] + bodies[-1][name][1]) / STEP**2
        found[name] = mpf(machine.p[f"m_{name}"]) * acceleration, (momenta[1] - momenta[0]) / (2 * STEP)
    return found


def weight(machine: Machine, name: str) -> matrix:
    """Gravity points into the slope, and downhill along axis 3."""
    alpha, g = mpf(machine.p["alpha"]), mpf(machine.p["g"])
    return mpf(machine.p[f"m_{name}"]) * g * matrix([0, -cos(alpha), sin(alpha)])


def toe_forces(machine: Machine, x: list[Any], contact: dict[str, float]) -> dict[str, matrix]:
    """Springs and dampers of the ground (16)."""
    q, anchors, u, p = x[:10], x[10:18], x[18:], {name: mpf(value) for name, value in machine.p.items()}
    toes, speeds, found = machine.placed(q)[1], partials(machine, q, u), {}
    for number, (name, place) in enumerate(toes.items()):
        v, held = speeds[name][0], anchors[2 * number : 2 * number + 2]
        damped = contact.get(f"damped{name}", contact[f"on{name}"]) * p["c_y"]
        damped += contact.get(f"rising{name}", 0) * p.get("c_y_rebound", 0)
        pressed = contact.get(f"pressed{name}", 1)
        found[name] = contact[f"on{name}"] * matrix(
            [
                -p["k_x"] * (place[0] - q[0] - held[0]) - p["c_x"] * v[0],
                -pressed * p["k_y"] * place[1] - damped * v[1],
                -p["k_z"] * (place[2] - q[2] - held[1]) - p["c_z"] * v[2],
            ]
        )
    return found


def torques(machine: Machine, x: list[Any], contact: dict[str, float]) -> dict[str, Any]:
    """About the hip line, on each body: knees in hyperextension and hips, (7) to (10)."""
    q, u, p = x[:10], x[18:], {name: mpf(value) for name, value in machine.p.items()}
    found = dict.fromkeys(("torso", "thigh1", "thigh2", "shank1", "shank2"), mpf(0))
    for leg, thigh_at, knee_at in LIMBS:
        damping = p["c_knee_rebound"] if contact.get(f"rebound{leg}", 0) else p["c_knee"]
        stop = contact[f"stop{leg}"] * (p["k_knee"] * q[knee_at] + damping * u[knee_at])
        found[f"thigh{leg}"] += stop
        found[f"shank{leg}"] -= stop
        if not machine.geared:
            hip = p["c_hip"] * (u[thigh_at] - u[3])
            hip += p.get("k_hip", 0) * (q[thigh_at] - q[3] - p.get("hip_rest", 0))
            found[f"thigh{leg}"] -= hip
            found["torso"] += hip
    return found


def error_of_accelerations(
    machine: Machine, x: list[float], u_dot: list[float], contact: dict[str, float]
) -> list[float]:
    """What Kane's equations leave of these accelerations, as errors of each u'."""
    state, change = [mpf(float(value)) for value in x], [mpf(float(value)) for value in u_dot]
    q, u = state[:10], state[18:]
    free = [j for j in range(10) if not (machine.geared and j == 3)]
    basis = {j: partials(machine, q, [mpf(i == j) for i in range(10)]) for j in free}
    inertia = inertia_forces(machine, q, u, change)
    forces, turning = toe_forces(machine, state, contact), torques(machine, state, contact)
    axis = about_axis(2, q[5]) * about_axis(1, q[4]) * matrix([1, 0, 0])
    tensors = {name: r * machine.inertia(name) * r.T for name, (r, _) in machine.placed(q)[0].items()}
    mass, left = matrix(len(free), len(free)), matrix(len(free), 1)
    for row, i in enumerate(free):
        for name, (ma, h_dot) in inertia.items():
            v, w = basis[i][name]
            left[row] += dot(v, weight(machine, name) - ma) + dot(w, turning[name] * axis - h_dot)
            for column, j in enumerate(free):
                other = basis[j][name]
                mass[row, column] += mpf(machine.p[f"m_{name}"]) * dot(v, other[0])
                mass[row, column] += dot(w, tensors[name] * other[1])
        left[row] += sum(dot(basis[i][toe][0], force) for toe, force in forces.items())
    return [float(value) for value in mpmath.lu_solve(mass, left)]


def energy(machine: Machine, x: list[float]) -> Any:
    """Kinetic energy, and potential energy of gravity."""
    state = [value if isinstance(value, mpf) else mpf(float(value)) for value in x]
    q, u = state[:10], state[18:]
    speeds, (bodies, _) = partials(machine, q, u), machine.placed(q)
    total = mpf(0)
    for name, (rotation, centre) in bodies.items():
        v, w = speeds[name]
        tensor = rotation * machine.inertia(name) * rotation.T
        total += (mpf(machine.p[f"m_{name}"]) * dot(v, v) + dot(w, tensor * w)) / 2
        total -= dot(weight(machine, name), centre)
    return total
