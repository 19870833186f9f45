"""Modes that share one field: it is traced once for all of them, and tried in each."""

from __future__ import annotations

import numpy as np
import pytest

from contwalk.plugin_check.findings import Report
from contwalk.plugin_check.functions import field_form
from contwalk.plugin_check.modes import CheckedFields
from contwalk.plugin_check.samples import samples_of
from contwalk.plugin_check.system import check_reference, check_system
from contwalk.plugin_check.traced import Traced
from contwalk.system import load_system

# A mass held to the side in one of ten modes only: moving it to the side is neutral in the others.
HELD = """\
from contwalk.system import Mode, Neutral, Parameter, State, System, Transition


def field(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = -p.held * x[0] - x[1]
    dx[2] = 1.0 + 0.1 * p.number


def aside(t, x, p, v):
    v[0] = 1.0
    v[1] = 0.0
    v[2] = 0.0


def end(t, x, p):
    return x[2] - 1.0


def back(t, x, p, x_plus):
    x_plus[0], x_plus[1], x_plus[2] = x[0], x[1], 0.0


NAMES = [f"mode{k}" for k in range(10)]
SYSTEM = System(
    name="held",
    states=(State("x", "m"), State("v", "m/s"), State("phase", "1")),
    parameters=(Parameter("a", 1.0, "1"),),
    modes=tuple(
        Mode(name, field, constants={"held": HELD if k == 7 else 0.0, "number": float(k)})
        for k, name in enumerate(NAMES)
    ),
    transitions=tuple(
        Transition("end", one, other, end, direction="rising", reset=back)
        for one, other in zip(NAMES, NAMES[1:] + NAMES[:1])
    ),
    neutral=(Neutral("aside", aside),),
)
"""


def told(tmp_path, held):
    path = tmp_path / "held.py"
    path.write_text(HELD.replace("HELD", held), encoding="utf-8")
    return [(f.level, f.sentence) for f in check_reference(str(path)) if "neutral" in f.what]


def test_a_direction_that_one_mode_loses_is_found(tmp_path):
    findings = told(tmp_path, "2.0")
    lost = [sentence for level, sentence in findings if level == "warning"]
    assert len(lost) == 1
    assert "dx[1] (state v) changes along it in mode 'mode7', by -2" in lost[0]


def test_what_was_sampled_is_said(tmp_path):
    assert (
        "ok",
        "is carried along by the fields of all modes, "
        "at one sampled state in each of 9 that share the field of another.",
    ) in told(tmp_path, "0.0")


def test_fields_of_other_modes_are_those_that_are_traced_by_themselves():
    system = load_system("walker3d", {"ground_damper": "two_sided"})
    samples, fields = samples_of(system, None), CheckedFields(system)
    fields.check(Report())
    for mode in system.modes[1::33]:
        other, own = fields[mode.name], Traced(mode.field, system, field_form(mode, system), mode=mode.name)
        for t, x in zip(samples.times, samples.states, strict=True):
            given = own.given(x)
            size = np.finfo(float).eps * own.roundings(t, given, samples.values)
            apart = np.abs(other.values(t, given, samples.values) - own.values(t, given, samples.values))
            assert (apart <= 2.0 * size).all()  # each is within its bound
            slopes = [each.slopes(t, given, samples.values) for each in (other, own)]
            # Sums of the same terms in another order: they cancel by as much as the entries of M^-1 do.
            assert slopes[0] == pytest.approx(slopes[1], rel=1e-9, abs=1e-9 * np.abs(slopes[1]).max())


@pytest.mark.slow
@pytest.mark.parametrize("ground", ["two_sided", pytest.param("clipped", marks=pytest.mark.long)])
def test_the_walker_in_space_is_sound(ground):
    findings = check_system(load_system("walker3d", {"ground_damper": ground}))
    assert [f for f in findings if f.level != "ok"] == []
