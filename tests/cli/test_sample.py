"""`contwalk sample` in a folder of its own."""

from __future__ import annotations

import csv
import math
import re
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest

from contwalk.errors import PluginError
from contwalk.flow.ensemble import sampling as motions_in_threads
from contwalk.storage.trajectory import read_samples
from contwalk.workflow import sampling
from contwalk.workflow.run_file.sample import read_sampling
from contwalk.workflow.sampled_motions import measured_elsewhere
from contwalk.workflow.study_text import StudyText

# x' = -rate x from a drawn height: x passes `level` at log(height / level) / rate.
PLUGIN = """\
import math
from contwalk.system import Mode, Observable, Parameter, Start, State, Symmetry, System

def field(t, x, p, dx):
    dx[0] = -p.rate * x[0]
    dx[1] = -p.rate * math.sin(x[1] - p.place)

def mirror(t, x, p, x_image):
    x_image[0] = x[0]
    x_image[1] = 2.0 - x[1]

SYSTEM = System(
    name="falling",
    states=(State("x", scale=1.0), State("angle", "rad", scale=1.0, period=2 * math.pi)),
    parameters=(Parameter("rate", 1.0, "1/s", (0.0, None)), Parameter("place", 0.5), Parameter("level", 0.1)),
    modes=(Mode("free", field),),
    observables=(Observable("height", lambda t, x, p: x[:, 0].max()),),
    starts=(Start("rest", lambda p: [[0.0, p.place]] if p.place < 0.9 else [], exists="place < 0.9"),),
)
"""

RUN = """\
system: ./falling.py
start: {state: {x: 1.0, angle: 0.25}}
sample:
  count: 60
  seed: 5
  draw: {rate: [0.5, 4*level/0.2], x: [0.2, 10*level]}
  measure: {observable: height, level: level, direction: falling, crossing: last}
  settled: {equilibrium: rest, within: {x: 1e-3, angle: 0.01}}
  time_unit: {name: decays, length: 1/rate}
  until: 40
output: s.h5
"""


@pytest.fixture
def falling(folder):
    (folder / "falling.py").write_text(PLUGIN, encoding="utf-8")
    (folder / "s.yaml").write_text(RUN, encoding="utf-8")
    return folder


def test_motions_settle_on_the_equilibrium_that_a_start_is_a_guess_of(contwalk, falling):
    exact = contwalk("sample", "s.yaml", "--no-figures")
    assert exact.code == 0
    guess = PLUGIN.replace("[[0.0, p.place]]", "[[0.1, p.place + 0.2]]")
    (falling / "falling.py").write_text(guess, encoding="utf-8")
    guessed = contwalk("sample", "s.yaml", "--no-figures", "--force")
    assert guessed.code == 0
    assert guessed.out == exact.out  # corrected, the start is the same to rounding


def test_samples_are_measured_stored_drawn_and_told(contwalk, falling):
    done = contwalk("sample", "s.yaml")
    assert (done.code, done.err) == (0, "")
    assert {p.name for p in falling.glob("s_*")} == {"s_samples.h5", "s_samples.csv", "s_histogram.png"}
    stored = read_samples(falling / "s_samples.h5")
    assert stored.drawn == ("x", "rate")
    assert stored.measured == "decays"
    heights = stored.draws[:, 0]
    assert (heights >= 0.2).all()
    assert (heights < 1.0).all()
    assert ((stored.draws[:, 1] >= 0.5) & (stored.draws[:, 1] < 2.0)).all()
    # Tens of steps of local error 1e-8; the slope at the level is 0.1.
    np.testing.assert_allclose(stored.values, np.log(heights / 0.1), rtol=0, atol=1e-5)
    assert stored.settled.all()
    assert stored.crossed.all()
    mean, error = stored.values.mean(), stored.values.std(ddof=1) / math.sqrt(60)
    for words in (f"{mean:.8g}", f"{error:.3g}", "never settled", "in decays", "s_histogram.png"):
        assert words in done.out
    with (falling / "s_samples.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [float(row["decays"]) for row in rows] == stored.values.tolist()
    assert [float(row["x"]) for row in rows] == heights.tolist()
    assert {row["settled"] for row in rows} == {"true"}


def test_a_seed_gives_the_same_samples_whatever_their_number_and_that_of_threads(contwalk, falling):
    fewer = ("--jobs", "4", "--set", "sample.count=35")
    for name, options in {"a": ("--jobs", "1"), "b": fewer}.items():
        assert contwalk("sample", "s.yaml", *options, "--output", f"{name}.h5", "--quiet").code == 0
    a, b = (read_samples(falling / f"{name}_samples.h5") for name in "ab")
    np.testing.assert_array_equal(a.draws[:35], b.draws)
    np.testing.assert_array_equal(a.values[:35], b.values)
    np.testing.assert_array_equal(a.ends[:35], b.ends)
    contwalk("sample", "s.yaml", "--set", "sample.seed=6", "--output", "c.h5", "--quiet")
    assert not np.isin(read_samples(falling / "c_samples.h5").draws, a.draws).any()


class Backwards:
    """Computes the last part first, and each twice, as a cluster may that has lost a worker."""

    def map(self, function, tasks):
        found = {k: (function(task), function(task))[1] for k, task in reversed(list(enumerate(tasks)))}
        return [found[k] for k in sorted(found)]


def test_whatever_computes_the_parts_of_a_sampling_leaves_the_same_table(contwalk, falling, monkeypatch):
    assert contwalk("sample", "s.yaml", "--quiet", "--set", "sample.draw.place=[0.5, 1.0]").code == 0
    whole = (falling / "s_samples.csv").read_bytes()
    a = read_samples(falling / "s_samples.h5")
    monkeypatch.setattr(sampling, "PART", 17)
    told = []
    run = read_sampling("s.yaml", ("sample.draw.place=[0.5, 1.0]",))
    found = sampling.sample(run, executor=Backwards(), force=True, figures=False, progress=told.append)
    assert told == [17, 17, 17, 9]
    assert found.summary.without_equilibrium > 0
    assert (falling / "s_samples.csv").read_bytes() == whole
    b = read_samples(falling / "s_samples.h5")
    for name in ("draws", "values", "settled", "crossed", "ends"):
        assert getattr(a, name).tobytes() == getattr(b, name).tobytes(), name


FILES = "s_samples.h5", "s_samples.csv"
# Ends the process, as a kill would, when so many lines of what was found are on the disk, and a part of one.
KILLED = """\
import os, sys
from contwalk.storage.journal import Journal
from contwalk.flow.ensemble import sampling as motions
from contwalk.workflow import kept_motions
motions.BATCH, kept_motions.GATHERED = 7, 0.0
add, left = Journal.add, [int(sys.argv[1])]
def adds(self, entry):
    if left[0] < 0:
        self._file.write(b'00000000 {'); self._file.flush(); os.kill(os.getpid(), 9)
    left[0] -= 1; add(self, entry)
Journal.add = adds
from contwalk.cli.entry import run; run(('sample', 's.yaml', '--no-figures', '--jobs', sys.argv[2]))
"""


@pytest.mark.parametrize(("kept", "jobs"), [(0, "1"), (3, "2")])
def test_a_sampling_that_was_killed_goes_on_to_the_same_bytes(contwalk, falling, kept, jobs, monkeypatch):
    assert contwalk("sample", "s.yaml", "--no-figures").code == 0
    whole = [(falling / name).read_bytes() for name in FILES]
    for name in FILES:
        (falling / name).unlink()
    killed = subprocess.run([sys.executable, "-c", KILLED, str(kept), jobs], cwd=falling, check=False)
    assert killed.returncode == -9
    again = contwalk("sample", "s.yaml", "--no-figures")
    assert again.code == 2
    assert "--resume" in again.err
    computed, measured = [], sampling.measured

    def counted(run, draws, *others):
        computed.append(len(draws.values))
        return measured(run, draws, *others)

    monkeypatch.setattr(sampling, "measured", counted)
    assert contwalk("sample", "s.yaml", "--no-figures", "--resume").code == 0
    assert computed == [60 - 7 * kept]
    assert [(falling / name).read_bytes() for name in FILES] == whole
    assert not (falling / "s_samples.journal").exists()


@pytest.mark.parametrize("elsewhere", [False, True])
def test_what_is_interrupted_keeps_all_that_is_done(contwalk, falling, elsewhere, monkeypatch):
    assert contwalk("sample", "s.yaml", "--no-figures").code == 0
    whole = [(falling / name).read_bytes() for name in FILES]
    monkeypatch.setattr(sampling, "PART", 17)
    monkeypatch.setattr(motions_in_threads, "BATCH", 17)
    counts = []

    def stopped(count):
        counts.append(count)
        if len(counts) == 2:
            raise KeyboardInterrupt

    run = read_sampling("s.yaml")
    how = {"threads": 1, "executor": Backwards() if elsewhere else None, "figures": False}
    with pytest.raises(KeyboardInterrupt):
        sampling.sample(run, force=True, progress=stopped, **how)
    counts.clear()
    result = sampling.sample(run, resume=True, progress=counts.append, **how)
    assert counts == [34, 17, 9]
    assert [file.read_bytes() for file in result.files] == whole


def test_what_goes_on_elsewhere_says_so_and_goes_on(contwalk, falling, monkeypatch):
    def stopped(*others):
        raise KeyboardInterrupt

    given = ("sample", "s.yaml", "--no-figures")
    with monkeypatch.context() as patched:
        patched.setattr(sampling, "versions_and_processor", lambda: {"processor": "another"})
        patched.setattr(sampling, "measured", stopped)
        assert contwalk(*given).code == 130
    done = contwalk(*given, "--resume")
    assert done.code == 0
    assert "note: What is stored was made elsewhere (processor another, now " in done.out.replace("\n", " ")


def test_a_second_run_into_the_same_journal_is_refused(contwalk, falling):
    given, refused = ("sample", "s.yaml", "--no-figures", "--quiet"), []

    def meanwhile(count):
        refused.append([contwalk(*given, flag) for flag in ("--resume", "--force")])

    sampling.sample(read_sampling("s.yaml"), figures=False, progress=meanwhile)
    for done in refused[0]:
        assert done.code == 2
        assert "another process writes it" in done.err


def test_ctrl_c_tells_how_to_go_on(contwalk, falling, monkeypatch):
    def stopped(*others):
        raise KeyboardInterrupt

    given = ("sample", "s.yaml", "--no-figures", "--set", "sample.seed=4")
    with monkeypatch.context() as patched:
        patched.setattr(sampling, "measured", stopped)
        done = contwalk(*given, "--jobs", "2")
    assert done.code == 130
    again = done.err.splitlines()[-1].strip()
    assert again == "contwalk sample s.yaml --set sample.seed=4 --jobs 2 --resume --no-figures"
    other = contwalk("sample", "s.yaml", "--resume")
    assert other.code == 2
    assert "what differs: sample." in other.err
    both = contwalk(*given, "--resume", "--force")
    assert both.code == 2
    assert "Give one of them" in both.err
    assert contwalk(*again.split()[1:]).code == 0
    finished = contwalk(*given, "--resume")
    assert finished.code == 2
    assert "There is nothing to go on with" in finished.err


def test_another_plugin_where_motions_are_computed_is_refused(contwalk, falling):
    study = replace(StudyText.of(read_sampling("s.yaml")), source="another")
    with pytest.raises(PluginError, match="not the one that the run began with"):
        measured_elsewhere(study, range(3))


def test_what_never_settles_or_never_crosses_is_counted(contwalk, falling):
    done = contwalk("sample", "s.yaml", "--set", "sample.until=3", "--set", "sample.draw.x=[0.05, 0.9]")
    stored = read_samples(falling / "s_samples.h5")
    assert not stored.settled.any()
    assert stored.ends == pytest.approx(3.0)
    below = stored.draws[:, 0] < 0.1
    assert below.any()
    np.testing.assert_array_equal(stored.crossed, ~below)
    assert (stored.values[below] == 0.0).all()  # beyond the level all along
    assert re.search(r"never settled +60\n", done.out)
    assert re.search(rf"never crossed +{below.sum()}\n", done.out)
    contwalk("sample", "s.yaml", "--force", "--set", "sample.measure.crossing=first",
             "--set", "sample.draw.x=[0.05, 0.9]")  # fmt: skip
    first = read_samples(falling / "s_samples.h5")
    assert np.isnan(first.values[below]).all()
    assert np.isfinite(first.values[~below]).all()


# y' = y^3 - y ends at infinity from |y| > 1, at ln(y^2 / (y^2 - 1)) / 2; x passes its level whatever y does.
EXPLODING = """\
from contwalk.system import Mode, Observable, Parameter, Start, State, System

def field(t, x, p, dx):
    dx[0] = -x[0]
    dx[1] = x[1] ** 3 - x[1]

SYSTEM = System(
    name="exploding",
    states=(State("x", scale=1.0), State("y", scale=1.0)),
    parameters=(Parameter("level", 0.5),),
    modes=(Mode("free", field),),
    observables=(Observable("height", lambda t, x, p: x[:, 0].max()),),
    starts=(Start("rest", lambda p: [[0.0, 0.0]]),),
)
"""
EXPLODING_RUN = """\
system: ./exploding.py
start: {state: {x: 1.0, y: 0.0}}
sample:
  count: 80
  seed: 2
  draw: {x: [1, 3], y: [-1.5, 1.5]}
  measure: {observable: height, level: level, direction: falling, crossing: last}
  settled: {equilibrium: rest, within: {x: 1e-3, y: 1e-3}}
  until: 40
output: e.h5
"""


def test_motions_that_blow_up_are_in_no_mean(contwalk, folder):
    """Some of them have crossed the level before: their numbers are left out all the same."""
    (folder / "exploding.py").write_text(EXPLODING, encoding="utf-8")
    (folder / "e.yaml").write_text(EXPLODING_RUN, encoding="utf-8")
    done = contwalk("sample", "e.yaml", "--no-figures")
    stored = read_samples(folder / "e_samples.h5")
    x, y = (stored.draws[:, stored.drawn.index(name)] for name in "xy")
    lost = np.abs(y) > 1.0
    crossing = np.log(x / 0.5)
    with np.errstate(invalid="ignore", divide="ignore"):
        blown = np.where(lost, 0.5 * np.log(y**2 / (y**2 - 1.0)), np.inf)
    assert 5 < lost.sum() < 40
    assert (crossing < blown - 0.1)[lost].any()  # without these a mean of all would be no other one
    assert np.isnan(stored.values[lost]).all()
    # Tens of steps of local error 1e-8; the slope at the level is 0.5.
    np.testing.assert_allclose(stored.values[~lost], crossing[~lost], rtol=0, atol=1e-6)
    assert not stored.settled[lost].any()
    assert (done.code, done.err.count("could not be integrated")) == (1, 1)
    assert f"{lost.sum()} motions could not be integrated" in done.err
    assert re.search(rf"failed +{lost.sum()}\n", done.out)
    (mean,) = re.findall(r"mean +([0-9.]+)\n", done.out)
    assert float(mean) == pytest.approx(crossing[~lost].mean(), abs=1e-6)
    assert abs(float(mean) - crossing[np.isfinite(crossing)].mean()) > 1e-3  # not that of all


def test_samples_without_their_equilibrium_never_settle_and_are_told(contwalk, falling):
    done = contwalk("sample", "s.yaml", "--set", "sample.draw.place=[0.5, 1.3]")
    stored = read_samples(falling / "s_samples.h5")
    without = stored.draws[:, stored.drawn.index("place")] >= 0.9
    np.testing.assert_array_equal(stored.settled, ~without)
    assert done.code == 0
    assert "no equilibrium rest there" in done.out


def test_images_under_a_renaming_are_places_to_rest(contwalk, falling):
    # `rest` is said to be at 2 - place; the motion comes to rest at its image, which is `place`.
    both = "math.sin(x[1] - p.place) * math.sin(x[1] - 1.0) * math.sin(x[1] - 2.0 + p.place) * 4.0"
    renamed = PLUGIN.replace("math.sin(x[1] - p.place)", both).replace(
        "[[0.0, p.place]]", "[[0.0, 2.0 - p.place]]"
    )
    renamed = renamed.replace(
        "    starts=", '    symmetries=(Symmetry("swap", "relabel", mirror),),\n    starts='
    )
    (falling / "falling.py").write_text(renamed)
    assert contwalk("sample", "s.yaml").code == 0
    assert read_samples(falling / "s_samples.h5").settled.all()


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ("sample=null", "key sample: the key is missing"),
        ("sample.count=0", "from 1 to 10000000"),
        ("sample.draw={}", "draws nothing"),
        ("sample.draw.z=[0, 1]", "neither a state nor a parameter"),
        ("sample.draw.x=[1, 1]", "is empty: [1, 1]"),
        ("sample.draw.x=[0, rate]", "depends on 'rate', which is drawn too"),
        ("sample.draw.rate=[-1, 1]", "-1 lies outside the bounds of 'rate'"),
        ("sample.draw.x=[0, 2+3]", "'2+3' is no factor"),
        ("sample.draw.x=[0, 2*levle]", "Did you mean 'level'"),
        ("sample.draw.x=3", "Allowed: [lowest, highest]"),
        ("sample.measure.observable=hight", "Did you mean 'height'"),
        ("sample.measure.level=1/0", "not finite"),
        ("sample.measure.direction=up", "Allowed: falling, rising"),
        ("sample.settled.equilibrium=rset", "Did you mean 'rest'"),
        ("sample.settled.within={}", "names no state"),
        ("sample.settled.within.y=1", "'y' is not a state"),
        ("sample.settled.within.x=0", "a positive number"),
        ("sample.time_unit.length=-1", "Allowed: what is positive"),
        ("sample.until=0", "a positive number"),
    ],
)
def test_bad_input_is_a_sentence_and_writes_nothing(contwalk, falling, change, said):
    done = contwalk("sample", "s.yaml", "--set", change)
    assert done.code == 2
    assert said in done.err
    assert not list(falling.glob("s_*"))


def test_a_sampling_is_no_study_for_continue(contwalk, falling):
    done = contwalk("continue", "s.yaml")
    assert done.code == 2
    assert "continue.parameter" in done.err


def test_one_job_unless_more_are_asked_for():
    from contwalk.cli.sample_command import command

    (jobs,) = [option for option in command.params if option.name == "jobs"]
    assert jobs.default == 1
