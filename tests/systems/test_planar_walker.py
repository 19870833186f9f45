"""The planar walker's equations and impacts against a derivation, and its gait against verified numbers."""

from __future__ import annotations

import importlib.util
import json
import math
from functools import cache
from pathlib import Path
from types import ModuleType, SimpleNamespace

import mpmath
import numpy as np
import pytest
from contwalk_systems.planar_walker import SYSTEM, impacts, three_link, two_link
from contwalk_systems.planar_walker.observables import rolled
from hybrid_motion import Phase, after, dips, joined, parameters, phases, vector
from matplotlib.figure import Figure

from contwalk.plugin_check.traced import Traced, number_form, vector_form

ROOT = Path(__file__).resolve().parents[2]
REFERENCE = json.loads((ROOT / "tests/thesis/planar_walker_reference.json").read_text(encoding="utf-8"))
GAIT = REFERENCE["table1_gait"]
EVENTS = {event["label"]: event for event in REFERENCE["slope"]["events"]}
FIGURE_5 = REFERENCE["figure5"]["points"]
TRANSITIONS = {transition.name: transition for transition in SYSTEM.transitions}
CONDITIONS = {condition.name: condition for condition in SYSTEM.conditions}
OBSERVABLES = {observable.name: observable for observable in SYSTEM.observables}
LEGS = SYSTEM.symmetries[0]
# The motions are integrated to 1e-12, and the gait's own error is multiplied by up to 50 in a step.
NEAR = 1e-9


@cache
def derivation() -> ModuleType:
    """The derivation in `tools/`, which is no package."""
    file = ROOT / "tools/derive_planar_walker.py"
    specification = importlib.util.spec_from_file_location(file.stem, file)
    module = importlib.util.module_from_spec(specification)
    specification.loader.exec_module(module)
    return module


def before_heel_strike(x3, p) -> np.ndarray:
    """The state just before heel strike of x = (q1, u1, u2): both feet are on the ground."""
    q1, u1, u2 = (float(value) for value in x3)
    return np.array([q1, -q1 - 2.0 * math.atan(p.lf / (p.l1 + p.l2)), 0.0, 0.0, u1, u2, 0.0])


def step(x3, **values) -> tuple[SimpleNamespace, np.ndarray, list[Phase]]:
    """One step from just before heel strike to just before the next: parameters, first state, phases."""
    p = parameters(SYSTEM, **values)
    start = before_heel_strike(x3, p)
    lands = after(SYSTEM, TRANSITIONS["heel_strike"], 0.0, start, p)
    return p, start, phases(SYSTEM, p, "three_link", lands, 2)


@cache
def table1() -> tuple[SimpleNamespace, np.ndarray, list[Phase]]:
    return step(GAIT["x"])


@cache
def at_event(label: str) -> tuple[SimpleNamespace, np.ndarray, list[Phase]]:
    return step(EVENTS[label]["x"], alpha=EVENTS[label]["alpha"])


def states_at(start: np.ndarray, parts: list[Phase]) -> dict[tuple[str, str], np.ndarray]:
    """States at the impacts of a step, by transition and side."""
    knee, heel = parts
    return {
        ("knee_strike", "before"): knee.before,
        ("knee_strike", "after"): knee.after,
        ("heel_strike", "before"): heel.before,
        ("heel_strike", "after"): heel.after,
    }


def margins(motion) -> dict[str, float]:
    """Values of all conditions over a step."""
    p, start, parts = motion
    states = states_at(start, parts)
    return {c.name: c.function(0.0, states[c.at, c.side], p) for c in SYSTEM.conditions}


def observed(name: str, motion) -> float:
    p, start, parts = motion
    observable = OBSERVABLES[name]
    if observable.at is None:
        return observable.function(*joined(parts), p)
    return observable.function(0.0, states_at(start, parts)[observable.at, observable.side], p)


def flat(parts: list[Phase]) -> np.ndarray:
    """(q1, u1, u2) at the end of a step."""
    return parts[-1].before[[0, 4, 5]]


# -- the equations -------------------------------------------------------------------------------------------


def random_case(seed: int) -> tuple[SimpleNamespace, np.ndarray]:
    """A random walker in a random state."""
    random = np.random.default_rng(seed)
    p = parameters(SYSTEM, **{name: float(random.uniform(0.2, 1.5)) for name in SYSTEM.parameter_names})
    p.alpha, p.l1x, p.l2x, p.lf = random.uniform(-0.5, 0.5, 4)
    x = random.normal(size=7)
    p.rf = random.uniform(-0.5, 0.5)  # of negative ones too
    x[3] = 0.0
    return p, x


def free(x, p) -> tuple[list[float], list[float]]:
    """The six coordinates and rates of the free walker, whose leg 1 rolls."""
    q = [x[0], x[1], x[2], 0.0, 0.0, 0.0]
    return q, derivation().standing(q, (x[4], x[5], x[6], 0.0), vars(p))


def largest(found, expected) -> float:
    """Largest difference, in units of the largest entry."""
    expected = np.array([float(value) for value in expected])
    return float(np.abs(np.array(found) - expected).max() / np.abs(expected).max())


@pytest.mark.parametrize("seed", range(5))
def test_mass_matrix_is_the_derived_one(seed):
    p, x = random_case(seed)
    q, _ = free(x, p)
    columns = []
    for u1, u2, w in np.eye(3):
        columns.append(derivation().standing(q, (u1, u2, u2 - w, 0.0), vars(p)))
    basis = mpmath.matrix(columns).T
    derived = basis.T * derivation().mass_matrix(q, vars(p)) * basis
    written, _ = three_link.equations(x, p)
    upper = [derived[i, j] for i in range(3) for j in range(i, 3)]
    assert largest(written, upper) < 1e-14


@pytest.mark.parametrize("seed", range(5))
def test_three_link_accelerations_are_the_derived_ones(seed):
    p, x = random_case(seed)
    accelerations, _ = derivation().motion(*free(x, p), vars(p), (6,))
    assert largest(three_link.accelerations(x, p), accelerations[:3]) < 1e-12
    rates = vector(three_link.field, 0.0, x, p)
    assert rates[:4].tolist() == [x[4], x[5], x[6], 0.0]


@pytest.mark.parametrize("seed", range(5))
def test_two_link_accelerations_are_the_derived_ones(seed):
    p, x = random_case(seed)
    x[2] = x[6] = 0.0
    accelerations, _ = derivation().motion(*free(x, p), vars(p), (6, 3))
    assert largest(two_link.accelerations(x, p), accelerations[:2]) < 1e-12


@pytest.mark.parametrize("seed", range(5))
def test_knee_strike_is_the_derived_impact(seed):
    p, x = random_case(seed)
    x[2] = 0.0
    q, u = free(x, p)
    rates, (r_x, r_y, q_1, q_2) = derivation().impact(q, u, vars(p), derivation().LEG_1)
    found = impacts.knee_strike(x, p)
    assert largest((found.stance, found.other), rates[:2]) < 1e-12
    assert largest((*found.foot, found.stance_knee, found.other_knee), (r_x, r_y, q_1, q_2)) < 1e-12
    energies = [derivation().energy(q, rate, vars(p))[0] for rate in (u, rates)]
    assert largest((found.energy, found.lost), (energies[0], energies[0] - energies[1])) < 1e-12


@pytest.mark.parametrize("seed", range(5))
def test_heel_strike_is_the_derived_impact(seed):
    p, x = random_case(seed)
    x[2] = x[6] = 0.0
    q, u = free(x, p)
    rates, (r_x, r_y, trailing, landing) = derivation().impact(q, u, vars(p), derivation().LEG_2)
    found = impacts.heel_strike(x, p)
    assert largest((found.other, found.stance), rates[:2]) < 1e-12
    assert largest((*found.foot, found.stance_knee, found.other_knee), (r_x, r_y, landing, trailing)) < 1e-12
    energies = [derivation().energy(q, rate, vars(p))[0] for rate in (u, rates)]
    assert largest((found.energy, found.lost), (energies[0], energies[0] - energies[1])) < 1e-12


@pytest.mark.parametrize("mode", ["three_link", "two_link"])
def test_energy_is_kept_between_impacts(mode):
    p, _, parts = table1()
    part = next(part for part in parts if part.mode == mode)
    totals = []
    for t in np.linspace(part.begin, part.end, 9):
        x = part.at(t)
        q, u = free(x, p)
        q[3] = rolled(x[0], p)
        q[4] = p.rf - p.lf * math.sin(x[0]) + (p.l1 + p.l2) * math.cos(x[0])
        totals.append(float(sum(derivation().energy(q, u, vars(p)))))
    assert np.ptp(totals) < 1e-10 * max(map(abs, totals))


# -- the gait of Table I -------------------------------------------------------------------------------------


def test_defaults_are_those_of_the_reference():
    defaults = SYSTEM.defaults()
    assert defaults.pop("mu") == 3.0
    assert defaults == REFERENCE["parameters"]
    assert SYSTEM.state_names == ("q1", "q2", "q3", "q6", "u1", "u2", "u3")


def test_gait_repeats_itself():
    _, _, parts = table1()
    assert flat(parts) == pytest.approx([float(value) for value in GAIT["x"]], abs=NEAR)
    assert parts[0].duration == pytest.approx(float(GAIT["T_threelink"]), abs=NEAR)
    assert parts[1].duration == pytest.approx(float(GAIT["T_twolink"]), abs=NEAR)
    assert parts[1].end == pytest.approx(float(GAIT["T_step"]), abs=NEAR)
    assert [part.transition.name for part in parts] == ["knee_strike", "heel_strike"]


def test_impacts_of_the_gait():
    p, start, parts = table1()
    heel, knee = impacts.heel_strike(start, p), impacts.knee_strike(parts[0].before, p)
    assert heel.foot == pytest.approx([float(value) for value in GAIT["foot_impulse"]], abs=1e-12)
    assert knee.foot == pytest.approx([float(value) for value in GAIT["knee_impulse"]], abs=NEAR)
    angles = [float(GAIT["knee_strike_q1"]), float(GAIT["knee_strike_q2"])]
    assert parts[0].before[:2] == pytest.approx(angles, abs=NEAR)


def test_observables_of_the_gait():
    motion = table1()
    assert observed("step_length", motion) == pytest.approx(float(GAIT["step_length"]), abs=NEAR)
    assert observed("friction_heel", motion) == pytest.approx(GAIT["mu_foot"], abs=NEAR)
    assert observed("friction_knee", motion) == pytest.approx(GAIT["mu_knee"], abs=NEAR)
    assert observed("impulse_heel", motion) == pytest.approx(float(GAIT["foot_impulse"][1]), abs=NEAR)
    assert observed("impulse_knee", motion) == pytest.approx(float(GAIT["knee_impulse"][1]), abs=NEAR)
    speed = float(GAIT["step_length"]) / float(GAIT["T_step"])
    assert observed("speed", motion) == pytest.approx(speed, abs=NEAR)
    assert observed("step_time", motion) == pytest.approx(float(GAIT["T_step"]), abs=NEAR)


def test_what_is_lost_at_impacts_is_what_the_slope_gives():
    p, _, (knee, heel) = table1()
    lost = impacts.knee_strike(knee.before, p).lost + impacts.heel_strike(heel.before, p).lost
    down = observed("step_length", table1()) * math.sin(p.alpha)
    assert lost == pytest.approx(2.0 * (p.m1 + p.m2) * p.g * down, rel=1e-9)
    shares = [observed(name, table1()) for name in ("knee_loss", "impact_loss")]
    assert all(0.0 < share < 1.0 for share in shares)


def test_speed_counts_all_steps_of_a_motion():
    p, start, _ = table1()
    start = before_heel_strike(start[[0, 4, 5]] + np.array([0.002, 0.01, -0.02]), p)
    lands = after(SYSTEM, TRANSITIONS["heel_strike"], 0.0, start, p)
    parts = phases(SYSTEM, p, "three_link", lands, 4)
    way = sum(
        rolled(end.before[0], p) - rolled(begin.at(begin.begin)[0], p)
        for begin, end in (parts[:2], parts[2:])
    )
    assert OBSERVABLES["speed"].function(*joined(parts), p) == pytest.approx(way / parts[-1].end, rel=1e-12)
    # two steps, which are not alike
    assert OBSERVABLES["step_time"].function(*joined(parts), p) == pytest.approx(parts[-1].end / 2, rel=1e-12)


def test_speed_of_a_single_instant_is_zero():
    p, start, _ = table1()
    assert OBSERVABLES["speed"].function(np.zeros(1), start[None, :], p) == 0.0


def test_one_step_from_the_printed_state():
    step_from = GAIT["one_step_from_table_ic"]
    _, _, parts = step(step_from["x0"])
    assert flat(parts) == pytest.approx([float(value) for value in step_from["x1"]], abs=NEAR)
    assert parts[-1].end == pytest.approx(float(step_from["T"]), abs=NEAR)


def test_clearance_dips_behind_and_in_front():
    """Both dips of equation 13 at the gait, each seen by its own guard."""
    p, _, (swing, _) = table1()
    ((time, least),) = dips(TRANSITIONS["hind_dip"].guard, swing, p)
    assert least == pytest.approx(GAIT["hind_dip_clearance"], abs=1e-10)
    assert time == pytest.approx(GAIT["hind_dip_time"], abs=1e-6)
    # Where the feet pass each other, the guard in front takes over from its lifted half: a shallow dip.
    (passing, high), (time, least) = dips(TRANSITIONS["front_dip"].guard, swing, p)
    assert high == pytest.approx(clearance(swing.at(passing), p), abs=1e-3)
    assert time == pytest.approx(0.3887, abs=1e-4)
    assert least == pytest.approx(clearance(swing.at(time), p), abs=1e-15)


def clearance(x, p) -> float:
    """Equation 13 as it is printed."""
    q1, q2, q3 = x[:3]
    return (
        p.lf * math.sin(-q3 + q2)
        - p.l2 * math.cos(q2)
        - p.l1 * math.cos(-q3 + q2)
        - p.lf * math.sin(q1)
        + (p.l1 + p.l2) * math.cos(q1)
    )


def test_gait_is_admissible():
    motion = table1()
    assert min(margins(motion).values()) > 0.0
    p, _, parts = motion
    for transition in SYSTEM.transitions:
        for part in parts:
            if transition.role == "watched" and transition.source == part.mode:
                # The clearance begins with zero.
                times = np.linspace(part.begin + 1e-6, part.end, 400)
                assert min(transition.guard(t, part.at(t), p) for t in times) > 0.0


# -- other gaits ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize("point", FIGURE_5, ids=lambda point: f"rf={point['rf']}")
def test_gaits_of_figure_5(point):
    motion = step(point["x"], rf=float(point["rf"]), lf=float(point["lf"]))
    assert flat(motion[2]) == pytest.approx([float(value) for value in point["x"]], abs=NEAR)
    assert motion[2][-1].end == pytest.approx(float(point["T"]), abs=NEAR)
    assert observed("step_length", motion) == pytest.approx(float(point["step_length"]), abs=NEAR)
    assert observed("friction_heel", motion) == pytest.approx(float(point["mu_foot"]), abs=1e-8)
    assert observed("friction_knee", motion) == pytest.approx(float(point["mu_knee"]), abs=1e-8)
    assert observed("impulse_heel", motion) == pytest.approx(float(point["Ry_foot"]), abs=NEAR)


def test_preset_of_figure_6_is_the_small_end_of_figure_5():
    small = SYSTEM.presets["fig6"]
    assert (small["rf"], small["lf"]) == tuple(float(FIGURE_5[-1][name]) for name in ("rf", "lf"))


@pytest.mark.parametrize("label", EVENTS)
def test_gaits_at_the_limits_repeat_themselves(label):
    _, _, parts = at_event(label)
    assert flat(parts) == pytest.approx(EVENTS[label]["x"], abs=NEAR)
    assert parts[-1].end == pytest.approx(EVENTS[label]["T"], abs=NEAR)


@pytest.mark.parametrize("name", ["fold", "grazing_heel_strike_end"])
def test_gaits_at_the_ends_of_the_branch_repeat_themselves(name):
    found = REFERENCE["slope"][name]
    _, _, parts = step(found["x"], alpha=float(found["alpha"]))
    assert flat(parts) == pytest.approx([float(value) for value in found["x"]], abs=NEAR)
    assert parts[-1].end == pytest.approx(float(found["T"]), abs=NEAR)


def test_heel_strike_grazes_at_the_end_of_the_branch():
    found = REFERENCE["slope"]["grazing_heel_strike_end"]
    p, _, parts = step(found["x"], alpha=found["alpha"])
    ((time, least),) = dips(TRANSITIONS["heel_strike"].guard, parts[1], p)
    assert least == pytest.approx(found["emin"], abs=1e-10)
    assert time == pytest.approx(found["t_graze"], abs=1e-5)


@pytest.mark.parametrize(
    ("label", "guard"),
    [
        ("up hind dip clearance=0", "hind_dip"),
        ("down hind dip clearance=0", "hind_dip"),
        ("down front dip clearance=0", "front_dip"),
    ],
)
def test_foot_touches_the_ground_at_the_limits(label, guard):
    p, _, (swing, _) = at_event(label)
    clearances = [least for _, least in dips(TRANSITIONS[guard].guard, swing, p)]
    assert min(clearances) == pytest.approx(0.0, abs=1e-10)


@pytest.mark.parametrize(
    ("label", "condition", "size"),
    [
        ("up v_C2 after heel strike=0", "trailing_foot_lifts", 0.39),
        ("down R_y at knee strike=0", "knee_contact", 0.32),
        ("down Q2 (hind knee) at heel strike=0", "hind_knee_impulse", 0.097),
    ],
)
def test_conditions_are_zero_at_the_limits(label, condition, size):
    assert margins(at_event(label))[condition] == pytest.approx(0.0, abs=1e-10)
    assert margins(table1())[condition] == pytest.approx(size, rel=0.02)


def test_condition_at_lifting_is_equation_8():
    p, start, _ = table1()
    q1, q2, _, _, u1, u2, _ = x = after(SYSTEM, TRANSITIONS["heel_strike"], 0.0, start, p)
    printed = p.lf * (u2 * math.cos(q2) - u1 * math.cos(q1)) + (p.l1 + p.l2) * (
        u2 * math.sin(q2) - u1 * math.sin(q1)
    )
    assert CONDITIONS["trailing_foot_lifts"].function(0.0, x, p) == pytest.approx(printed, rel=1e-14)


@pytest.mark.parametrize("event", ["knee", "heel"])
def test_friction_condition_turns_where_the_friction_needed_is_what_there_is(event):
    p, start, parts = table1()
    needed = observed(f"friction_{event}", (p, start, parts))
    values = []
    for factor in (0.999, 1.0, 1.001):
        less = SimpleNamespace(**(vars(p) | {"mu": factor * needed}))
        values.append(margins((less, start, parts))[f"{event}_friction"])
    assert values[0] < 0.0 < values[2]
    assert values[1] == pytest.approx(0.0, abs=1e-15)


# -- the declarations ----------------------------------------------------------------------------------------


def test_legs_swap_back():
    x = np.arange(1.0, 8.0)
    p = parameters(SYSTEM)
    assert vector(LEGS.map, 0.0, x, p).tolist() == [2.0, 1.0, 4.0, 3.0, 6.0, 5.0, 7.0]
    assert vector(LEGS.map, 0.0, vector(LEGS.map, 0.0, x, p), p).tolist() == x.tolist()


def test_states_that_do_not_exist_in_a_mode_stay_zero():
    p, start, parts = table1()
    for part in parts:
        absent = sorted(set(range(7)) - set(SYSTEM.states_of(part.mode)))
        _, states = part.instants(20)
        assert not states[:, absent].any()
    x = after(SYSTEM, TRANSITIONS["heel_strike"], 0.0, start, p)
    assert x[[2, 3, 6]].tolist() == [0.0, 0.0, 0.0]


def test_guards_of_what_ends_a_gait_change_sign_there():
    """Standing upright is admissible; fallen, folded up, or with the swing leg behind, is not."""
    p = parameters(SYSTEM)
    upright = np.array([0.0, 0.1, 0.1, 0.0, 0.0, 0.0, 0.0])
    bad = {
        "fall_three_link": [math.pi / 2 + 0.4, 0.0, 0.1, 0.0, 0.0, 0.0, 0.0],
        "fall_two_link": [-math.pi / 2 - 0.5, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        "over_swing": [0.0, 0.0, 3.2, 0.0, 0.0, 0.0, 0.0],
        "swing_back": [0.0, -0.1, 0.0, 0.0, 0.0, 0.0, 0.0],
    }
    for name, x in bad.items():
        guard = TRANSITIONS[name].guard
        assert guard(0.0, upright, p) > 0.0 > guard(0.0, np.array(x), p), name


def traced_functions() -> dict[str, Traced]:
    """All functions that are traced, by what they are."""
    found = {}
    for mode in SYSTEM.modes:
        found[mode.name] = Traced(mode.field, SYSTEM, vector_form(SYSTEM, "field", "dx"))
    found["legs"] = Traced(LEGS.map, SYSTEM, vector_form(SYSTEM, "map", "x_image"))
    for transition in SYSTEM.transitions:
        found[transition.name] = Traced(transition.guard, SYSTEM, number_form("guard(t, x, p)"))
        if transition.reset is not None:
            form = vector_form(SYSTEM, "reset", "x_plus")
            found[f"{transition.name} reset"] = Traced(transition.reset, SYSTEM, form)
    at_events = [observable for observable in SYSTEM.observables if observable.at is not None]
    for entry in (*SYSTEM.conditions, *at_events):
        found[entry.name] = Traced(entry.function, SYSTEM, number_form("function(t, x, p)"))
    return found


def test_every_function_can_be_traced():
    defaults = SYSTEM.defaults()
    x = np.array([-0.1, 0.3, 0.4, 0.0, -1.1, -0.7, -2.0])
    for name, function in traced_functions().items():
        assert not function.unwritten, name
        assert len(function.outputs()) == 1, name  # no paths
        own = function.plainly(0.0, x, defaults)
        assert np.isfinite(own).all(), name
        assert function.values(0.0, x, list(defaults.values())) == pytest.approx(own, rel=1e-13, abs=1e-13)
        assert np.isfinite(function.slopes(0.0, x, list(defaults.values()))).all(), name


def test_pictures_of_a_step_stand_on_one_slope():
    """The foot that stands is drawn where it has rolled to: its lowest point is on the line of the slope."""
    p, start, parts = table1()
    for x in (start, *(part.at(part.begin) for part in parts), parts[0].at(0.3)):
        axes = Figure().subplots()
        SYSTEM.draw(axes, 0.0, x, p)
        heights = []
        for line in axes.lines:
            along, up = line.get_xdata(), line.get_ydata()
            heights.append(min(np.cos(p.alpha) * up + np.sin(p.alpha) * along))
        assert min(heights) == pytest.approx(0.0, abs=5e-4)
        assert len(axes.lines) >= 6
