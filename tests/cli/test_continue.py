"""`contwalk continue`: the summary, the options, exit codes, interruption and resumption."""

from __future__ import annotations

import json
import re
import shlex
import shutil
import threading

import numpy as np
import pytest

from contwalk.branch import Branch, BranchInfo, Outcome, SpecialPoint
from contwalk.cli import progress
from contwalk.storage import hdf5, open_database
from contwalk.workflow import runner


def test_summary(contwalk, folder):
    done = contwalk("continue", "run.yaml")
    assert done.code == 0
    assert done.err == ""  # no progress where nobody watches
    lines = [line.strip() for line in done.out.splitlines()]
    assert lines[0] == "fork"
    assert any(line.startswith("b1  equilibrium, r from -1 to 1, ") for line in lines)
    bp = next(line for line in lines if line.startswith("BP1 "))
    assert "branch point (pitchfork)" in bp
    assert "supercritical" in bp
    assert bp.endswith("0 -> 1")
    assert "database: fork.h5" in lines
    assert "next:     contwalk show fork.h5 b1/BP1" in lines
    assert "contwalk plot fork.h5 -o fork.png" in lines
    assert not any(line != line.rstrip() for line in done.out.splitlines())


def test_values_have_all_their_digits(contwalk):
    done = contwalk("continue", "run.yaml", "--set", "continue.range=[-1.0, 0.1234567890123456]")
    assert "0.1234567890123456 " in done.out


def test_quiet(contwalk, folder):
    done = contwalk("continue", "run.yaml", "--quiet")
    assert (done.code, done.out, done.err) == (0, "", "")
    assert (folder / "fork.h5").is_file()


def test_set_and_output(contwalk, folder):
    done = contwalk("continue", "run.yaml", "--set", "parameters.a=2.5", "--output", "other.h5")
    assert done.code == 0
    assert not (folder / "fork.h5").exists()
    with open_database(folder / "other.h5") as db:
        assert db.branch("b1").info.parameters["a"] == 2.5


@pytest.mark.parametrize("output", [".", "..", "/"])
@pytest.mark.parametrize("command", ["continue", "simulate", "tradeoff"])
def test_an_output_that_is_no_name_of_a_file(contwalk, command, output):
    done = contwalk(command, "run.yaml", "--output", output)
    assert done.code == 2
    assert f"error: {output} is a directory. Name a file in it, such as run.h5." in done.err


def test_a_database_that_is_in_the_current_directory_is_found(contwalk, folder):
    """Runs write to the current directory; names in run files are relative to the file, and else to that."""
    (folder / "runs").mkdir()
    for name in ("run.yaml", "fork.py"):
        shutil.copy(folder / name, folder / "runs")
    assert contwalk("continue", "runs/run.yaml", "--quiet").code == 0
    again = ("continue", "runs/run.yaml", "--quiet", "--set", "start={from: fork.h5, point: b1/0}")
    done = contwalk(*again)
    assert done.code == 2
    assert "key output: 'fork.h5' is the database that a start is taken from." in done.err
    assert contwalk(*again, "--output", "other.h5").code == 0


def test_output_that_exists(contwalk, folder):
    contwalk("continue", "run.yaml")
    first = (folder / "fork.h5").read_bytes()
    done = contwalk("continue", "run.yaml")
    assert done.code == 2
    assert "--resume" in done.err
    assert "--force" in done.err
    assert (folder / "fork.h5").read_bytes() == first
    assert contwalk("continue", "run.yaml", "--force").code == 0
    assert contwalk("continue", "run.yaml", "--resume").code == 0


def test_figures(contwalk, folder):
    done = contwalk("continue", "run.yaml", "--set", "figures=[bifurcation_diagram]")
    figure = folder / "fork_bifurcation_diagram.png"
    assert figure.read_bytes().startswith(b"\x89PNG")
    assert f"figure:   {figure.name}" in done.out
    figure.unlink()
    again = contwalk(
        "continue", "run.yaml", "--set", "figures=[bifurcation_diagram]", "--force", "--no-figures"
    )
    assert not figure.exists()
    assert "figure:" not in again.out


def test_a_figure_that_the_run_file_names_is_nobody_elses(contwalk, folder):
    figures = ("--set", "figures=[bifurcation_diagram, {bifurcation_diagram: {file: mine.svg}}]")
    own, named = folder / "fork_bifurcation_diagram.png", folder / "mine.svg"
    own.write_text("left by a run whose database was deleted", encoding="utf-8")
    named.write_text("a drawing of somebody's", encoding="utf-8")
    done = contwalk("continue", "run.yaml", *figures)
    assert (done.code, done.out) == (2, "")
    assert done.err == "error: mine.svg exists. Replace it with --force, or choose another output.\n"
    assert not (folder / "fork.h5").exists()
    assert contwalk("continue", "run.yaml", *figures, "--no-figures", "--quiet").code == 0
    assert named.read_text(encoding="utf-8") == "a drawing of somebody's"
    named.unlink()
    # What bears the output's name goes with it; where the database is replaced or goes on, so do its figures.
    assert contwalk("continue", "run.yaml", *figures, "--force", "--quiet").code == 0
    assert own.read_bytes().startswith(b"\x89PNG")
    for option in ("--resume", "--force"):
        named.write_text("an earlier drawing", encoding="utf-8")
        assert contwalk("continue", "run.yaml", *figures, option, "--quiet").code == 0
        assert "<svg" in named.read_text(encoding="utf-8")


def test_sweep_names_the_swept_value(contwalk):
    done = contwalk("continue", "run.yaml", "--set", "sweep={a: [0.5, 0.75]}")
    lines = [line.strip() for line in done.out.splitlines()]
    assert "a = 0.5" in lines
    assert "a = 0.75" in lines


def test_failed_branch(contwalk, folder):
    # The square root ends the field at r = 0.5.
    plugin = (folder / "fork.py").read_text(encoding="utf-8")
    (folder / "fork.py").write_text(
        plugin.replace("p.a - x[1]", "p.a - x[1] + (0.5 - p.r) ** 0.5"), encoding="utf-8"
    )
    done = contwalk("continue", "run.yaml", "--quiet", "--set", "start={state: {x: 0, y: 1.25}}")
    assert done.code == 1
    assert done.err.startswith("error: branch b1 failed (")
    assert done.out == ""
    with open_database(folder / "fork.h5") as db:
        assert len(db.branch("b1")) > 3


def test_a_failed_start_is_told_once_and_recommends_nothing(contwalk, folder):
    plugin = (folder / "fork.py").read_text(encoding="utf-8")
    (folder / "fork.py").write_text(
        plugin.replace("p.a - x[1]", "p.a - x[1] + (-1.0 - p.r) ** 0.5"), encoding="utf-8"
    )
    done = contwalk("continue", "run.yaml", "--set", "start={state: {x: 0, y: 1.25}}")
    assert done.code == 1
    assert done.err.startswith("error: branch b1 failed (not_finite): The start fails: ")
    assert "failed (not_finite): see the error below" in done.out
    assert "The start fails" not in done.out
    assert "next:" not in done.out
    assert "The start fails" in " ".join(contwalk("show", "fork.h5").out.split())


class Interrupting(progress.NoteKeeper):
    """Somebody presses Ctrl-C at the fifth point."""

    def point(self, info, parameter, step, unstable, number):
        if number == 5:
            raise KeyboardInterrupt


def test_ctrl_c_and_the_command_that_resumes(contwalk, folder, monkeypatch):
    options = ["--set", "continue.range=[-1, 1.5]", "--output", "my run.h5"]
    whole = contwalk("continue", "run.yaml", *options[:2], "--output", "whole.h5")
    assert whole.code == 0
    with monkeypatch.context() as patched:
        patched.setattr(progress, "reporter_for", lambda ends, quiet: Interrupting())
        done = contwalk("continue", "run.yaml", *options, "--quiet", "--force")
    assert done.code == 130
    assert "Interrupted" in done.err
    command = done.err.splitlines()[-1].strip()
    assert "'continue.range=[-1, 1.5]'" in command
    assert "--force" not in command
    words = shlex.split(command)
    assert words[0] == "contwalk"
    with open_database(folder / "my run.h5") as db:
        assert db.branch("b1").outcome.reason == "interrupted"
        assert len(db.branch("b1")) == 5
    assert contwalk(*words[1:]).code == 0
    with open_database(folder / "my run.h5") as db, open_database(folder / "whole.h5") as other:
        assert [b.name for b in db.branches()] == [b.name for b in other.branches()]
        for mine, theirs in zip(db.branches(), other.branches(), strict=True):
            assert np.array_equal(mine.points["free"], theirs.points["free"])


def test_ctrl_c_outside_the_computing(contwalk, monkeypatch):
    def interrupted(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr(runner, "run", interrupted)
    done = contwalk("continue", "run.yaml")
    assert (done.code, done.err.strip()) == (130, "Interrupted.")


def fake_result(folder, **special):
    info = BranchInfo("b1", "equilibrium", ("x",), (), ("r",), {"r": 0.0}, 1, 1)
    points = np.zeros(2, info.point_dtype())
    point = SpecialPoint("HB", 1.0, name="HB1", index=1, parameters={"r": 0.5}, **special)
    branch = Branch(info, points, [point], Outcome("complete", "bound", "Done."))
    return runner.RunResult(folder / "fork.h5", [branch])


def test_strict(contwalk, folder, monkeypatch):
    result = fake_result(folder, status="unlocated", note="two pairs cross at once")
    monkeypatch.setattr(runner, "run", lambda *_, **__: result)
    relaxed = contwalk("continue", "run.yaml")
    assert relaxed.code == 0
    assert "Hopf point, NOT LOCATED" in relaxed.out
    assert "HB1: two pairs cross at once" in relaxed.out
    strict = contwalk("continue", "run.yaml", "--strict", "--quiet")
    assert strict.code == 1
    assert "b1/HB1" in strict.err
    monkeypatch.setattr(runner, "run", lambda *_, **__: fake_result(folder))
    assert contwalk("continue", "run.yaml", "--strict").code == 0


def test_notes_are_told(contwalk, folder, monkeypatch):
    def noting(run_file, *, reporter, **_):
        reporter.note("The start 'tilted' does not exist.")
        reporter.note("The start 'tilted' does not exist.")
        return fake_result(folder)

    monkeypatch.setattr(runner, "run", noting)
    assert contwalk("continue", "run.yaml").out.count("note: The start 'tilted' does not exist.") == 1


@pytest.mark.parametrize(
    ("watched", "quiet", "live"), [(True, False, True), (True, True, False), (False, False, False)]
)
def test_progress_only_where_somebody_watches(monkeypatch, watched, quiet, live):
    for stream in (progress.sys.stdout, progress.sys.stderr):
        monkeypatch.setattr(stream, "isatty", lambda: watched, raising=False)
    assert isinstance(progress.reporter_for((0.0, 1.0), quiet), progress.ProgressLine) is live


def test_a_line_a_minute_where_nobody_watches_a_terminal(capsys):
    info = BranchInfo("b1", "equilibrium", ("x",), (), ("r",), {"r": 0.0}, 1, 1, origin="[upright]")
    found, told = threading.Event(), threading.Event()
    minutes = 0

    def wait(seconds: float) -> bool:
        nonlocal minutes
        assert seconds == 60.0
        minutes += 1
        if minutes == 2:  # the first line is there; the points of the second minute are found
            told.set()
            assert found.wait(30.0)
        return minutes > 3

    with progress.LineAMinute(wait) as reporter:
        assert told.wait(30.0)
        reporter.branch_began(info)
        for number in range(1, 4):
            reporter.point(info, 0.25 * number, 0.01, 2, number)
        found.set()
        reporter._teller.join(30.0)
    assert capsys.readouterr().err.splitlines() == [
        "1 min: no point yet, 0 points a minute, branches done: 0",
        "2 min: b1  r = 0.75  point 3, 3 points a minute, branches done: 0",
        "3 min: b1  r = 0.75  point 3, 0 points a minute, branches done: 0",
    ]


def test_a_run_that_is_to_be_quiet_tells_no_minutes(monkeypatch):
    for stream in (progress.sys.stdout, progress.sys.stderr):
        monkeypatch.setattr(stream, "isatty", lambda: False, raising=False)
    assert type(progress.reporter_for((0.0, 1.0), True)) is progress.NoteKeeper
    assert type(progress.reporter_for((0.0, 1.0), False)) is progress.LineAMinute


def test_progress_line_says_where_the_run_is(monkeypatch):
    info = BranchInfo("b1", "equilibrium", ("x",), (), ("r",), {"r": 0.0}, 1, 1, origin="[upright]")
    with progress.ProgressLine((-1.0, 1.0)) as reporter:
        reporter.branch_began(info)
        reporter.point(info, -0.5, 0.01, 2, 1)
        reporter.point(info, 0.5, 0.02, 3, 2)
        (task,) = reporter._progress.tasks
        assert task.description == "b1  r = 0.5  step 2.0e-02  unstable 3  point 2"
        assert task.completed == 0.5  # from -0.5 to 0.5 of a range of 2
        reporter.branch_began(info)
        assert len(reporter._progress.tasks) == 1


def test_json_of_a_run_is_the_documents(contwalk):
    contwalk("continue", "run.yaml")
    shown = json.loads(contwalk("show", "fork.h5", "--json").out)
    assert [p["label"] for p in shown["branches"][0]["special_points"]] == ["EP", "BP", "EP"]


def test_figures_bear_the_whole_name_of_an_output_with_another_suffix(contwalk, folder):
    figures = ("--set", "figures=[bifurcation_diagram]", "--quiet")
    assert contwalk("continue", "run.yaml", *figures).code == 0
    first = (folder / "fork_bifurcation_diagram.png").read_bytes()
    other = (*figures, "--set", "parameters.a=3.0", "--set", "continue.range=[-0.5, 0.5]")
    assert contwalk("continue", "run.yaml", *other, "--output", "fork.txt").code == 0
    assert (folder / "fork_bifurcation_diagram.png").read_bytes() == first
    assert (folder / "fork.txt_bifurcation_diagram.png").is_file()


def test_a_start_that_fails_has_no_figure_and_nothing_to_plot(contwalk, folder):
    plugin = folder / "fork.py"
    plugin.write_text(
        plugin.read_text(encoding="utf-8").replace("x[:, 0].max()", "x[:, 0]"), encoding="utf-8"
    )
    done = contwalk("continue", "run.yaml", "--set", "figures=[bifurcation_diagram]")
    assert done.code == 1
    assert re.search(r"fork\.py, line \d+: TypeError", done.err)  # the observable's own line
    assert "note: No branch has a point, so no figure was drawn." in done.out
    assert "contwalk plot" not in done.out
    assert not list(folder.glob("*.png"))


def test_notes_of_finished_branches_are_told_again_by_resume(contwalk):
    mark = ("--set", "mark={height: [0.5]}", "--set", "diagram={follow: [BP]}")
    first = contwalk("continue", "run.yaml", *mark)
    notes = [line for line in first.out.splitlines() if line.startswith("note: ")]
    with open_database("fork.h5") as db:
        stored = db.notes()
    with hdf5.Hdf5Database.open("fork.h5", writable=True) as db:
        db.write_note("method b1", "b1: integrated by dop853.")
    again = contwalk("continue", "run.yaml", *mark, "--resume")
    told = [line for line in again.out.splitlines() if line.startswith("note: ")]
    assert set(notes) == {f"note: {text}" for text in stored.values()}
    assert sorted(told) == sorted([*notes, "note: b1: integrated by dop853."])


ROOTS = """\
from contwalk.system import Mode, Parameter, State, System

def field(t, x, p, dx):
    dx[0] = p.c + 0.1 * p.r - x[0] ** 2

SYSTEM = System(
    name="roots",
    states=(State("x", unit="1", about="root"),),
    parameters=(Parameter("r", 0.0, unit="1", about="shift"), Parameter("c", 1.0, unit="1", about="square")),
    modes=(Mode("only", field),),
)
"""


@pytest.mark.parametrize(("values", "told"), [("[1.0, -1.0, -2.0]", "at c = -1, -2."), ("[-1.0, -2.0]", "")])
def test_values_of_a_sweep_at_which_the_start_leads_nowhere_are_told(contwalk, folder, values, told):
    (folder / "roots.py").write_text(ROOTS, encoding="utf-8")
    (folder / "roots.yaml").write_text(
        "system: ./roots.py\nstart: {state: {x: 1.0}}\ncontinue: {parameter: r, range: [-0.5, 0.5]}\n"
        f"sweep: {{c: {values}}}\n",
        encoding="utf-8",
    )
    done = contwalk("continue", "roots.yaml")
    assert done.code == 1
    said = [line for line in done.out.splitlines() if "begins from the same start" in line]
    assert len(said) == bool(told)
    assert all(told in line and "point: b1/0" in line for line in said)
    given = ("--set", "sweep=null", "--set", "start={from: roots.h5, point: b1/0}")
    given += ("--set", "parameters={c: 1.5}", "--output", "more.h5")
    if told:
        assert contwalk("continue", "roots.yaml", *given).code == 0


def test_a_resume_that_is_refused_leaves_the_file_alone(contwalk, folder):
    contwalk("continue", "run.yaml")
    before = (folder / "fork.h5").read_bytes()
    done = contwalk("continue", "run.yaml", "--resume", "--set", "parameters.a=0.5")
    assert done.code == 2
    assert "another run file" in done.err
    assert (folder / "fork.h5").read_bytes() == before


def test_force_does_not_replace_the_plugin(contwalk, folder):
    before = (folder / "fork.py").read_bytes()
    done = contwalk("continue", "run.yaml", "--force", "--output", "fork.py")
    assert done.code == 2
    assert "key output: 'fork.py' is the plugin." in done.err
    assert (folder / "fork.py").read_bytes() == before


@pytest.mark.parametrize("command", ["continue", "simulate"])
def test_a_start_from_a_database_that_is_none_is_told_with_its_place(contwalk, folder, command):
    (folder / "text.h5").write_text("hello")
    for name, why in {"no.h5": "does not exist", "text.h5": "not a contwalk database"}.items():
        done = contwalk(command, "run.yaml", "--set", f"start={{from: {name}, point: b1/LP1}}")
        assert done.code == 2
        assert "run.yaml with --set start=" in done.err
        assert f"key start: {name} " in done.err
        assert why in done.err


def test_where_no_file_can_be_the_disk_is_not_called_full(contwalk):
    done = contwalk("continue", "run.yaml", "--output", "/proc/fork.h5")
    assert done.code == 2
    assert "full" not in done.err
    assert "/proc/fork.h5 cannot be created: No such file or directory." in done.err


def test_what_a_plugin_raises_at_import_is_a_sentence(contwalk, folder):
    (folder / "fork.py").write_text("x = = 1\n")
    done = contwalk("continue", "run.yaml")
    assert done.code == 2
    assert "fork.py, line 1: SyntaxError: invalid syntax. The plugin file" in done.err
    (folder / "bare").mkdir()
    done = contwalk("continue", "run.yaml", "--set", "system=./bare")
    assert "bare is a directory, not a plugin file." in done.err
