"""Orbits of stiff fields, of fields that end, of rotors that wind, and of all but neutral machines."""

import math

import numpy as np
import pytest
from small_orbits import WALKING, orbits
from small_systems import labelled, small_system

import contwalk as cw
from contwalk.continuation.settings import Settings
from contwalk.errors import StartError
from contwalk.studies.opening_orbits import opened_orbit
from contwalk.system import State, load_system

ACCURACY = 1e-8


class TestStiffness:
    """A cycle with a direction that relaxes 1e7 times as fast as it turns."""

    @staticmethod
    def field(t, x, p, dx):
        square = x[0] ** 2 + x[1] ** 2
        dx[0] = p.mu * x[0] - x[1] - x[0] * square
        dx[1] = x[0] + p.mu * x[1] - x[1] * square
        dx[2] = -p.stiffness * (x[2] - x[0] ** 2)

    @pytest.mark.drawn(1)
    @pytest.mark.parametrize("method", ["auto", "radau5", "radau9"])
    def test_1e7(self, method):
        problem = orbits(self.field, "xyz", {"mu": 1.0, "stiffness": 1e7}, "mu", ACCURACY, method)
        branch = cw.continue_branch(problem, [1.0, 0.0, 1.0], (0.8, 1.2), period=6.28)
        assert branch.outcome.reason == "bound"
        tolerance = 10.0 * WALKING * ACCURACY  # local errors of some tens of steps add up
        assert branch["period"] == pytest.approx(2.0 * math.pi, rel=tolerance)
        multipliers = branch.points["spectrum"]
        # A state that is off the slow manifold by a rounding has another velocity than the flow there. Where
        # that spoils a multiplier, its stored error says so.
        known = np.maximum(tolerance, branch["spectrum_error"])
        assert np.all(np.abs(multipliers[:, 0] - np.exp(-4.0 * math.pi * branch["mu"])) <= known)
        assert np.all(np.abs(multipliers[:, 1]) <= known)  # exp(-6e7)
        assert np.all(branch["unstable"] == 0)
        # An explicit method needs 1e7 steps a period or so, of a dozen evaluations.
        assert branch.cost["rhs"] < 1e7


class TestBlowUp:
    """r' = mu r + r^3 outside of its unstable cycle: infinite in finite time."""

    @staticmethod
    def field(t, x, p, dx):
        square = x[0] ** 2 + x[1] ** 2
        dx[0] = p.mu * x[0] - x[1] + x[0] * square
        dx[1] = x[0] + p.mu * x[1] + x[1] * square

    @pytest.mark.parametrize("given", [{"period": 6.28}, {"until": "settled"}, {"until": 3.0}])
    def test_at_the_start(self, given):
        problem = orbits(self.field, "xy", {"mu": -1.0}, "mu")
        outcome = opened_orbit(
            problem.system,
            problem.parameters,
            "mu",
            np.array([2.0, 0.0]),
            Settings(),
            discretization=problem.discretization,
            **given,
        )
        assert (outcome.status, outcome.reason) == ("failed", "not_finite")
        assert outcome.message.endswith(".")
        with pytest.raises(StartError, match=r"ends|without bound|not finite"):
            cw.continue_branch(problem, [2.0, 0.0], (-2.0, -0.5), **given)

    def test_an_unstable_cycle_beside_it_is_found(self):
        problem = orbits(self.field, "xy", {"mu": -1.0}, "mu")
        branch = cw.continue_branch(problem, [1.0, 0.0], (-1.5, -0.5), period=6.28)
        assert branch.outcome.reason == "bound"
        assert np.all(branch["unstable"] == 1)
        assert branch.points["spectrum"][:, 0] == pytest.approx(
            np.exp(-4.0 * math.pi * branch["mu"]), rel=WALKING * ACCURACY
        )

    def test_along_a_branch_at_the_edge_of_the_field(self):
        """log(1.2 - x) ends the cycle when its radius is 1.2."""

        def field(t, x, p, dx):
            square = x[0] ** 2 + x[1] ** 2
            dx[0] = p.mu * x[0] - x[1] - x[0] * square
            dx[1] = x[0] + p.mu * x[1] - x[1] * square
            dx[2] = -x[2] + math.log(1.2 - x[0])

        problem = orbits(field, "xyz", {"mu": 1.0}, "mu")
        branch = cw.continue_branch(problem, [1.0, 0.0, 0.0], (0.5, 3.0), period=6.28)
        assert (branch.outcome.status, branch.outcome.reason) == ("failed", "not_finite")
        assert "last good point" in branch.outcome.message
        assert branch.outcome.message.endswith(".")
        assert branch["mu"].max() == pytest.approx(1.44, rel=1e-3)
        assert branch["mu"].max() < 1.44
        assert branch["mu"].min() == 0.5

    def test_along_a_branch_that_outgrows_floating_point(self):
        """z = exp(200 mu) passes the largest number at mu = 3.55."""

        def field(t, x, p, dx):
            square = x[0] ** 2 + x[1] ** 2
            dx[0] = p.mu * x[0] - x[1] - x[0] * square
            dx[1] = x[0] + p.mu * x[1] - x[1] * square
            dx[2] = math.exp(200.0 * p.mu) - x[2]

        problem = orbits(field, "xyz", {"mu": 1.0}, "mu")
        branch = cw.continue_branch(problem, [1.0, 0.0, math.exp(200.0)], (0.9, 5.0), period=6.28)
        assert branch.outcome.reason in ("not_finite", "step_too_small"), branch.outcome
        assert branch.outcome.status == "failed"
        assert np.all(np.isfinite(branch.points["state"]))
        assert branch["mu"].max() < math.log(np.finfo(float).max) / 200.0


class TestWinding:
    """Pendulums that turn over: their angle grows by whole turns from one closure to the next."""

    @staticmethod
    def pendulum(t, x, p, dx):
        dx[0] = x[1]
        dx[1] = -p.d * x[1] - math.sin(x[0]) + p.i

    @pytest.mark.drawn(1)
    @pytest.mark.parametrize("given", [{"period": 1.6}, {"until": "settled"}])
    def test_a_driven_pendulum(self, given):
        states = [State("phi", period=2.0 * math.pi), State("v")]
        problem = orbits(self.pendulum, states, {"d": 0.5, "i": 2.0}, "i")
        branch = cw.continue_branch(problem, [0.0, 4.0], (0.7, 3.0), **given)
        assert branch.outcome.reason == "bound"
        assert np.all(branch["unstable"] == 0)
        # Liouville: the product of the multipliers, one of them 1, is exp(-d T). Energy: d T <v^2> = 2 pi i.
        true = np.exp(-0.5 * branch["period"])
        assert np.all(np.abs(branch.points["spectrum"][:, 0] - true) <= WALKING * ACCURACY)
        mean = 2.0 * math.pi / branch["period"]
        assert np.all(mean <= branch["i"] / 0.5)  # <v> <= sqrt(<v^2>)
        assert np.all(mean >= 0.5 * branch["i"] / 0.5)

    @pytest.mark.long
    def test_backwards(self):
        states = [State("phi", period=2.0 * math.pi), State("v")]
        problem = orbits(self.pendulum, states, {"d": 0.5, "i": -2.0}, "i")
        branch = cw.continue_branch(problem, [0.0, -4.0], (-3.0, -1.0), period=1.6)
        forward = orbits(self.pendulum, states, {"d": 0.5, "i": 2.0}, "i")
        other = cw.continue_branch(forward, [0.0, 4.0], (1.0, 3.0), period=1.6)
        assert branch.outcome.reason == other.outcome.reason == "bound"
        ends = sorted([branch["period"][0], branch["period"][-1]])
        assert ends == pytest.approx(
            sorted([other["period"][0], other["period"][-1]]), rel=WALKING * ACCURACY
        )

    @pytest.mark.long
    def test_an_angle_that_is_far_from_zero_is_as_good(self):
        states = [State("phi", period=2.0 * math.pi), State("v")]
        problem = orbits(self.pendulum, states, {"d": 0.5, "i": 2.0}, "i")
        far = cw.continue_branch(problem, [2e4 * math.pi, 4.0], (1.9, 2.1), period=1.6)
        near = cw.continue_branch(problem, [0.0, 4.0], (1.9, 2.1), period=1.6)
        assert far["period"][[0, -1]] == pytest.approx(near["period"][[0, -1]], rel=WALKING * ACCURACY)

    @pytest.mark.drawn(1)
    @pytest.mark.parametrize(("speed", "turns"), [(2.0, 1), (-4.0, -2)])
    def test_a_forced_rotor(self, speed, turns):
        """In the frame that turns with the force it is a pendulum at rest."""

        def field(t, x, p, dx):
            dx[0] = x[1]
            dx[1] = -p.d * (x[1] - speed) - p.e * math.sin(x[0] - turns * p.w * t)

        states = [State("phi", period=2.0 * math.pi), State("v")]
        parameters = {"d": 0.5, "e": 1.0, "w": 2.0}
        problem = orbits(field, states, parameters, "e", period=lambda p: 2.0 * math.pi / p.w)
        start = [0.0, 2.0 * turns]  # phi = turns w t solves the equations: v = speed there
        branch = cw.continue_branch(problem, start, (0.2, 4.0))
        assert branch.outcome.reason == "bound"
        assert np.all(np.abs(branch["phi"]) <= WALKING * ACCURACY)
        assert branch["v"] == pytest.approx(speed, rel=WALKING * ACCURACY)
        # y'' = -d y' - e y around it: multipliers exp(lambda pi), lambda^2 + d lambda + e = 0.
        for k in range(len(branch)):
            rates = np.roots([1.0, 0.5, branch["e"][k]])
            true = np.poly(np.exp(rates * math.pi))
            assert np.poly(branch.points["spectrum"][k]) == pytest.approx(true, abs=WALKING * ACCURACY)
        assert np.all(branch["unstable"] == 0)

    def test_a_start_that_does_not_close_is_refused_with_a_sentence(self):
        """Without the declared angle the rotation does not close."""
        problem = orbits(self.pendulum, ["phi", "v"], {"d": 0.5, "i": 2.0}, "i")
        with pytest.raises(StartError) as caught:
            cw.continue_branch(problem, [0.0, 4.0], (0.7, 3.0), until="settled")
        assert str(caught.value).endswith(".")


class TestNeutral:
    """The autobalancer with a load of nearly nothing turns freely round it: rates of -2551 m^2.

    At m = 1e-7 a multiplier is one but for 3e-11; below, the orbit is one of a family to rounding.
    """

    @pytest.mark.long
    @pytest.mark.parametrize("preset", ["fig20", "fig21"])
    def test_a_vanishing_load_of_the_anisotropic_machine(self, preset):
        system = load_system("autobalancer", {"masses": 2, "suspension": "anisotropic"})
        values = system.defaults() | system.presets[preset] | {"m": 1e-4}
        problem = cw.PeriodicOrbit(system, values, "m")
        branch = cw.continue_branch(problem, "balanced", (1e-7, 1e-4))
        assert branch.outcome.reason == "bound"
        assert branch["m"].min() == 1e-7
        assert labelled(branch, "LP", "BP", "PD", "NS") == []
        # max_abs is that of a whole turn; 1 - max_abs = rate m^2, until it drowns in what is known of it.
        rate = (1.0 - branch["max_abs"]) / branch["m"] ** 2
        known = 10.0 * branch["spectrum_error"] / branch["m"] ** 2
        top = rate[np.argmax(branch["m"])]
        assert top > 0.0
        assert np.all(np.abs(rate - top) <= 1e-2 * top + known)
        assert np.all(branch["unstable"] == branch["unstable"][0])

    def test_the_isotropic_machine_seen_as_an_equilibrium_has_no_spurious_cycles(self):
        system = load_system("autobalancer", {"masses": 2})
        values = system.defaults() | system.presets["heavy"] | {"m": 1e-9, "omega": 5.0, "delta": 0.0065}
        problem = cw.Equilibrium(system, values, "delta")
        branch = cw.continue_branch(problem, "balanced", (1e-4, 0.02))
        assert branch.outcome.reason == "bound"
        assert labelled(branch, "LP", "BP", "HB") == []


def test_a_field_that_is_zero_everywhere_has_no_orbit():
    def field(t, x, p, dx):
        dx[0] = 0.0 * x[0]
        dx[1] = 0.0 * x[1]

    system = small_system(field, "xy", {"mu": 1.0})
    problem = cw.PeriodicOrbit(system, system.defaults(), "mu")
    with pytest.raises(StartError) as caught:
        cw.continue_branch(problem, [1.0, 0.0], (0.5, 1.5), period=1.0)
    assert str(caught.value).endswith(".")
    # A simulation comes to rest at once; each state is what it is, and is held there.
    resting = cw.continue_branch(problem, [1.0, 0.0], (0.5, 1.5), until="settled")
    assert (resting.info.problem, resting.outcome.status) == ("equilibrium", "complete")
    assert "came to rest at an equilibrium" in resting.outcome.message
    assert "Conserved, and not declared: x; y." in resting.outcome.message
    assert np.array_equal(resting["x"], np.ones(len(resting)))
