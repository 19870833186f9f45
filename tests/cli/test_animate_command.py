"""`contwalk animate`, and the figures of single orbits: stick figures and time series."""

from __future__ import annotations

import drawn_circle
import numpy as np
import pytest
from PIL import Image

from contwalk.workflow.stored import orbits as stored_orbits

pytestmark = pytest.mark.slow

WHEEL = """\
import math
from dataclasses import replace

from contwalk_systems.rimless_wheel import SYSTEM as WHEEL


def draw(axes, t, x, p, so_far=None):
    times = [] if so_far is None else so_far[0].tolist()
    steps = sum(after == before for before, after in zip(times[:-1], times[1:]))
    foot = 2.0 * p.l * math.sin(p.a) * steps
    axes.plot([foot, foot + p.l * math.sin(x[0])], [0.0, p.l * math.cos(x[0])], label="spoke", gid="spoke")
    axes.set_xlim(foot - 1.5, foot + 1.5)
    axes.set_ylim(-0.2, 1.4)


SYSTEM = replace(WHEEL, name="wheel", draw=draw)
"""

RUN = """\
contwalk: 1
system: ./wheel.py
parameters: {gamma: 0.1}
start: {simulate: {state: {theta: -0.2, omega_: 1.5}, until: settled}}
continue: {parameter: gamma, range: [0.08, 0.12], direction: forward, max_points: 4}
diagram: none
output: wheel.h5
"""


@pytest.fixture
def wheel(kept_study_of):
    """Orbits with one heel strike."""
    return kept_study_of("wheel", WHEEL, RUN)


@pytest.fixture
def wheel_alone(study_of):
    """The same, whose plugin no other test reads."""
    return study_of("wheel", WHEEL, RUN)


@pytest.fixture
def circle(kept_study_of):
    """An equilibrium, and circles of period 2 pi."""
    return kept_study_of("circle", drawn_circle.PLUGIN, drawn_circle.STUDY + "figures: [stick_figure]\n")


def frames(path):
    with Image.open(path) as image:
        return image.n_frames


def test_a_gait_is_played(contwalk, wheel, folder):
    done = contwalk("animate", "--trust", wheel, "b1/0", "-o", "gait.gif", "--fps", "10", "--periods", "2")
    assert (done.code, done.err) == (0, "")
    assert done.out == "Wrote gait.gif: 15 frames, 2 periods of 0.7548 s in 1.5 s.\n"
    assert frames(folder / "gait.gif") == 15


def test_a_smooth_orbit_is_played_as_a_page(contwalk, circle, folder):
    done = contwalk("animate", "--trust", circle, "b2/EP1", "-o", "turn.html", "--fps", "2", "--slow", "0.5")
    assert done.code == 0
    assert done.out.startswith("Wrote turn.html: 6 frames, 1 period of 6.283 s in 3 s.")
    text = (folder / "turn.html").read_text(encoding="utf-8")
    assert 'max="5"' in text


def test_a_mode_is_shown_beside_it(contwalk, wheel, circle, folder):
    done = contwalk(
        "animate", "--trust", wheel, "b1/0", "-o", "mode.gif", "--fps", "5", "--mode", "1", "--periods", "2"
    )
    assert (done.code, done.err) == (0, "")
    assert "2 periods of 0.7548 s in 1.6 s, beside it mode 1: multiplier 0." in done.out
    assert frames(folder / "mode.gif") == 8
    given = ("--fps", "2", "--mode", "1", "--amplitude", "0.5")
    assert contwalk("animate", "--trust", circle, "b2/EP1", "-o", "mode.html", *given).code == 0


def test_quiet(contwalk, wheel):
    done = contwalk("animate", "--trust", wheel, "b1/EP1", "-o", "gait.gif", "--fps", "2", "--quiet")
    assert (done.code, done.out, done.err) == (0, "", "")


def test_a_file_that_exists_is_replaced_only_with_force(contwalk, wheel, folder):
    (folder / "gait.gif").write_bytes(b"mine")
    given = ("animate", "--trust", wheel, "b1/0", "-o", "gait.gif", "--fps", "2")
    done = contwalk(*given)
    assert done.code == 2
    assert done.err == "error: gait.gif exists. Replace it with --force, or choose another output.\n"
    assert (folder / "gait.gif").read_bytes() == b"mine"
    assert contwalk(*given, "--force").code == 0
    assert frames(folder / "gait.gif") == 2


@pytest.mark.parametrize(
    ("point", "options", "said"),
    [
        ("b1/HB1", ("-o", "a.gif"), "Branch b1 is one of equilibrium points. Name a point on a branch of"),
        ("b2/XX1", ("-o", "a.gif"), "has no special point 'XX1'"),
        ("b2/1000", ("-o", "a.gif"), "Its points are 0 to"),
        ("b9/1", ("-o", "a.gif"), "has no branch 'b9'"),
        ("b2/5", ("-o", "a.avi"), "the format .avi is not known. Allowed: .gif, .mp4, .html."),
        ("b2/5", ("-o", "nowhere/a.gif"), "the directory nowhere does not exist."),
        ("b2/5", ("-o", "a.gif", "--slow", "1000"), "frames, more than 5000. Play fewer periods"),
        ("b2/5", ("-o", "a.gif", "--periods", "0"), "--periods"),
        ("b2/5", ("-o", "a.gif", "--fps", "0"), "--fps"),
        ("b2/5", ("-o", "a.gif", "--mode", "0"), "--mode"),
        ("b2/5", ("-o", "a.gif", "--mode", "2"), "There is no mode 2: the orbit has 1 multiplier. Name mode"),
        ("b2/5", ("-o", "a.gif", "--mode", "1", "--amplitude", "0"), "--amplitude"),
        ("b2/5", ("-o", "a.gif", "--amplitude", "1"), "--amplitude is that of a mode, and none is named."),
        ("b1/HB1", ("-o", "a.gif", "--mode", "1"), "Name a point on a branch of periodic orbits."),
        ("b2/5", (), "Missing option '-o'"),
    ],
)
def test_what_cannot_be_played(contwalk, circle, folder, point, options, said):
    before = {path.name for path in folder.iterdir()}
    done = contwalk("animate", "--trust", circle, point, *options)
    assert (done.code, done.out) == (2, "")
    assert said in done.err
    assert {path.name for path in folder.iterdir()} == before


def test_without_ffmpeg_there_is_a_remedy(contwalk, circle, monkeypatch):
    monkeypatch.setenv("PATH", "")
    done = contwalk("animate", "--trust", circle, "b2/5", "-o", "a.mp4")
    assert done.code == 2
    assert "MP4 needs the program ffmpeg, which is not there. Install ffmpeg, or name a .gif" in done.err


def test_a_system_without_draw(contwalk, wheel_alone, folder):
    (folder / "wheel.py").write_text(WHEEL.replace(", draw=draw", ""), encoding="utf-8")
    done = contwalk("plot", "--trust", wheel_alone, "--kind", "stick_figure", "-o", "a.png")
    assert done.code == 2
    assert "System 'wheel' cannot be drawn: it declares no draw. Give the plugin a function" in done.err
    # Its motion can be played all the same, the displaced one beside it as well.
    for options, number in ((("--periods", "2"), 8), (("--mode", "1"), 4)):
        done = contwalk(
            "animate", "--trust", wheel_alone, "b1/0", "-o", "a.gif", "--fps", "5", "--force", *options
        )
        assert done.code == 0
        assert frames(folder / "a.gif") == number


def test_stick_figures_of_one_point_or_the_start(contwalk, wheel, folder):
    for options, title in (((), "b1/0:"), (("--point", "b1/EP1"), "b1/EP1:")):
        assert (
            contwalk(
                "plot", "--trust", wheel, "--kind", "stick_figure", "--force", "-o", "s.svg", *options
            ).code
            == 0
        )
        text = (folder / "s.svg").read_text(encoding="utf-8")
        assert f"<!-- {title}  gamma = 0.1" in text
        assert text.count('id="event"') == 2
        # The beginning, three instants between, and the end.
        assert text.count('id="spoke"') == 5


def test_a_run_file_draws_the_stick_figure_of_the_start(circle, folder):
    assert (folder / "circle_stick_figure.png").exists()


def test_time_series_have_the_events(contwalk, wheel, circle, folder):
    for options in (("--point", "b1/0"), ()):
        assert (
            contwalk(
                "plot", "--trust", wheel, "--kind", "time_series", "--force", "-o", "t.svg", *options
            ).code
            == 0
        )
        text = (folder / "t.svg").read_text(encoding="utf-8")
        assert "<!-- heel_strike (1) -->" in text
        assert 'id="series-theta"' in text
        assert 'id="series-omega_"' in text
    assert (
        contwalk("plot", "--trust", circle, "--kind", "time_series", "--force", "-y", "x", "-o", "t.svg").code
        == 0
    )
    text = (folder / "t.svg").read_text(encoding="utf-8")
    assert "<!-- x (m) -->" in text
    assert 'id="series-y"' not in text


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("--kind", "time_series", "-y", "z"), "'z' is not a state of 'circle'"),
        (("--kind", "time_series", "-x", "x"), "has no -x: it is time"),
        (("--kind", "stick_figure", "-y", "x"), "has no -x and -y"),
        (("--kind", "stick_figure", "--point", "b2/1", "--point", "b2/2"), "drawn at one point"),
        (("--kind", "stick_figure", "--point", "b1/HB1"), "one of equilibrium points"),
        (("--kind", "stick_figure", "--branch", "b1"), "No branch has periodic orbits"),
    ],
)
def test_what_cannot_be_drawn(contwalk, circle, options, said):
    done = contwalk("plot", "--trust", circle, "-o", "a.png", *options)
    assert done.code == 2
    assert said in done.err


def test_show_tells_legs_and_margins(contwalk, wheel):
    for point in ("b1/0", "b1/1"):
        lines = [line.split() for line in contwalk("show", "--trust", wheel, point).out.splitlines()]
        assert ["admissible"] in lines
        assert ["signature:", "heel_strike"] in lines
        head = lines.index(["segment", "mode", "duration", "unit", "ended", "by"])
        assert lines[head + 1][:2] == ["1", "rolling"]
        assert float(lines[head + 1][2]) == pytest.approx(0.7548, rel=0.01)  # the next one is as near
        assert lines[head + 1][3:] == ["s", "heel_strike"]
        head = next(row for row, line in enumerate(lines) if line[:3] == ["margin,", "least", "first"])
        shares = [float(line[line.index("%") - 1]) for line in lines[head + 1 : head + 5]]
        assert shares == sorted(shares)
        assert "turns_back" in [line[0] for line in lines[head + 1 : head + 5]]


def test_show_without_the_system_tells_what_is_stored(contwalk, wheel_alone, folder):
    done = contwalk("show", wheel_alone, "b1/EP1")
    assert done.code == 0
    assert "signature: heel_strike" in done.out
    assert done.err == (
        "Not shown: segments and margins of the orbit. The system of wheel.h5 is the plugin file ./wheel.py, "
        "which is not run without being asked. Give --trust (in Python trust=True) if you trust its code.\n"
    )
    (folder / "wheel.py").unlink()
    done = contwalk("show", "--trust", wheel_alone, "b1/EP1")
    assert done.code == 0
    assert "admissible" in done.out
    assert "of its largest" not in done.out


def test_an_orbit_that_cannot_be_integrated_is_left_out(contwalk, circle, folder, monkeypatch):
    """As at a homoclinic end, where multipliers overflow."""
    real = stored_orbits.reopened

    def reopened(system, branch, point, steps):
        if getattr(point, "name", "") == "EP1":
            raise np.linalg.LinAlgError("Array must not contain infs or NaNs")
        return real(system, branch, point, steps)

    monkeypatch.setattr(stored_orbits, "reopened", reopened)
    given = ("plot", "--trust", "--force", circle, "--kind", "phase_portrait", "-o", "p.svg")
    done = contwalk(*given)
    assert done.code == 0
    assert done.err == (
        "An orbit is left out. The orbit of b2/EP1 cannot be integrated once more "
        "(Array must not contain infs or NaNs).\n"
    )
    done = contwalk(*given, "--branch", "b2", "--point", "b2/EP1")
    assert done.code == 2
    assert done.err.startswith("error: The orbit of b2/EP1 cannot be integrated once more")
