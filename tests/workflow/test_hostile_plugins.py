"""Wrong plugins through the command line: a sentence with the line, never a traceback or a wrong number."""

from __future__ import annotations

import re

import numpy as np
import pytest
from hostile_plugins import HOSTILE, HYBRID, plugin

from contwalk.cli.entry import run
from contwalk.storage import open_database

CONTINUE = """\
contwalk: 1
system: ./wrong.py
start: {start}
continue: {{parameter: r, range: [0.5, 1.5], max_points: 4}}
diagram: none
output: wrong.h5
"""
SIMULATE = """\
contwalk: 1
system: ./wrong.py
start: {state: {x: 0.9, y: 0.1}}
simulate: {until: 1.0}
output: wrong.h5
"""
SMOOTH_START = "{state: {x: 1.0, y: 0.0}}"
HYBRID_START = "{simulate: {state: {x: 0.5, y: 0.5}, until: settled}}"

# Exit codes of `systems check`, `continue`, `simulate` where they are not 2: what is wrong is no part of what
# is computed, or is found only where the motion gets to.
OTHERS = {
    "interrupt at import": (130, 130, 130),
    "exit in an observable": (2, 1, 0),
    "observable of the wrong shape": (2, 1, 0),
    "observable gives text": (2, 1, 0),
    "observable raises": (2, 1, 0),
    "observable is NaN": (2, 0, 0),  # NaN is what is stored
    "division by zero at the start": (2, 1, 1),
    "infinity as a constant": (2, 1, 1),
    "time without a period": (2, 2, 0),
    "time without a period, with impacts": (2, 2, 0),
    "start of the wrong length": (2, 0, 0),
    "start raises": (2, 0, 0),
    "start gives None": (2, 0, 0),
    "start gives one number": (2, 0, 0),
    "reset divides by zero": (2, 1, 0),
    "guard that goes on": (0, 0, 0),  # a kick; a stop with the wrong sign looks the same, and is warned of
    "singular matrix": (2, 1, 0),
    "observable and state of one name": (0, 0, 0),  # its measure of the state
    "asserts what holds": (0, 0, 0),
    "NaN on a side that is not taken": (0, 0, 0),
    "a condition as a rate": (0, 0, 0),  # 1 where it holds, else 0, as NumPy has it
    # Each function has arrays of its own, so that these do no harm.
    "changes the state": (0, 0, 0),
    "observable changes the state": (0, 0, 0),
    "reset changes the state it gets": (0, 0, 0),
}
NO_LINE = ("SYSTEM", "interrupt", "no words", "null bytes")  # the file is said, or nothing is wrong with it


@pytest.mark.drawn(80)
@pytest.mark.parametrize("name", HOSTILE)
def test_wrong_plugin_is_told_with_its_line(name, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    start = HYBRID_START if HOSTILE[name][0] is HYBRID else SMOOTH_START
    (tmp_path / "wrong.py").write_text(plugin(name), encoding="utf-8")
    (tmp_path / "run.yaml").write_text(CONTINUE.format(start=start), encoding="utf-8")
    (tmp_path / "motion.yaml").write_text(SIMULATE, encoding="utf-8")
    commands = (
        ("systems", "check", "wrong.py"),
        ("continue", "run.yaml", "--no-figures"),
        ("simulate", "motion.yaml", "--no-figures", "--output", "motion.h5"),
    )
    codes = []
    for command in commands:
        capsys.readouterr()
        codes.append(run(command))
        said = "".join(capsys.readouterr())
        assert "Traceback" not in said
        assert "internal error" not in said
        assert "object at 0x" not in said
        if codes[-1] == 2 and not any(word in name for word in NO_LINE):
            assert re.search(r"wrong\.py(:|, line )\d+", said), said
    assert tuple(codes) == OTHERS.get(name, (2, 2, 2))
    if codes[1] == 2:
        assert not (tmp_path / "wrong.h5").exists()


def test_a_matrix_that_becomes_singular_is_named(tmp_path, monkeypatch, capsys):
    """The mass is drawn to where 0.6 - x^2 is zero: there the motion ends, and its line is told."""
    monkeypatch.chdir(tmp_path)
    told = "    dx[1] = np.linalg.solve([[1.0, 1.0], [1.0, 1.6 - x[0] ** 2]], np.array([-1.0, 1.0]) * x)[1]\n"
    old = "    dx[1] = p.r * math.cos(t) - 0.2 * x[1] - x[0]\n"
    source = HYBRID.replace(old, told).replace("1.0 - x[0]\n", "9.0 - x[0]\n")
    (tmp_path / "wrong.py").write_text(source, encoding="utf-8")
    line = source[: source.index(told)].count("\n") + 1
    (tmp_path / "motion.yaml").write_text(SIMULATE.replace("until: 1.0", "until: 9.0"), encoding="utf-8")
    assert run(("simulate", "motion.yaml", "--no-figures")) == 1
    said = "".join(capsys.readouterr())
    assert f"wrong.py, line {line}: the matrix of 2 rows is" in said


def test_functions_that_write_into_what_they_read_do_no_harm(tmp_path, monkeypatch, capsys):
    """x^2 = r though an observable overwrites x; (x + 1)^2 = r where the field adds 1 to its own x."""
    monkeypatch.chdir(tmp_path)
    for name, moved in (("observable changes the state", 0.0), ("changes the state", 1.0)):
        (tmp_path / "wrong.py").write_text(plugin(name), encoding="utf-8")
        (tmp_path / "run.yaml").write_text(CONTINUE.format(start=SMOOTH_START), encoding="utf-8")
        assert run(("continue", "run.yaml", "--no-figures", "--force")) == 0
        with open_database(tmp_path / "wrong.h5") as db:
            branch = db.branch("b1")
        # Newton's method ends at rounding, some 1e-16.
        assert np.allclose((branch["x"] + moved) ** 2, branch["r"], rtol=0.0, atol=1e-13)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        (
            "    x_plus[0] = x[0]\n",
            '    if x[1] > 0.1:\n        raise ValueError("broken stop")\n    x_plus[0] = x[0]\n',
            "line 14: ValueError: broken stop",
        ),
        ("-0.8 * x[1]", "-0.8 * x[1] / math.log(p.r)", "line 14: div of"),
    ],
)
def test_reset_without_a_result_is_told_with_what_it_raises(old, new, said, tmp_path, monkeypatch, capsys):
    """At r = 1 the mass reaches its stop with a speed above 0.1; log(1) is 0."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "wrong.py").write_text(HYBRID.replace(old, new), encoding="utf-8")
    run_file = CONTINUE.format(start=HYBRID_START)
    (tmp_path / "run.yaml").write_text(run_file, encoding="utf-8")
    assert run(("continue", "run.yaml", "--no-figures")) == 1
    assert f"The reset of transition 'hit': {tmp_path}/wrong.py, {said}" in capsys.readouterr().err
    simulate = SIMULATE.replace("until: 1.0", "until: 20.0")
    (tmp_path / "motion.yaml").write_text(simulate, encoding="utf-8")
    run(("simulate", "motion.yaml", "--no-figures"))
    assert f"wrong.py, {said}" in "".join(capsys.readouterr())
