"""What the 3D walker declares: modes, events, the mirror, parameters, model choices, its picture."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from contwalk_systems.walker3d.observables import strides, way
from matplotlib.figure import Figure
from walker3d_motion import ENDS, GAITS, gait, mode_named, random_state, values, walker

from contwalk.flow.hybrid.motion_segment import Control
from contwalk.flow.hybrid.motions import hybrid_machine, motion_segments
from contwalk.plugin_check.traced import Traced, number_form, vector_form
from contwalk.workflow.quantities import values_along

STANDING = mode_named(walker(), "21 22", "2", "1")


def leaving(mode: str, **choices: str) -> dict[str, str]:
    """Names of the transitions out of a mode, with their roles."""
    return {t.name: t.role for t in walker(**choices).leaving(mode)}


# -- modes and events ----------------------------------------------------------------------------------------


def test_all_modes_share_one_field():
    system = walker()
    assert len(system.modes) == 400
    assert len({id(mode.field) for mode in system.modes}) == 1
    assert len({tuple(mode.constants) for mode in system.modes}) == 1
    assert not set(system.modes[0].constants) & set(system.parameter_names)


def test_a_swinging_leg_touches_nothing_until_its_knee_locks():
    dips = {f"toe1{toe}_{dip}": "watched" for toe in (1, 2) for dip in ("hind_dip", "front_dip")}
    standing = {"toe21_unloads": "soft", "toe22_unloads": "soft", "knee2_unlocks": "hard"}
    assert leaving(STANDING) == dips | standing | {"knee1_locks": "hard"}
    locked = walker().transition("knee1_locks", STANDING).target
    landing = {"toe11_on": "hard", "toe12_on": "hard", "knee1_unlocks": "hard"}
    assert leaving(locked) == landing | standing
    # It may bend again before it lands: it does not swing any more.
    bent = walker().transition("knee1_unlocks", locked).target
    assert leaving(bent) == {"toe11_on": "hard", "toe12_on": "hard", "knee1_locks": "hard"} | standing


def test_scuffing_may_be_felt():
    mode = mode_named(walker(scuffing="felt"), "21 22", "2")
    assert {"toe11_on", "toe12_on"} <= set(leaving(mode, scuffing="felt"))
    assert not any("swing" in each.name for each in walker(scuffing="felt").modes)
    assert not any(t.role == "watched" for t in walker(scuffing="felt").transitions)


def test_a_damper_of_both_directions_needs_no_soft_events():
    system = walker(ground_damper="two_sided")
    assert {t.role for t in system.transitions} == {"hard", "watched"}
    assert not any(name.startswith("damped") for name in system.modes[0].constants)
    assert len(system.modes) == 100


def test_toes_lift_off_where_they_move_up():
    for transition in walker().transitions:
        if transition.name.endswith("_off"):
            assert walker().mode(transition.source).constants[f"damped{transition.name[3:5]}"] == 0.0
            assert transition.direction == "rising"


def test_anchors_exist_while_toes_touch():
    system = walker()
    for mode in system.modes:
        exists = system.states_of(mode.name)
        for number, end in enumerate(ENDS):
            there = mode.constants[f"on{end}"] == 1.0
            assert (10 + 2 * number in exists) == (11 + 2 * number in exists) == there
        assert set(range(10)) | set(range(18, 28)) <= set(exists)


def test_the_mirror_knows_modes_and_events():
    system = walker()
    (mirror,) = system.symmetries
    assert mirror.role == "spatial"
    x, image, back = random_state(np.random.default_rng(1)), np.full(28, np.nan), np.full(28, np.nan)
    mirror.map(0.0, x, None, image)
    mirror.map(0.0, image, None, back)
    assert back.tolist() == x.tolist()
    assert mirror.events["toe11_on"] == "toe21_on"
    assert mirror.events["knee2_unlocks"] == "knee1_unlocks"
    for transition in system.transitions:
        name = mirror.events.get(transition.name, transition.name)
        source = mirror.modes.get(transition.source, transition.source)
        of_image = system.transition(name, source)
        assert of_image.target == mirror.modes.get(transition.target, transition.target)
        assert (of_image.role, of_image.direction) == (transition.role, transition.direction)


def test_guards_are_one_for_an_event():
    """An event is the same one in all modes: its guard is one function."""
    guards: dict[str, set[int]] = {}
    for transition in walker().transitions:
        guards.setdefault(transition.name, set()).add(id(transition.guard))
    assert all(len(found) == 1 for found in guards.values())
    assert len(guards) == 4 * 6 + 2 * 2


def test_dips_are_the_height_of_the_toe_in_their_half():
    system, p = walker(), SimpleNamespace(**values(walker()))
    dips = {dip: system.transition(f"toe11_{dip}", STANDING).guard for dip in ("hind_dip", "front_dip")}
    height = next(t.guard for t in system.transitions if t.name == "toe11_on")
    x = np.array(GAITS["overlap"]["x"])
    assert dips["hind_dip"](0.0, x, p) == pytest.approx(height(0.0, x, p), abs=1e-15)
    assert dips["front_dip"](0.0, x, p) > height(0.0, x, p)
    x[6] -= 1.2  # the swinging leg in front
    assert dips["front_dip"](0.0, x, p) == pytest.approx(height(0.0, x, p), abs=1e-15)
    assert dips["hind_dip"](0.0, x, p) > height(0.0, x, p)


# -- parameters and choices ----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("choices", "count"),
    [
        ({}, 46),
        ({"hip": "sprung"}, 48),
        ({"hip": "locked"}, 45),
        ({"torso": "balanced"}, 41),
        ({"legs": "free"}, 77),
        ({"legs": "free", "hip": "sprung"}, 79),
    ],
    ids=lambda value: "_".join(value.values()) or "default" if isinstance(value, dict) else "",
)
def test_parameters_are_those_of_the_choices(choices, count):
    system = walker(**choices)
    assert len(system.parameters) == count
    assert list(system.presets) == ["overlap", "figure9", "no_overlap"]
    assert system.presets["overlap"] == system.defaults()
    assert all(set(preset) == set(system.parameter_names) for preset in system.presets.values())
    assert bool(system.symmetries) == (choices.get("legs") != "free")


def test_geared_hips_leave_the_torso_no_state():
    system = walker(hip="locked")
    for mode in system.modes:
        assert not {3, 21} & set(system.states_of(mode.name))
    assert [neutral.pin for neutral in system.neutral] == ["q1", "q3"]


def test_names_of_states():
    names = [
        *(f"q{i}" for i in range(1, 11)),
        *(f"p{i}" for i in range(1, 9)),
        *(f"u{i}" for i in range(1, 11)),
    ]
    assert list(walker().state_names) == names


@pytest.mark.parametrize(
    "choices",
    [
        {},
        {"legs": "free", "hip": "sprung"},
        {"hip": "locked", "torso": "balanced", "ground_damper": "two_sided"},
    ],
    ids=["default", "free", "geared"],
)
def test_every_function_can_be_traced(choices):
    system = walker(**choices)
    mode = system.modes[len(system.modes) // 2]
    found = {mode.name: Traced(mode.field, system, vector_form(system, "field", "dx"), mode=mode.name)}
    for transition in system.transitions:
        if transition.name in found:
            continue
        found[transition.name] = Traced(transition.guard, system, number_form("guard(t, x, p)"))
        if transition.reset is not None:
            form = vector_form(system, "reset", "x_plus")
            found[f"{transition.name} reset"] = Traced(transition.reset, system, form)
    x, defaults = random_state(np.random.default_rng(2)), system.defaults()
    for name, function in found.items():
        assert len(function.outputs()) == 1, name  # no paths
        if name != mode.name:
            own = function.plainly(0.0, x, defaults)
            assert function.values(0.0, x, list(defaults.values())) == pytest.approx(
                own, rel=1e-13, abs=1e-13
            )


# -- what is read off a motion -------------------------------------------------------------------------------


def test_the_way_goes_on_where_a_motion_jumps_back():
    x = np.zeros((4, 28))
    x[:, 2] = 0.1, 0.4, 0.1, 0.2
    x[:, 0] = 0.0, 0.2, -0.2, -0.1
    assert way(np.array([0.0, 1.0, 1.0, 2.0]), x) == pytest.approx(
        np.array([[0.0, 0.1], [0.2, 0.4], [0.2, 0.4], [0.3, 0.5]])
    )


def test_strides_are_landings_of_leg_1():
    _, half = gait("overlap", 0.5)
    assert strides(half.states) == 1
    assert strides(np.concatenate([half.states, half.states])) == 2


def test_a_single_instant_has_observables():
    x = np.array(GAITS["overlap"]["x"])[None]
    p = SimpleNamespace(**values(walker()))
    of_states = [o for o in walker().observables if o.at is not None]
    found = {o.name: o.function(np.zeros(1), x, p) for o in walker().observables if o not in of_states}
    found |= {o.name: o.function(0.0, x[0], p) for o in of_states}
    assert np.isfinite(list(found.values())).all()
    assert found["hip_height"] == x[0, 1]
    assert found["speed"] == 0.0


def test_the_angle_of_a_shank_is_that_from_its_knee_to_its_toes():
    """Toes are as far below the knee as in front of it, so they hang lowest at a quarter of a half turn."""
    system, x = walker(), np.zeros((1, 28))
    x[0, [1, 6, 7, 8, 9]] = 0.6, 0.3, 0.5, -0.2, 0.1
    p = values(system, toe_outer_y=-0.2, toe_outer_z=0.2)
    shanks = values_along(system, ["shank1", "shank2"], np.zeros(1), x, p)[0]
    assert shanks == pytest.approx([0.8, -0.1])
    for leg, thigh, shank in zip((1, 2), (0.3, -0.2), shanks, strict=True):
        (height,) = values_along(system, [f"height{leg}1"], np.zeros(1), x, p)[0]
        knee = 0.6 + p["knee_y"] * np.cos(thigh)
        assert height == pytest.approx(knee - np.hypot(0.2, 0.2) * np.cos(shank - np.pi / 4.0))


# -- its picture ---------------------------------------------------------------------------------------------


def test_a_foot_that_stands_stays_where_it_is_in_a_picture():
    """Toes move by millimetres while they touch."""
    p, half = gait("overlap", 0.5)
    feet = []
    for k in (0, len(half.times) // 4):
        axes = Figure().subplots()
        walker().draw(
            axes, half.times[k], half.states[k], p, so_far=(half.times[: k + 1], half.states[: k + 1])
        )
        feet.append(axes.patches[-3].get_xy()[1:3])
        assert {line.get_gid() for line in axes.lines} == {None, "scenery"}
    assert half.states[0, 14] != 0.0
    assert feet[1] == pytest.approx(feet[0], abs=0.01)


def test_a_single_instant_is_drawn_in_three_views():
    axes = Figure().subplots()
    walker().draw(
        axes, 0.0, np.array(GAITS["no_overlap"]["x"]), SimpleNamespace(**values(walker(), "no_overlap"))
    )
    words = {text.get_text() for text in axes.texts}
    assert words == {"from its right", "from the front", "from above"}
    labels = [line.get_label() for line in axes.lines if not line.get_label().startswith("_")]
    assert labels == ["leg 1, on the left", "leg 2, on the right"]


@pytest.mark.parametrize(
    ("preset", "mode"),
    [("overlap", "swing1_toe21_toe22_knee2"), ("no_overlap", "swing1_toe21_toe22up_knee2")],
)
def test_a_damper_that_switches_does_not_switch_back_at_once(preset, mode):
    """Both transitions of a damper have one guard, which rounding leaves beside zero after either."""
    known, random = GAITS[preset], np.random.default_rng(1)
    x, machine = np.array(known["x"]), hybrid_machine(walker(), values(walker(), preset, alpha=0.08))
    for tolerance in (1e-8, 1e-9):
        for _ in range(8):
            start = x * (1.0 + 3e-6 * random.standard_normal(len(x)))
            weights = np.maximum(np.abs(x), 0.05)
            control = Control(tolerance, weights)
            ends = [
                arc.times[-1]
                for arc in motion_segments(machine, 0.0, start, mode, 0.45 * known["T"], control)
            ]
            assert np.diff(ends).min() > 1e-6
