"""The autobalancer's equations, equilibria and symmetries, against independent derivations and numbers."""

import cmath
import math
from types import SimpleNamespace

import mpmath
import numpy as np
import pytest

from contwalk.errors import StartError, SystemDefinitionError
from contwalk.system import load_system

MASSES = (1, 2, 3, 4, 5)
# Table 1, omega varied: largest real part at types 1 to 4. Verified 40-digit values.
MAX_RE = {
    0.5: (0.001717181705934883, 0.0007818722623557988, -0.0007853403340365154, 0.003356674935544675),
    1.5: (-0.046355093705076636, None, None, 0.0272351916335353),
    2.0: (-0.09716429537930896, 0.09287464791498905, 0.15617575242900988, 0.037335967667490644),
    5.0: (-0.16877281657936394, 0.28415222970668835, 0.5677645480073195, 0.1473677758974358),
}
# Three masses, omega = 5: (m, beta3, delta) -> largest real part without the neutral zero. Verified values.
MAX_RE_THREE = {
    (0.001, 1.0, 0.005): -0.126932548524,
    (0.001, 1.0, 0.0007): 0.009393740339,
    (0.005, math.pi, 0.005): -0.144487005117,
    (0.005, math.pi, 0.0007): -0.003066592332,
    (0.02, math.pi, 0.005): -0.126501696384,
    (0.02, math.pi, 0.0007): 0.009709835387,
    (0.02, 2.5, 0.005): -0.157320130182,
    (0.02, 2.5, 0.0007): -0.010978399525,
}


def machine(n, **values):
    """The system with n masses, and its parameters as a mapping."""
    system = load_system("autobalancer", {"masses": n})
    return system, system.defaults() | values


def rates(system, parameters, x):
    dx = np.full(len(x), np.nan)
    system.modes[0].field(0.0, x, SimpleNamespace(**parameters), dx)
    return dx


def jacobian(system, parameters, x):
    """Five-point differences: error about 1e-12 (h^4 = 1e-12; rounding 1e-16 / h)."""
    h = 1e-3
    columns = []
    for step in h * np.eye(len(x)):
        near = rates(system, parameters, x + step) - rates(system, parameters, x - step)
        far = rates(system, parameters, x + 2 * step) - rates(system, parameters, x - 2 * step)
        columns.append((8 * near - far) / (12 * h))
    return np.column_stack(columns)


def spectrum(system, parameters, x):
    return np.linalg.eigvals(jacobian(system, parameters, x))


def size_of_terms(parameters, n):
    """Magnitude of the terms that cancel in the field at an equilibrium near the unit circle."""
    p = SimpleNamespace(**parameters)
    total = p.M + p.m + n * p.m1
    force = p.omega**2 * (abs(p.m * p.e) + n * p.m1 * p.l1)
    resistance = abs(complex(p.k - p.omega**2 * total, p.c * p.omega))
    return (1.0 + (p.k + p.omega**2 * total + p.c * abs(p.omega)) / resistance) * force / (p.M + p.m)


def random_case(n, seed):
    """A random state with all parameters away from special values."""
    random = np.random.default_rng(seed)
    system = load_system("autobalancer", {"masses": n})
    parameters = {q.name: float(random.uniform(0.3, 1.7)) for q in system.parameters}
    parameters["omega"] = float(random.uniform(-3.0, 3.0))
    parameters["e"] = float(random.uniform(-1.0, 1.0))
    return system, parameters, random.normal(size=2 * n + 4)


class TestEquationsOfMotion:
    @pytest.mark.parametrize("n", MASSES)
    @pytest.mark.parametrize("seed", range(4))
    def test_newtons_law_for_each_body_in_the_inertial_frame(self, n, seed):
        """Bodies one by one, at a time t != 0: no equation of the thesis enters."""
        system, parameters, x = random_case(n, seed)
        p = SimpleNamespace(**parameters)
        dx = rates(system, parameters, x)
        w, turn = p.omega, cmath.exp(1j * p.omega * 0.83)
        q, q_dot, q_ddot = (complex(v[0], v[1]) for v in (x, dx, dx[n + 2 :]))
        z = q * turn
        z_dot = (q_dot + 1j * w * q) * turn
        z_ddot = (q_ddot + 2j * w * q_dot - w**2 * q) * turn
        force = -p.k * z - p.c * z_dot
        change_of_momentum = p.M * z_ddot + p.m * (z_ddot - w**2 * p.e * turn)
        for j in range(n):
            outward = cmath.exp(1j * x[2 + j]) * turn
            speed, acceleration = x[n + 4 + j] + w, dx[n + 4 + j]
            ball = z_ddot + p.l1 * (1j * acceleration - speed**2) * outward
            change_of_momentum += p.m1 * ball
            along_the_ring = (ball * (1j * outward).conjugate()).real
            drag = -(p.delta + p.gamma) * p.l1 * (speed - w)
            # 1e-12: rounding of sums of terms of order 100
            assert p.m1 * along_the_ring + p.J * p.l1 * acceleration == pytest.approx(drag, abs=1e-12)
        assert abs(change_of_momentum - force) < 1e-12

    @pytest.mark.parametrize("n", MASSES)
    def test_corrected_equations_2_to_4(self, n):
        system, parameters, x = random_case(n, 11)
        p = SimpleNamespace(**parameters)
        dx = rates(system, parameters, x)
        wt = p.omega * 0.4
        cos, sin, w = math.cos(wt), math.sin(wt), p.omega
        q1, q2, v1, v2, a1, a2 = x[0], x[1], dx[0], dx[1], dx[n + 2], dx[n + 3]
        x1, x2 = q1 * cos - q2 * sin, q1 * sin + q2 * cos
        u1, u2 = v1 * cos - v2 * sin - w * x2, v1 * sin + v2 * cos + w * x1
        b1 = a1 * cos - a2 * sin - w * (v1 * sin + v2 * cos) - w * u2
        b2 = a1 * sin + a2 * cos + w * (v1 * cos - v2 * sin) + w * u1
        total = p.M + p.m + n * p.m1
        right1, right2 = p.m * p.e * w**2 * cos, p.m * p.e * w**2 * sin
        for j in range(n):
            alpha, rate, acceleration = x[2 + j] + wt, x[n + 4 + j] + w, dx[n + 4 + j]
            right1 += p.m1 * p.l1 * (acceleration * math.sin(alpha) + rate**2 * math.cos(alpha))
            right2 -= p.m1 * p.l1 * (acceleration * math.cos(alpha) - rate**2 * math.sin(alpha))
            left = (p.m1 + p.J) * p.l1 * acceleration + p.l1 * (p.delta + p.gamma) * (rate - w)
            assert left == pytest.approx(p.m1 * (b1 * math.sin(alpha) - b2 * math.cos(alpha)), abs=1e-12)
        assert total * b1 + p.c * u1 + p.k * x1 == pytest.approx(right1, abs=1e-12)
        assert total * b2 + p.c * u2 + p.k * x2 == pytest.approx(right2, abs=1e-12)

    def test_names_are_those_of_the_interface(self):
        system = load_system("autobalancer")
        assert system.state_names == (
            *("q1", "q2", "beta1", "beta2"),
            *("q1_dot", "q2_dot", "beta1_dot", "beta2_dot"),
        )
        assert set(system.parameter_names) == {
            *("M", "k", "c", "m", "e", "m1", "l1", "J", "delta", "gamma", "omega")
        }
        assert system.defaults() == system.presets["table1"]
        assert "angle3" in load_system("autobalancer", {"masses": 3}).parameter_names

    @pytest.mark.parametrize("model", [{"masses": 0}, {"masses": 2.0}, {"suspension": "soft"}, {"balls": 2}])
    def test_other_model_choices_are_refused(self, model):
        with pytest.raises(SystemDefinitionError):
            load_system("autobalancer", model)


class TestEquilibria:
    @pytest.mark.parametrize("n", MASSES)
    @pytest.mark.parametrize("load", [-0.013, -0.004, 0.0, 1e-9, 0.004, 0.0199, 0.03, 0.5])
    @pytest.mark.parametrize("omega", [-5.0, 0.0, 1e-6, 0.5, 0.97, 3.0, 1e4])
    def test_every_start_is_an_equilibrium(self, n, load, omega):
        system, parameters = machine(n, m=abs(load), e=math.copysign(1.0, load), omega=omega)
        p = SimpleNamespace(**parameters)
        # 2 n + 20 roundings of the terms that cancel
        bound = (2 * n + 20) * np.finfo(float).eps * size_of_terms(parameters, n)
        for start in system.starts:
            for x in start.states(p):
                assert np.abs(rates(system, parameters, np.array(x))).max() <= bound, start.name

    @pytest.mark.parametrize("omega", MAX_RE)
    def test_types_1_to_4_have_the_verified_spectra(self, omega):
        system, parameters = machine(2, omega=omega)
        p = SimpleNamespace(**parameters)
        together = system.start("together").states(p) or [None, None]
        found = [*system.start("balanced").states(p), *together, system.start("opposite").states(p)[0]]
        for x, expected in zip(found, MAX_RE[omega], strict=True):
            if expected is None:
                assert x is None
            else:
                # 1e-11: the difference quotient
                assert spectrum(system, parameters, np.array(x)).real.max() == pytest.approx(
                    expected, abs=1e-11
                )

    def test_both_roots_of_type_4_are_the_same_motion(self):
        system, parameters = machine(2)
        one, other = system.named_states("opposite", parameters)
        assert one[:2] == pytest.approx(other[:2], abs=1e-15)
        assert np.mod(one[2:4], 2 * math.pi) == pytest.approx(np.mod(other[3:1:-1], 2 * math.pi), abs=1e-14)
        assert math.tan(one[2]) == pytest.approx(one[1] / one[0], rel=1e-12)

    def test_balanced_state_of_two_masses_is_equation_11_and_12(self):
        for e in (1.0, -1.0):
            system, parameters = machine(2, m=0.0037, e=e)
            (x,) = system.named_states("balanced", parameters)
            aside = math.acos(0.0037 * e / 0.02)
            assert x[2:4] == pytest.approx([math.pi - aside, math.pi + aside], rel=1e-15)

    def test_balanced_angles_near_full_load_keep_their_digits(self):
        capacity = mpmath.mpf(2) * mpmath.mpf(0.01)
        m = 0.02 * (1.0 - 1e-12)
        system, parameters = machine(2, m=m)
        (x,) = system.named_states("balanced", parameters)
        with mpmath.workdps(40):
            aside = float(mpmath.acos(mpmath.mpf(m) / capacity))
        # beta itself is rounded to 4e-16, 3e-10 of the angle 1.4e-6; acos alone would err by 1e-5 of it
        assert 0.5 * (x[3] - x[2]) == pytest.approx(aside, rel=4e-10)

    @pytest.mark.parametrize("shortfall", [-(2.0**-40), 0.0, 2.0**-40])
    def test_roots_where_full_load_and_resonance_are_both_near(self, shortfall):
        """Against 40 digits, with K of the order 1e-6 c omega and the load within 1e-12 of full load."""
        m, k = 0.02 * (1.0 - shortfall), 1.04 + 1.1e-6
        system, parameters = machine(2, m=m, omega=1.0, k=k)
        away, near = (x[2] for x in system.named_states("together", parameters))
        with mpmath.workdps(40):
            stiffness = mpmath.mpf(k) - (1 + mpmath.mpf(m) + 2 * mpmath.mpf(0.01))
            a, b = m * stiffness, m * mpmath.mpf(0.7)
            c = 2 * mpmath.mpf(0.7) * mpmath.mpf(0.01)
            half = mpmath.acos(-c / mpmath.hypot(a, b))
            angle = float(2 * mpmath.pi - 2 * half)
        # The angle between the roots is about 1e-6: beta rounded to 4e-16 and K to 2e-16 leave 1e-9 of it.
        # Without the products of sums and differences it would err by 1e-4 of itself.
        assert abs(math.remainder(near - away, 2 * math.pi)) == pytest.approx(angle, rel=1e-8)

    def test_roots_at_resonance(self):
        """K = 0, where equation A-4 is 0/0: cos(beta) = -2 m1 l1 / (m e)."""
        system, parameters = machine(2, m=0.25, m1=0.0625, k=1.375, omega=1.0)
        away, near = system.named_states("together", parameters)
        assert abs(away[2]) == pytest.approx(math.acos(-0.5), rel=1e-15)
        assert near[2] == pytest.approx(-away[2], rel=1e-15)

    def test_type_2_is_on_the_far_side_of_the_unbalance(self):
        for omega in (0.3, 0.5, 2.0, 5.0, -5.0):
            for e in (1.0, -1.0):
                system, parameters = machine(2, omega=omega, e=e)
                away, near = system.named_states("together", parameters)
                assert e * math.cos(away[2]) < e * math.cos(near[2])

    @pytest.mark.parametrize(
        ("n", "start", "load"),
        [
            (2, "together", 0.00282047183506846),
            (3, "together", 0.00418329923526),
            (3, "opposite", 0.00139827382165),
        ],
    )
    def test_loads_from_which_the_unbalanced_types_exist(self, n, start, load):
        """Verified values; the last two are types 2, 5 and types 3, 4 of figure 24."""
        system, parameters = machine(n, m=load * (1.0 - 1e-9))
        with pytest.raises(StartError, match="exists where"):
            system.named_states(start, parameters)
        x, y = system.named_states(start, parameters | {"m": load * (1.0 + 1e-9)})
        # a fold: the roots part as the square root of the distance, sqrt(2 * 1e-9) each way
        assert abs(x[2] - y[2]) == pytest.approx(2.0 * math.sqrt(2e-9), rel=0.05)

    def test_speeds_between_which_types_2_and_3_are_absent(self):
        system, parameters = machine(2)
        for omega, inside in ((0.5591662709753222, 1.0), (1.7362881790318407, -1.0)):
            assert len(system.named_states("together", parameters | {"omega": omega - inside * 1e-12})) == 2
            with pytest.raises(StartError):
                system.named_states("together", parameters | {"omega": omega + inside * 1e-12})

    def test_the_overloaded_rotor_settles_on_the_far_side(self):
        """Type 5 of figure 24 (three masses) is stable above m = 0.03."""
        for m, unstable in ((0.0299, 2), (0.0301, 0)):
            system, parameters = machine(3, m=m)
            x = system.named_states("together", parameters)[0]
            assert np.sum(spectrum(system, parameters, x).real > 0.0) == unstable

    @pytest.mark.parametrize(
        ("n", "start", "values"),
        [
            (1, "balanced", {"m": 0.0099}),
            (2, "balanced", {"m": 0.0200001}),
            (2, "together", {"omega": 1.0}),
            (2, "together", {"m": 0.0}),
            (2, "opposite", {"c": 0.0, "M": 0.0, "m": 0.25, "m1": 0.375, "omega": 1.0}),
            (3, "balanced", {"m": 0.029, "angle3": 2.5}),
            (4, "opposite_2", {"c": 0.0, "M": 0.0, "m": 0.5, "m1": 0.125, "omega": 1.0}),
        ],
    )
    def test_absent_equilibria_are_refused_in_words(self, n, start, values):
        system, parameters = machine(n, **values)
        with pytest.raises(StartError, match="does not exist at these parameters"):
            system.named_states(start, parameters)

    def test_existence_at_the_edge(self):
        """Full load on paper may exceed the capacity by a rounding: 0.1 * 3 > 2 * 0.15 in floats."""
        system, parameters = machine(2, m=0.1, e=3.0, m1=0.15)
        (x,) = system.named_states("balanced", parameters)
        assert x[2:4] == pytest.approx([math.pi, math.pi], rel=1e-15)
        assert len(machine(2)[0].named_states("balanced", machine(2, m=0.02)[1])) == 1
        system, parameters = machine(3, m=0.03, angle3=math.pi)
        (x,) = system.named_states("balanced", parameters)
        # all three opposite the unbalance; the square root of a rounding remains
        assert x[2:5] == pytest.approx([math.pi] * 3, abs=1e-7)

    def test_default_angles_have_a_balanced_state_for_any_number_of_masses(self):
        for n in range(2, 41):
            system, parameters = machine(n)
            (x,) = system.named_states("balanced", parameters)
            # the sum of n vectors of length 0.01, each rounded
            assert abs(0.01 + 0.01 * np.exp(1j * x[2 : n + 2]).sum()) < n * 1e-16

    def test_counts_of_physically_different_equilibria(self):
        """Section 7.2: five types for three masses, six for four, seven for five."""
        for n, count in ((2, 4), (3, 5), (4, 6), (5, 7)):
            system, parameters = machine(n, m=0.05)
            total = 1
            for start in system.starts[1:]:
                one, other = system.named_states(start.name, parameters)
                # with equal groups the two roots are one motion with names exchanged: the same displacement
                total += 1 if np.allclose(one[:2], other[:2], rtol=0.0, atol=1e-14) else 2
            assert total == count


class TestFamilies:
    @pytest.mark.parametrize(("m", "angle3", "delta"), MAX_RE_THREE)
    def test_three_masses(self, m, angle3, delta):
        system, parameters = machine(3, m=m, angle3=angle3, delta=delta)
        (x,) = system.named_states("balanced", parameters)
        values = spectrum(system, parameters, x)
        zero = np.abs(values).argmin()
        assert abs(values[zero]) < 1e-10  # error of the differences over the next eigenvalue, 0.05
        rest = np.delete(values, zero).real.max()
        assert rest == pytest.approx(MAX_RE_THREE[m, angle3, delta], abs=1e-10)

    @pytest.mark.parametrize("n", [3, 4, 5])
    def test_generators_are_null_vectors_at_balanced_states(self, n):
        system, parameters = machine(n, m=0.007)
        (x,) = system.named_states("balanced", parameters)
        directions = []
        for neutral in system.neutral:
            if neutral.name == "rotation":
                continue
            v = np.full(len(x), np.nan)
            neutral.generator(0.0, x, SimpleNamespace(**parameters), v)
            assert np.abs(jacobian(system, parameters, x) @ v).max() < 1e-11
            assert x[system.state_names.index(neutral.pin)] == parameters[neutral.value]
            directions.append(v)
        assert np.linalg.matrix_rank(np.array(directions), tol=1e-3) == n - 2

    def test_two_masses_have_no_family(self):
        assert [neutral.name for neutral in load_system("autobalancer").neutral] == ["rotation"]

    @pytest.mark.parametrize("n", MASSES)
    def test_rotation_commutes_with_the_field_without_load(self, n):
        system, parameters, x = random_case(n, 5)
        parameters["m"] = 0.0
        v, v_rates = np.empty(len(x)), np.empty(len(x))
        dx = rates(system, parameters, x)
        system.neutral[0].generator(0.0, x, None, v)
        system.neutral[0].generator(0.0, dx, None, v_rates)
        # the generator is affine: 1 for each angle, whose rate it leaves alone
        v_rates[2 : n + 2] = 0.0
        assert jacobian(system, parameters, x) @ v == pytest.approx(v_rates, abs=1e-9)

    def test_mirrored_balanced_states_are_equally_stable(self):
        """Why figure 23 needs beta3 from 0 to pi only, though the mirror is not a symmetry of the motion."""
        for n, angles in ((3, {"angle3": 1.9}), (4, {"angle3": 1.9, "angle4": -0.6})):
            system, parameters = machine(n, m=0.013, **angles)
            (x,) = system.named_states("balanced", parameters)
            mirrored = x.copy()
            mirrored[2 : n + 2] *= -1.0
            one, other = (np.poly(spectrum(system, parameters, y)) for y in (x, mirrored))
            assert one == pytest.approx(other, rel=1e-8, abs=1e-8)  # coefficients reach 1e3

    def test_the_mirror_is_no_symmetry_but_turns_the_rotation_round(self):
        system, parameters, x = random_case(3, 8)
        mirror = np.array([1.0, -1.0, -1.0, -1.0, -1.0] * 2)
        dx = rates(system, parameters, x)
        assert np.abs(rates(system, parameters, mirror * x) - mirror * dx).max() > 0.1
        reversed_speed = parameters | {"omega": -parameters["omega"]}
        assert rates(system, reversed_speed, mirror * x) == pytest.approx(mirror * dx, abs=1e-12)


class TestDeclarations:
    @pytest.mark.parametrize("n", MASSES)
    def test_exchanges_commute_with_the_field(self, n):
        system, parameters, x = random_case(n, 3)
        p = SimpleNamespace(**parameters)
        assert len(system.symmetries) == n - 1
        dx = rates(system, parameters, x)
        for symmetry in system.symmetries:
            image, image_rates = np.full(len(x), np.nan), np.full(len(x), np.nan)
            symmetry.map(0.0, x, p, image)
            symmetry.map(0.0, dx, p, image_rates)
            assert symmetry.role == "relabel"
            assert not np.array_equal(image, x)
            assert np.array_equal(np.sort(image), np.sort(x))
            # the sums over the masses are taken in another order
            assert rates(system, parameters, image) == pytest.approx(image_rates, rel=1e-12, abs=1e-12)

    def test_observables_of_a_known_motion(self):
        system, parameters = machine(2)
        t = np.linspace(0.0, 2.0 * math.pi, 401)
        x = np.zeros((401, 8))
        x[:, 0], x[:, 1] = 3.0 * np.cos(t), 4.0
        x[:, 2], x[:, 3] = 0.2 * np.sin(t), 1.0 + 0.5 * np.sin(t)
        p = SimpleNamespace(**parameters)
        values = {o.name: o.function(t, x, p) for o in system.observables}
        expected = {"amplitude": 5.0, "load_ratio": 0.5, "spread": 0.7, "swing1": 0.2, "swing2": 0.5}
        assert values == pytest.approx(expected, rel=1e-14)

    @pytest.mark.parametrize("n", MASSES)
    def test_observables_take_other_numbers_than_floats(self, n):
        system, parameters = machine(n)
        x = np.array([[mpmath.mpf(i + j + 1) for i in range(2 * n + 4)] for j in range(3)], dtype=object)
        p = SimpleNamespace(**{name: mpmath.mpf(value) for name, value in parameters.items()})
        floats = x.astype(float)
        for observable in system.observables:
            value = observable.function(np.arange(3.0), x, p)
            expected = observable.function(np.arange(3.0), floats, SimpleNamespace(**parameters))
            assert isinstance(value, mpmath.mpf)
            assert float(value) == pytest.approx(expected, rel=1e-14)

    def test_presets(self):
        system = load_system("autobalancer")
        heavy = system.presets["heavy"]
        # the leading pair of figure 15, verified value
        for delta, expected in ((0.0065, -0.006469991569955258), (0.0045, 0.024013631168053877)):
            parameters = system.defaults() | heavy | {"delta": delta}
            (x,) = system.named_states("balanced", parameters)
            assert spectrum(system, parameters, x).real.max() == pytest.approx(expected, abs=1e-10)
        for name in ("fig7", "fig9", "table2_system1", "table2_system2", "table2_system3", "fig13_line2"):
            preset = system.presets[name]
            assert 2.0 * preset["m1"] * preset["l1"] == pytest.approx(0.02)
            assert set(preset) == set(system.parameter_names)

    @pytest.mark.parametrize(
        ("preset", "values"),
        [
            ("table1", {"omega": 1.0272112844508665}),
            ("fig7", {"omega": 1.1731082782322222}),
            ("fig9", {"m": 0.011337791365353785}),
            ("fig9", {"m": 0.016452532824960685}),
            ("heavy", {"delta": 0.0060721205237529744}),
        ],
    )
    def test_presets_have_their_verified_hopf_points(self, preset, values):
        system = load_system("autobalancer")
        parameters = system.defaults() | system.presets[preset] | values
        (x,) = system.named_states("balanced", parameters)
        leading = max(spectrum(system, parameters, x), key=lambda value: value.real)
        # 1e-11: the difference quotient
        assert abs(leading.real) < 1e-11
        assert abs(leading.imag) > 0.01

    @pytest.mark.parametrize("n", MASSES)
    def test_drawing(self, n):
        from matplotlib.figure import Figure

        system, parameters = machine(n, m=0.05)
        p = SimpleNamespace(**parameters)
        for start in system.starts:
            for x in start.states(p):
                axes = Figure().subplots()
                system.draw(axes, 0.0, np.array(x), p)
                words = {text.get_text() for text in axes.texts}
                assert {"A", "B", "m"} <= words
                assert any(word.startswith("displacement AB") for word in words)
                numbers = [int(i) for word in words if word[:1].isdigit() for i in word.split(", ")]
                assert sorted(numbers) == list(range(1, n + 1))
                axes.figure.draw_without_rendering()
