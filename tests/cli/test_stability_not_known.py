"""Where the sign of an eigenvalue is lost in rounding, stability is not known, and nothing says that it is.

Two units x' = h (y - x) + a x - x^3 and the same with x and y changed: the eigenvalues at rest are a and
a - 2 h, and a is rounded in h - a to the spacing of h.
"""

from __future__ import annotations

import json

import jsonschema
import matplotlib.pyplot as plt
import numpy as np
import pytest

from contwalk.plotting import plot_bifurcation_diagram
from contwalk.storage import interface_schema, open_database

HOLD = 1e13
PLUGIN = """
from contwalk.system import Mode, Parameter, State, System

def field(t, x, p, dx):
    pull = p.h * (x[1] - x[0])
    dx[0] = pull + p.a * x[0] - x[0] ** 3
    dx[1] = p.a * x[1] - x[1] ** 3 - pull

SYSTEM = System(
    "coupled",
    states=(State("x"), State("y")),
    parameters=(Parameter("a", -1.0), Parameter("h", 1e13)),
    modes=(Mode("only", field),),
)
"""
RUN = """
system: ./coupled.py
start: {state: {x: 0.0, y: 0.0}}
continue: {parameter: a, range: [-1.0, -0.01]}
output: coupled.h5
"""


@pytest.fixture
def database(contwalk, folder):
    (folder / "coupled.py").write_text(PLUGIN, encoding="utf-8")
    (folder / "coupled.yaml").write_text(RUN, encoding="utf-8")
    assert contwalk("continue", "coupled.yaml", "--quiet", "--no-figures").code == 0
    return folder / "coupled.h5"


def test_arrays_and_json_say_where_it_is_not_known(contwalk, database):
    with open_database(database) as db:
        branch = db.branch("b1")
    unknown = branch["stable"] == -1
    assert branch["stable"].dtype.kind == "i"
    # What a is rounded to is half the spacing of h, four times; nothing beyond a hundred times that is lost.
    # Nearer to zero than the range goes rounding decides whether the equations are singular.
    assert unknown[-branch["a"] < 6.0 * np.spacing(HOLD)].sum() > 0
    assert unknown[-branch["a"] < 6.0 * np.spacing(HOLD)].all()
    assert (branch["stable"][-branch["a"] > 50.0 * np.spacing(HOLD)] == 1).all()
    assert np.array_equal(branch["unstable"], np.where(unknown, -1, 0))
    told = json.loads(contwalk("show", str(database), "--json", "--points").out)
    jsonschema.validate(told, interface_schema())
    assert told["schema_version"] == 3
    (own,) = told["branches"]
    assert [point["stable"] for point in own["points"]] == [None if each else True for each in unknown]
    assert [point["unstable"] for point in own["points"]] == [None if each else 0 for each in unknown]
    ends = [(point["unstable_before"], point["unstable_after"]) for point in own["special_points"]]
    assert ends == [(0, 0), (None, None)]


def test_a_person_is_told(contwalk, database):
    with open_database(database) as db:
        branch = db.branch("b1")
    rows = np.flatnonzero(branch["stable"] == -1)
    shown = contwalk("show", str(database)).out
    assert f"stability not known at {len(rows)} of {len(branch)} points" in " ".join(shown.split())
    assert "not known -> not known" in shown
    assert (
        "unstable directions: not known (stability not known)"
        in contwalk("show", str(database), f"b1/{rows[0]}").out
    )
    ax = plot_bifurcation_diagram([branch], "a", "x")
    styles = {text.get_text() for text in ax.get_legend().get_texts()}
    assert {"stable", "stability not known"} <= styles
    assert "unstable" not in styles
    plt.close(ax.figure)


def test_what_is_not_known_does_not_differ(contwalk, database):
    assert contwalk("continue", "coupled.yaml", "--quiet", "--no-figures", "--output", "other.h5").code == 0
    assert contwalk("diff", str(database), "other.h5").code == 0


def test_a_run_goes_on_to_the_same_bytes(contwalk, database, folder):
    # Of what is not known so much is carried on as was counted beside it.
    short = ["--set", "continue.max_points=70", "--output", "short.h5", "--quiet", "--no-figures"]
    assert contwalk("continue", "coupled.yaml", *short).code == 0
    assert (
        contwalk(
            "continue", "coupled.yaml", "--output", "short.h5", "--quiet", "--no-figures", "--resume"
        ).code
        == 0
    )
    with open_database(database) as one, open_database(folder / "short.h5") as other:
        rows = [np.sort(db.branch("b1").points, order="s") for db in (one, other)]
    for name in ("free", "state", "unstable", "undecided", "stable", "spectrum"):
        assert rows[0][name].tobytes() == rows[1][name].tobytes()
