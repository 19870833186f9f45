"""The 3D walker's equations against their definition, and its gaits against verified numbers."""

from __future__ import annotations

from types import SimpleNamespace

import mpmath
import numpy as np
import pytest
from walker3d_definition import Machine, energy, error_of_accelerations
from walker3d_motion import (
    ENDS,
    GAITS,
    REFERENCE,
    gait,
    mode_named,
    mode_of,
    random_state,
    rates,
    values,
    walk,
    walker,
)

from contwalk.flow.compiled.traced import field_of

EVERYTHING = mode_named(walker(), "11 12 21 22", "1 2")
# Relative to the largest acceleration: rounding of some hundred operations.
ROUNDING = 1e-12
# The motions are integrated to 1e-12, and errors grow tenfold in a stride.
NEAR = 1e-10


def differences(found: np.ndarray, expected: np.ndarray) -> float:
    """Largest difference, in units of the largest entry."""
    return float(np.abs(found - expected).max() / np.abs(expected).max())


# -- the equations -------------------------------------------------------------------------------------------


def random_machine(random: np.random.Generator, **choices: str) -> tuple[dict[str, float], Machine]:
    """Random parameters of a machine, and the same ones for a machine with legs of its own."""
    system = walker(**choices)
    p = {name: float(random.uniform(-0.4, 0.4)) for name in system.parameter_names}
    p |= {name: float(random.uniform(0.5, 3.0)) for name in p if name.startswith(("m_", "k_", "c_", "g"))}
    for name in p:
        if name.startswith("I_") and name[-1] == name[-2]:
            p[name] = float(random.uniform(1.0, 2.0))
        elif name.startswith("I_"):
            p[name] *= 0.5
    if "I_torso" in p:
        p["I_torso"] = 1.3
    return p, Machine(own_legs(p), geared=choices.get("hip") == "locked")


def own_legs(p: dict[str, float]) -> dict[str, float]:
    """Parameters of both legs: leg 2 is the mirror image of leg 1."""
    found = dict(p)
    if "I_torso" in p:
        found |= {f"I_torso_{c}": p["I_torso"] * (c[0] == c[1]) for c in ("xx", "yy", "zz", "xy", "xz", "yz")}
    found |= {name: p.get(name, 0.0) for name in ("torso_x", "I_torso_xy", "I_torso_xz")}
    for name, value in p.items():
        for word in ("thigh", "shank", "hip", "knee"):
            if f"{word}_" in name or name == f"m_{word}":
                for leg, sign in ((1, 1.0), (2, -1.0)):
                    odd = name.endswith(("_x", "_xy", "_xz"))
                    found[name.replace(word, f"{word}{leg}")] = sign * value if odd else value
        if name.startswith("toe_"):
            which, axis = name.removeprefix("toe_").split("_")
            number = {"outer": 1, "inner": 2}[which]
            found[f"toe1{number}_{axis}"] = value
            found[f"toe2{number}_{axis}"] = -value if axis == "x" else value
    return found


CHOICES = [
    {},
    {"legs": "free"},
    {"ground_damper": "two_sided"},
    {"hip": "sprung"},
    {"hip": "locked"},
    {"torso": "balanced"},
    {"torso": "balanced", "hip": "locked"},
    {"knee_damper": "rebound"},
    {"ground_damper": "clipped"},
]


@pytest.mark.drawn(3)
@pytest.mark.parametrize("choices", CHOICES, ids=lambda c: "_".join(c.values()) or "default")
def test_accelerations_are_those_of_kanes_equations(choices):
    random, system = np.random.default_rng(3), walker(**choices)
    p, machine = random_machine(random, **choices)
    x = random_state(random)
    # The last but some have a knee that rebounds, and toes that nothing holds down.
    numbers = 0, len(system.modes) // 3, *((len(system.modes) // 2 + 5,) if len(system.modes) > 400 else ())
    for mode in (system.modes[number].name for number in numbers):
        exists = set(system.states_of(mode))
        x = np.array([value if i in exists else 0.0 for i, value in enumerate(x)])
        found = rates(system, mode, x, p)
        errors = error_of_accelerations(machine, x, found[18:], system.mode(mode).constants)
        assert np.abs(errors).max() < ROUNDING * max(1.0, np.abs(found).max())
        q_dot = machine.q_dot([mpmath.mpf(float(value)) for value in x[:10]], list(x[18:]))
        kept = [i for i in range(10) if i in exists]
        assert found[kept] == pytest.approx([float(q_dot[i]) for i in kept], abs=1e-14)


@pytest.mark.parametrize("case", REFERENCE["rates"], ids=lambda c: f"{c['preset']}-{sum(c['contact'])}")
def test_rates_and_jacobian_of_the_other_implementation(case):
    system, mode = walker(), mode_of(case)
    p = values(system, case["preset"]) | ({"hip_x": 0.1295} if case["preset"] == "no_overlap" else {})
    exists, field = list(system.states_of(mode)), field_of(system, mode)
    constants = field.constants(np.array([p[name] for name in system.parameter_names]))
    x = np.array(case["x"])[exists]
    assert differences(field(0.0, x, constants), np.array(case["xdot"])[exists]) < 1e-14
    jacobian = field.jacobian(0.0, x, constants)
    for name, row in case["jacobian_rows"].items():
        place = exists.index(system.state_names.index(name))
        assert differences(jacobian[place], np.array(row)[exists]) < 1e-13


@pytest.mark.parametrize("case", REFERENCE["rates"][1::2], ids=lambda c: f"{c['preset']}-{sum(c['contact'])}")
def test_guards_and_resets_know_where_the_toes_are(case):
    system = walker()
    p = values(system, case["preset"]) | ({"hip_x": 0.1295} if case["preset"] == "no_overlap" else {})
    given, x = SimpleNamespace(**p), np.array(case["x"])
    heights, rising, sides, downs = case["toes"]
    for number, end in enumerate(ENDS):
        on = next(t for t in system.transitions if t.name == f"toe{end}_on")
        unloads = next(t for t in system.transitions if t.name == f"toe{end}_unloads")
        assert on.guard(0.0, x, given) == pytest.approx(heights[number], abs=1e-15)
        assert unloads.guard(0.0, x, given) == pytest.approx(rising[number], abs=1e-14)
        after = np.full(28, np.nan)
        on.reset(0.0, x, given, after)
        moved = [10 + 2 * number, 11 + 2 * number]
        assert after[moved] == pytest.approx([sides[number], downs[number]], abs=1e-15)
        assert np.delete(after, moved).tolist() == np.delete(x, moved).tolist()


def test_energy_is_kept_without_forces():
    """Of a walker in the air, dE/dt along its own motion."""
    random = np.random.default_rng(5)
    p, _ = random_machine(random)
    p["c_hip"] = 0.0
    system, machine = walker(), Machine(own_legs(p))
    mode, x = mode_named(system, "", "", "12"), random_state(random)
    x[10:18] = 0.0
    step, f = mpmath.mpf(10) ** -12, rates(system, mode, x, p)
    ahead, behind = (
        [mpmath.mpf(float(a)) + s * mpmath.mpf(float(b)) for a, b in zip(x, f, strict=True)]
        for s in (step, -step)
    )
    power = (energy(machine, ahead) - energy(machine, behind)) / (2 * step)
    assert abs(float(power)) < 1e-13 * float(abs(energy(machine, x))) * np.abs(f).max()


def test_energy_is_kept_in_flight():
    system = walker()
    p = values(system, "no_overlap", c_hip=0.0, k_knee=0.0, c_knee=0.0)
    x = np.array(GAITS["no_overlap"]["x"])
    x[1], x[10:18] = 3.0, 0.0
    flight = walk(system, p, mode_named(system, "", "", "12"), x, 0.3)
    machine = Machine(own_legs(p))
    first, last = (float(energy(machine, flight.states[k])) for k in (0, -1))
    assert last == pytest.approx(first, abs=1e-10)
    assert np.array(flight.states[-1][18:]) != pytest.approx(x[18:], abs=0.1)


@pytest.mark.parametrize("mode", [EVERYTHING, "toe11_toe12up_swing2_knee2"])
def test_the_mirror_takes_motions_to_motions(mode):
    system, random = walker(), np.random.default_rng(8)
    (mirror,) = system.symmetries
    p, _ = random_machine(random)
    x, image = random_state(random), np.full(28, np.nan)
    exists = list(system.states_of(mode))
    x[[i for i in range(28) if i not in exists]] = 0.0
    mirror.map(0.0, x, None, image)
    found, of_image = np.full(28, np.nan), rates(system, mirror.modes.get(mode, mode), image, p)
    mirror.map(0.0, rates(system, mode, x, p), None, found)
    assert of_image == pytest.approx(found, abs=1e-11)


@pytest.mark.parametrize("choices", [{}, {"torso": "balanced"}], ids=["general", "balanced"])
def test_nothing_changes_along_neutral_directions(choices):
    system, random = walker(**choices), np.random.default_rng(9)
    p, _ = random_machine(random, **choices)
    x, mode = random_state(random), system.modes[0].name
    assert [n.pin for n in system.neutral] == ["q1", "q3", "q4"]
    for neutral in system.neutral[: 2 + bool(choices)]:  # pitch is for a balanced torso only
        direction = np.full(28, np.nan)
        neutral.generator(0.0, x, None, direction)
        assert rates(system, mode, x + 0.3 * direction, p) == pytest.approx(
            rates(system, mode, x, p), abs=1e-12
        )


def test_legs_of_their_own_may_be_mirror_images():
    system, free, x = walker(), walker(legs="free"), random_state(np.random.default_rng(4))
    for preset in system.presets:
        both = [rates(s, EVERYTHING, x, values(s, preset)) for s in (system, free)]
        assert both[0] == pytest.approx(both[1], rel=1e-13)


# -- the gaits -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", GAITS)
def test_gaits_repeat_themselves_in_the_mirror_after_half_a_stride(name):
    (mirror,) = walker().symmetries
    known, (_, half) = GAITS[name], gait(name, 0.5)
    assert half.modes[-1] == mirror.modes[half.modes[0]]
    exists = walker().states_of(half.modes[-1])
    there = [i for i in exists if not (i == 3 and name == "no_overlap")]
    assert half.states[-1][there] == pytest.approx(np.array(known["x_after_half"])[there], abs=NEAR)
    image = np.zeros(28)
    mirror.map(0.0, half.states[-1], None, image)
    begins = [i for i in walker().states_of(half.modes[0]) if i not in (0, 2, 3)]
    assert image[begins] == pytest.approx(np.array(known["x"])[begins], abs=NEAR)


@pytest.mark.parametrize("name", GAITS)
def test_events_of_half_a_stride(name):
    _, half = gait(name, 0.5)
    known = [(t, event) for t, event in GAITS[name]["events"] if t < 0.5 * GAITS[name]["T"]]
    assert [t for t, _ in half.events] == pytest.approx([t for t, _ in known], abs=NEAR)
    found = [event.replace("unloads", "damper").replace("loads", "damper") for _, event in half.events]
    assert found == [event for _, event in known]


def test_stride_from_the_printed_state():
    """Paper 7, Tables IV and VI: twelve events in their order."""
    start = np.array(REFERENCE["printed"]["table_VI"])
    found = walk(walker(), values(walker()), mode_of(GAITS["overlap"]), start, 1.43)
    hard = [event for event in found.events if not event[1].endswith("loads")]
    assert [name for _, name in hard] == [name for _, name in REFERENCE["from_table_VI"]]
    times = [t for t, _ in hard]
    assert times == pytest.approx([t for t, _ in REFERENCE["from_table_VI"]], abs=1e-9)
    assert times == pytest.approx(REFERENCE["printed"]["table_IV"], abs=4e-6)


def test_printed_state_of_the_walker_without_overlap_is_near_its_gait():
    printed, known = REFERENCE["printed"]["appendix_6_1"], GAITS["no_overlap"]["x"]
    assert printed == pytest.approx(known, abs=2e-5, rel=2e-4)


@pytest.mark.parametrize("name", GAITS)
def test_numbers_of_the_gaits(name):
    p, half = gait(name, 0.5)
    (mirror,) = walker().symmetries
    images = np.array(half.states)
    for x, image in zip(half.states, images, strict=True):
        mirror.map(0.0, x, None, image)
    t, x = np.append(half.times, half.times + half.times[-1]), np.concatenate([half.states, images])
    found = {o.name: o.function(t, x, p) for o in walker().observables if o.at is None}
    known = GAITS[name]
    assert found["stride_time"] == pytest.approx(known["T"], rel=1e-12)
    assert found["stride_length"] == pytest.approx(known["stride_length"], abs=NEAR)
    assert found["speed"] == pytest.approx(known["speed"], abs=NEAR)
    assert found["heading"] == pytest.approx(0.0, abs=NEAR)
    assert found["energy_per_stride"] == pytest.approx(
        {"overlap": 7.534, "no_overlap": 11.426}[name] * 9.81 * np.sin(0.08) * known["stride_length"]
    )
    expected = {
        "overlap": {"hyperextension": 0.00803, "hip_bob": 0.01946, "hip_sway": 0.0657, "friction11": 0.5397},
        # Paper 8, section 2.8: less than 2/100 s for an outer toe, 3/100 s and a peak of 1.3 for an inner one
        "no_overlap": {
            "hyperextension": 0.12478,
            "slip_time11": 0.0186,
            "slip_time12": 0.0293,
            "friction12": 1.27,
        },
    }[name]
    assert {key: found[key] for key in expected} == pytest.approx(expected, rel=5e-3)
    for name in ("friction", "slip_time"):
        for toe in (1, 2):
            assert found[f"{name}1{toe}"] == pytest.approx(found[f"{name}2{toe}"], rel=1e-9)
