"""The anisotropic autobalancer: declarations, the isotropic limit, and the stability of Figs 18 to 21."""

from __future__ import annotations

import cmath
import math
from types import SimpleNamespace

import numpy as np
import pytest
from floquet import flow_derivative, half_turn_map, jacobians, traced_field

from contwalk.errors import StartError
from contwalk.plugin_check.system import check_system
from contwalk.plugin_check.traced import Traced, vector_form
from contwalk.system import load_system

MASSES = (1, 2, 3, 4)
BORDER_18 = 0.762189588363
BORDERS_19 = (1.014111890084, 6.997815226291, 12.618218030748)
# Verified values: (preset, what differs) -> angle of the critical multiplier of a whole turn, where known.
NEIMARK_SACKER = {
    ("fig18", "omega", BORDER_18): 0.104432,
    ("fig19", "omega", BORDERS_19[0]): None,
    ("fig19", "omega", BORDERS_19[1]): None,
    ("fig19", "omega", BORDERS_19[2]): None,
    ("fig20", "delta", 0.00061734842): None,
    ("fig21", "delta", 0.0007621117719): None,
}


def machine(n=2, preset="table3", **values):
    system = load_system("autobalancer", {"masses": n, "suspension": "anisotropic"})
    return system, system.defaults() | system.presets[preset] | values


def rates(system, parameters, t, x):
    dx = np.full(len(x), np.nan)
    system.modes[0].field(t, x, SimpleNamespace(**parameters), dx)
    return dx


def half_turn_multipliers(system, parameters):
    (x,) = system.named_states("balanced", parameters)
    values = np.linalg.eigvals(half_turn_map(system, parameters, x))
    return values[np.argsort(-np.abs(values))]


def random_case(n, seed, **values):
    random = np.random.default_rng(seed)
    system = load_system("autobalancer", {"masses": n, "suspension": "anisotropic"})
    parameters = {q.name: float(random.uniform(0.3, 1.7)) for q in system.parameters}
    parameters["omega"] = float(random.uniform(-3.0, 3.0))
    return system, parameters | values, float(random.uniform(0.0, 5.0)), random.normal(size=2 * n + 4)


class TestDeclarations:
    def test_names_are_those_of_the_interface(self):
        system, parameters = machine()
        assert system.state_names == (
            *("x1", "x2", "beta1", "beta2"),
            *("x1_dot", "x2_dot", "beta1_dot", "beta2_dot"),
        )
        names = ("M", "k1", "k2", "c1", "c2", "m", "e", "m1", "l1", "J", "delta", "gamma", "omega")
        assert system.parameter_names == names
        assert parameters == system.defaults()
        assert [start.name for start in system.starts] == ["balanced"]
        assert "angle3" in machine(3)[0].parameter_names

    @pytest.mark.parametrize("n", MASSES)
    def test_the_plugin_check_finds_nothing(self, n):
        """Symmetries, the period, the constant solution: the default check varies one choice at a time."""
        findings = check_system(machine(n)[0])
        assert [finding for finding in findings if finding.level != "ok"] == []

    @pytest.mark.parametrize("omega", [5.0, -5.0])
    def test_the_period_is_a_turn_and_no_less(self, omega):
        system, parameters = machine(omega=omega)
        x = np.random.default_rng(1).normal(size=8)
        turn = system.period(SimpleNamespace(**parameters))
        assert turn == pytest.approx(2.0 * math.pi / 5.0, rel=1e-15)
        now = rates(system, parameters, 0.3, x)
        # 1e-12: rounding of terms of order 25 at an angle rounded to 1e-15
        assert rates(system, parameters, 0.3 + turn, x) == pytest.approx(now, abs=1e-12)
        assert np.abs(rates(system, parameters, 0.3 + turn / 2, x) - now).max() > 0.1

    @pytest.mark.parametrize("n", MASSES)
    def test_half_a_turn_later_the_mirrored_motion_is_one(self, n):
        """Equations 41 to 43."""
        system, parameters, t, x = random_case(n, 2)
        mirror = np.array([-1.0, -1.0, *[1.0] * n] * 2)
        later = t + 0.5 * system.period(SimpleNamespace(**parameters))
        image = rates(system, parameters, later, mirror * x)
        assert image == pytest.approx(mirror * rates(system, parameters, t, x), abs=1e-12)
        assert np.abs(rates(system, parameters, t, mirror * x) - image).max() > 0.1

    @pytest.mark.parametrize("n", MASSES)
    def test_without_load_time_may_begin_anywhere(self, n):
        """[d/dt + f, v] = 0 for the direction v declared neutral, at any state; not with a load."""
        residual = {}
        for m in (0.0, 0.4):
            system, parameters, t, x = random_case(n, 3, m=m)
            values = list(parameters.values())
            (rotation,) = [neutral for neutral in system.neutral if neutral.name == "rotation"]
            v = Traced(rotation.generator, system, vector_form(system, "generator", "v"))
            slope, f = v.slopes(t, x, values), rates(system, parameters, t, x)
            transported = slope[:, 0] + slope[:, 1:] @ f
            pushed = traced_field(system).slopes(t, x, values)[:, 1:] @ v.values(t, x, values)
            residual[m] = np.abs(transported - pushed).max()
        assert residual[0.0] < 1e-11
        assert residual[0.4] > 1e-2

    def test_presets_are_those_of_the_thesis(self):
        system = machine()[0]
        table_3 = {"M": 1.0, "k1": 1.0, "c1": 0.7, "k2": 0.5, "c2": 0.35, "m": 0.01, "e": 1.0, "m1": 0.01}
        table_3 |= {"J": 0.004, "l1": 1.0, "delta": 0.005, "gamma": 0.0, "omega": 5.0}
        stiff = {"k2": 100.0, "c2": 0.7}
        assert system.presets == {
            "table3": table_3,
            "fig18": table_3,
            "fig19": table_3 | stiff | {"m": 0.014},
            "fig20": table_3,
            "fig21": table_3 | stiff,
        }

    def test_no_balanced_state_beyond_full_load(self):
        system, parameters = machine(m=0.0201)
        with pytest.raises(StartError, match="2 m1 l1"):
            system.named_states("balanced", parameters)

    def test_drawing_turns_with_the_rotor(self):
        from matplotlib.figure import Figure

        system, parameters = machine(omega=2.0)
        x = np.array([0.01, 0.0, 0.3, 2.0, 0.0, 0.0, 0.0, 0.0])
        middles = {}
        for t in (0.0, 0.45):
            axes = Figure().subplots()
            system.draw(axes, t, x, SimpleNamespace(**parameters))
            ball = next(patch for patch in axes.patches if patch.get_alpha() == 0.75)
            low, high = (f(ball.get_xy(), axis=0) for f in (np.min, np.max))
            middles[t] = complex(*(0.5 * (low + high)))
            axes.figure.draw_without_rendering()
            centre = axes.lines[-1].get_xdata()[0]
        assert centre == 0.1  # the factor depends on parameters: the same at both times
        # a polygon of 181 corners stands for the ball
        for t, angle in ((0.0, 0.3), (0.45, 1.2)):
            assert middles[t] == pytest.approx(centre + cmath.exp(1j * angle), abs=1e-3)


class TestIsotropicLimit:
    @pytest.mark.parametrize("n", MASSES)
    @pytest.mark.parametrize("seed", range(3))
    def test_same_motion_seen_from_the_rotor(self, n, seed):
        """x = exp(i omega t) q with its first and second derivatives."""
        system, parameters, t, x = random_case(n, seed)
        isotropic = load_system("autobalancer", {"masses": n})
        parameters |= {"k2": parameters["k1"], "c2": parameters["c1"]}
        same = parameters | {"k": parameters["k1"], "c": parameters["c1"]}
        p = SimpleNamespace(**{name: same[name] for name in isotropic.parameter_names})
        w, back = p.omega, cmath.exp(-1j * p.omega * t)
        q = complex(x[0], x[1]) * back
        q_dot = complex(x[n + 2], x[n + 3]) * back - 1j * w * q
        y = np.array([q.real, q.imag, *x[2 : n + 2], q_dot.real, q_dot.imag, *x[n + 4 :]])
        dy = np.full(len(y), np.nan)
        isotropic.modes[0].field(t, y, p, dy)
        dx = rates(system, parameters, t, x)
        seen = complex(dx[n + 2], dx[n + 3]) * back - 2j * w * q_dot + w**2 * q
        # 1e-12: rounding of terms of order 100
        assert complex(dy[n + 2], dy[n + 3]) == pytest.approx(seen, abs=1e-12)
        assert dy[n + 4 :] == pytest.approx(dx[n + 4 :], abs=1e-12)
        assert complex(dy[0], dy[1]) == pytest.approx(q_dot, abs=1e-14)

    @pytest.mark.parametrize("omega", [0.8, 2.0, 5.0])
    def test_multipliers_are_those_of_the_eigenvalues(self, omega):
        """Of half a turn up to the symmetry, which is the turn of the frame: exp(lambda pi / omega)."""
        system, parameters = machine(k2=1.0, c2=0.7, m=0.014, omega=omega)
        isotropic = load_system("autobalancer")
        same = isotropic.defaults() | {"m": 0.014, "omega": omega}
        (y,) = isotropic.named_states("balanced", same)
        eigenvalues = np.linalg.eigvals(jacobians(isotropic, same, [0.0], y)[0])
        expected = np.poly(np.exp(eigenvalues * math.pi / omega))
        # coefficients of the polynomials, whose roots need no matching; they reach 10
        assert np.poly(half_turn_multipliers(system, parameters)) == pytest.approx(expected, abs=1e-11)


class TestStability:
    @pytest.mark.parametrize("case", NEIMARK_SACKER)
    def test_borders_are_neimark_sacker_points(self, case):
        """A pair of complex multipliers on the unit circle, all others inside; verified values."""
        preset, name, value = case
        system, parameters = machine(preset=preset)
        if preset in ("fig20", "fig21"):
            parameters["m"] = 0.014
        values = half_turn_multipliers(system, parameters | {name: value})
        moduli = np.abs(values)
        # the last digit of the borders, 5e-13 or 5e-15 for delta, times the slope of the modulus, at most 100
        assert moduli[:2] == pytest.approx([1.0, 1.0], abs=2e-11)
        assert moduli[2] < 0.99
        assert abs(values[0].imag) > 0.01
        if NEIMARK_SACKER[case] is not None:
            angle = abs(cmath.phase(values[0] ** 2))
            assert angle == pytest.approx(NEIMARK_SACKER[case], abs=5e-7)
        # at the borders in omega it depends on the side, see below; with less drag the masses swing
        if name == "delta":
            for factor, stable in ((0.99, False), (1.01, True)):
                leading = half_turn_multipliers(system, parameters | {name: factor * value})[0]
                assert (abs(leading) < 1.0) == stable

    @pytest.mark.parametrize(
        ("preset", "omega", "stable"),
        [
            ("fig18", 0.1, False),
            ("fig18", BORDER_18 * (1 - 1e-9), False),
            ("fig18", BORDER_18 * (1 + 1e-9), True),
            *(("fig18", omega, True) for omega in (1.0, 1.5, 2.0, 4.0, 7.0)),
            ("fig19", BORDERS_19[0] * (1 - 1e-9), False),
            ("fig19", BORDERS_19[0] * (1 + 1e-9), True),
            ("fig19", 3.5, True),
            ("fig19", BORDERS_19[1] * (1 - 1e-9), True),
            ("fig19", BORDERS_19[1] * (1 + 1e-9), False),
            ("fig19", 10.0, False),
            ("fig19", BORDERS_19[2] * (1 - 1e-9), False),
            ("fig19", BORDERS_19[2] * (1 + 1e-9), True),
            ("fig19", 20.0, True),
        ],
    )
    def test_speeds_at_which_the_balancer_works(self, preset, omega, stable):
        leading = half_turn_multipliers(*machine(preset=preset, omega=omega))[0]
        assert (abs(leading) < 1.0) == stable

    @pytest.mark.parametrize(
        ("preset", "m", "max_abs"),
        [("fig20", 0.01413984, 0.8378744), ("fig21", 0.01414093, 0.84460288)],
    )
    def test_local_maxima_of_figs_20_and_21(self, preset, m, max_abs):
        """Per turn: the square of the half turn's. Verified values."""
        h = 1e-5
        moduli = []
        for step in (-h, 0.0, h):
            moduli.append(abs(half_turn_multipliers(*machine(preset=preset, m=m + step))[0]) ** 2)
        left, here, right = moduli
        assert here == pytest.approx(max_abs, abs=5e-9 if preset == "fig21" else 5e-8)
        # the top of the parabola through three points; its third-order error is h^2, and m has eight digits
        top = m + 0.5 * h * (left - right) / (left - 2 * here + right)
        assert top == pytest.approx(m, abs=1e-8)
        assert here > max(left, right)

    def test_a_whole_turn_is_two_half_turns(self):
        system, parameters = machine(m=0.014, omega=1.3)
        (x,) = system.named_states("balanced", parameters)
        half = half_turn_map(system, parameters, x)
        whole = flow_derivative(system, parameters, x, system.period(SimpleNamespace(**parameters)))
        assert whole == pytest.approx(half @ half, abs=1e-12)

    def test_at_full_load_a_multiplier_is_one(self):
        """The masses meet there, and part the other way round: the pitchfork of the isotropic balancer."""
        system, parameters = machine(m=0.02)
        (x,) = system.named_states("balanced", parameters)
        # sums of rounded terms; the eigenvalue is simple
        assert np.abs(np.linalg.eigvals(half_turn_map(system, parameters, x)) - 1.0).min() < 1e-12

    def test_three_masses_have_a_family_of_balanced_states(self):
        system, parameters = machine(3, preset="fig20", m=0.013, angle3=2.1)
        (x,) = system.named_states("balanced", parameters)
        (family,) = [neutral for neutral in system.neutral if neutral.name == "family3"]
        v = np.full(10, np.nan)
        family.generator(0.0, x, None, v)
        matrix = half_turn_map(system, parameters, x)
        assert matrix @ v == pytest.approx(v, abs=1e-12)
        others = sorted(np.abs(np.linalg.eigvals(matrix)))[:-1]
        assert others[-1] < 0.95
