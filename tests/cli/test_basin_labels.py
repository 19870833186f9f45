"""What a basin calls that motions come to: three attractors, rest that attracts nothing, levels of energy."""

from __future__ import annotations

import numpy as np
import pytest

from contwalk.cli.entry import run
from contwalk.storage.trajectory import read_margins

PLUGIN = """\
import math
from contwalk.system import Conserved, Mode, Parameter, Start, State, System

def wells(t, x, p, dx):
    dx[0] = p.a - x[0] * (x[0] ** 2 - 1.0) * (x[0] ** 2 - 4.0)
    dx[1] = -x[1]

def swing(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = -math.sin(x[0]) + p.a

def energy(t, x, p):
    return 0.5 * x[1] ** 2 - math.cos(x[0]) - p.a * x[0]

WELLS = System(
    "wells",
    states=(State("x", scale=1.0), State("y", scale=1.0)),
    parameters=(Parameter("a", 0.0),),
    modes=(Mode("m", wells),),
    starts=(Start("rest", lambda p: [[0.0, 0.0], [2.0, 0.0], [-2.0, 0.0]]),),
)
PENDULUM = System(
    "pendulum",
    states=(State("x", scale=1.0), State("y", scale=1.0)),
    parameters=(Parameter("a", 0.0),),
    modes=(Mode("m", swing),),
    starts=(Start("rest", lambda p: [[0.0, 0.0]]),),
    conserved=(Conserved("energy", energy),),
)
SYSTEM = {which}
"""
STUDY = """\
system: ./{name}.py
start: {{equilibrium: rest}}
continue: {{parameter: a, range: [0.0, 0.1], max_points: 2, direction: up}}
diagram: none
margins:
  of: {{from: {name}.h5, point: b1/0}}
  survive: {{time: 40}}
  basin: {{states: {{x: [-3, 3], y: [-1, 1]}}, cells: 6, levels: 1}}
output: {name}.h5
"""


@pytest.fixture
def basin(folder, contwalk):
    """Basin and notes of one of the machines."""

    def found(name):
        (folder / f"{name}.py").write_text(PLUGIN.replace("{which}", name.upper()), encoding="utf-8")
        (folder / f"{name}.yaml").write_text(STUDY.format(name=name), encoding="utf-8")
        assert run(("continue", f"{name}.yaml", "--no-figures", "--quiet")) == 0
        assert contwalk("margins", f"{name}.yaml", "--no-figures").code == 0
        stored = read_margins(f"{name}_margins.h5")
        return stored.basin, stored.header["notes"]

    return found


def test_three_attractors_and_the_places_of_rest_between_them(basin):
    """The lattice meets x = -1 and x = 1, where motions stay that nothing pushes."""
    found, notes = basin("wells")
    x, labels = found["places"][:, 0], np.array(found["labels"])
    named = {2.0: "b2/0", 0.0: "b1/0", -2.0: "b3/0", -1.0: "unstable1", 1.0: "unstable2"}
    to = np.where(np.abs(x) == 1.0, x, 2.0 * np.sign(x) * (np.abs(x) > 1.0))
    assert labels.tolist() == [named[value] for value in to.tolist()]
    assert sum("attracts nothing" in note for note in notes) == 2
    assert not any("none of the stored" in note for note in notes)


def test_motions_that_keep_their_energy_have_no_names_of_their_own(basin):
    found, notes = basin("pendulum")
    assert set(found["labels"]) == {"b1/0", "unknown"}
    assert any("keep energy" in note for note in notes)
    assert not any("new1" in note for note in notes)
