"""Motions as files that play."""

from __future__ import annotations

import json
import re
import stat
from xml.etree import ElementTree

import matplotlib
import numpy as np
import pytest
from machines import CLOCK, EVENTS, HOPPER, STATES, TIMES, TURN_STATES, TURN_TIMES, machine
from PIL import Image

from contwalk.errors import ContwalkError, PluginError
from contwalk.plotting import save_animation
from contwalk.plotting.animation import _Film
from contwalk.plotting.film_page import elements_of
from contwalk.plotting.playback import Playback


def durations(path):
    """Milliseconds that each frame of a GIF lasts."""
    with Image.open(path) as image:
        found = []
        for frame in range(image.n_frames):
            image.seek(frame)
            found.append(image.info["duration"])
    return found


@pytest.mark.drawn(1)
@pytest.mark.parametrize(("fps", "lasts"), [(10.0, 100), (30.0, 30), (60.0, 20), (8.0, 120)])
def test_a_gif_plays_as_long_as_the_motion_lasts(tmp_path, fps, lasts):
    path = tmp_path / "walk.gif"
    times, states = TIMES[:11] / 2.0, STATES[:11]
    number = save_animation(HOPPER, times, states, {}, path, fps=fps)
    assert number == round(0.5 * 1000 / lasts)
    # What equal frames cannot show is half of one at most.
    assert sum(durations(path)) == pytest.approx(500, abs=lasts / 2)


def test_slow_motion_has_more_frames(tmp_path):
    path = tmp_path / "slow.gif"
    assert save_animation(HOPPER, TIMES, STATES, {}, path, events=EVENTS, fps=2.0, slow=3.0) == 12
    assert sum(durations(path)) == 6000


def frames_of_page(text):
    """The drawings of a page, put together as its script does."""
    elements = json.loads(re.search(r"^const elements = (.*);$", text, re.MULTILINE)[1])
    changes = json.loads(re.search(r"^const changes = (.*);$", text, re.MULTILINE)[1])
    frames = []
    for change in changes:
        frame = list(change) if isinstance(change, list) else list(frames[-1])
        if isinstance(change, dict):
            for place, element in change.items():
                frame[int(place)] = element
        frames.append(frame)
    return ["".join(elements[element] for element in frame) for frame in frames]


def test_html_is_a_page_that_needs_nothing_else(tmp_path):
    path = tmp_path / "walk.html"
    assert save_animation(CLOCK, TURN_TIMES, TURN_STATES, {}, path, fps=1.0) == 4
    text = path.read_text(encoding="utf-8")
    frames = frames_of_page(text)
    assert len(set(frames)) == 4  # the hand of the clock moves
    for second, frame in enumerate(frames):
        assert ElementTree.fromstring(frame).tag == "svg"  # well-formed
        assert f">time {second}.000 s<" in frame
    # Nothing is asked of a network: no address, and nothing that would load another file.
    rest = re.sub(r'href=\\"#|url\(#', "", text)
    assert not re.search(r"//|\bhref\b|@import|url\(|<link|<script [^>]*src|fetch\(", rest)
    assert "const interval = 1000.0;" in rest
    assert [found.name for found in tmp_path.iterdir()] == ["walk.html"]


@pytest.mark.long
def test_a_page_stores_once_what_frames_have_in_common(tmp_path):
    sizes = []
    for fps in (1.0, 8.0):
        path = tmp_path / f"{fps}.html"
        save_animation(CLOCK, TURN_TIMES, TURN_STATES, {}, path, fps=fps)
        sizes.append(path.stat().st_size)
    # 28 frames more; each has a hand, a time and a place on the line of time of its own, some hundred
    # characters each, where a picture took 20 kB.
    assert sizes[1] - sizes[0] < 28 * 2000


def test_a_drawing_keeps_its_texts_and_shortens_its_numbers():
    drawing = (
        '<?xml version="1.0"?>\n<svg xmlns="http://a.b" width="432.123456pt">\n<!-- 1 -->\n'
        '<path d="M 1.23456 0.0123456 \nL 120.98765 -3"/>\n'
        '<text x="0.98765">mu = 0.123456 &lt; 1</text></svg>'
    )
    assert "".join(elements_of(drawing)) == (
        '<svg width="432.123456pt"> <path d="M 1.23 0.01235 L 120.99 -3"/> '
        '<text x="0.9877">mu = 0.123456 &lt; 1</text></svg>'
    )


def labelled(axes, t, x, p):
    axes.plot([0.0, x[0]], [0.0, 1.0])
    axes.set(xlim=(-1000.0, 1000.0), ylim=(-2000.0, 2000.0), xlabel="place (m)", ylabel="height (m)")


@pytest.mark.parametrize("names", [1, 9])
def test_numbers_and_labels_of_the_axes_are_not_cut(names):
    events = [(0.1 * k, f"event {k}") for k in range(names)]
    film = _Film(Playback(machine(labelled), TIMES, STATES, {}), events, 1.0, "")
    film.show(0.5)
    film.figure.canvas.draw()
    whole, legend = film.figure.bbox, film.clock.get_legend().get_window_extent()
    for axis in (film.stage.xaxis, film.stage.yaxis):
        box = axis.get_tightbbox()
        assert whole.x0 <= box.x0 <= box.x1 <= whole.x1
        assert legend.y1 <= box.y0 <= box.y1 <= whole.y1
    assert whole.x0 <= legend.x0


def test_a_machine_without_axes_keeps_its_room():
    def bare(axes, t, x, p):
        axes.axis("off")
        labelled(axes, t, x, p)

    film = _Film(Playback(machine(bare), TIMES, STATES, {}), (), 1.0, "")
    film.show(0.5)
    assert film.stage.get_position(original=True).width == pytest.approx(0.98)


def test_titles_are_text_in_a_page(tmp_path):
    path = tmp_path / "walk.html"
    given = {"fps": 1.0, "title": "<script>x</script> & $frames"}
    assert save_animation(CLOCK, TURN_TIMES, TURN_STATES, {}, path, **given) == 4
    assert "<title>&lt;script&gt;x&lt;/script&gt; &amp; $frames</title>" in path.read_text(encoding="utf-8")


def test_the_camera_follows_and_time_is_told():
    film = _Film(Playback(HOPPER, TIMES, STATES, {}), EVENTS, 2.0, "walk")
    for time, place in ((0.5, 0.5), (1.5, 1.5)):
        film.show(time)
        assert film.stage.get_xlim() == pytest.approx((place - 1.0, place + 1.0))
        assert film.clock.get_xlabel() == f"time  {time:.3f} s"
        assert film.hand.get_xdata() == [time]
        assert film.said.get_text() == ""
    film.show(1.05)
    assert film.said.get_text() == "landing"


def test_a_plugin_that_sets_no_limits_has_the_same_ones_in_all_frames():
    film = _Film(Playback(CLOCK, TURN_TIMES, TURN_STATES, {"height": 1.0}), (), 1.0, "")
    seen = set()
    for time in (0.0, 1.0, 3.0):
        film.show(time)
        seen.add((*film.stage.get_xlim(), *film.stage.get_ylim()))
    (limits,) = seen
    assert limits[0] < -0.99
    assert limits[3] > 0.99


def test_a_second_motion_is_pale_and_behind():
    """The ground is there once, and the camera follows the first one."""
    plain = _Film(Playback(HOPPER, TIMES, STATES, {}), (), 1.0, "")
    film = _Film(
        Playback(HOPPER, TIMES, STATES, {}), (), 1.0, "", Playback(HOPPER, TIMES, STATES + 0.2, {}), "said"
    )
    for one in (plain, film):
        one.show(0.5)
    assert len(film.stage.lines) == len(plain.stage.lines) + 1
    pale, strong = [line for line in film.stage.lines if line.get_gid() == "leg"]
    assert [line.get_xdata()[0] for line in (pale, strong)] == pytest.approx([0.7, 0.5])
    assert pale.get_alpha() < 0.5
    assert strong.get_alpha() is None
    assert pale.get_zorder() < strong.get_zorder()
    assert film.stage.get_legend_handles_labels()[1] == ["leg"]
    assert film.stage.get_xlim() == plain.stage.get_xlim()
    assert "said" in [text.get_text() for text in film.figure.texts]


@pytest.mark.long
def test_progress_is_told(tmp_path):
    told = []
    save_animation(
        CLOCK, TURN_TIMES, TURN_STATES, {}, tmp_path / "a.gif", fps=1.0, progress=lambda *n: told.append(n)
    )
    assert told == [(1, 4), (2, 4), (3, 4), (4, 4)]


@pytest.mark.parametrize("name", ["walk.avi", "walk"])
def test_other_formats_are_refused(tmp_path, name):
    with pytest.raises(ContwalkError, match=r"Allowed: \.gif, \.mp4, \.html"):
        save_animation(HOPPER, TIMES, STATES, {}, tmp_path / name)
    assert not list(tmp_path.iterdir())


def test_mp4_needs_ffmpeg(tmp_path):
    with (
        matplotlib.rc_context({"animation.ffmpeg_path": str(tmp_path / "no-ffmpeg")}),
        pytest.raises(ContwalkError, match=r"ffmpeg, which is not there.*Install ffmpeg, or name a \.gif"),
    ):
        save_animation(HOPPER, TIMES, STATES, {}, tmp_path / "walk.mp4")


def script(folder, text):
    """A program in the place of ffmpeg."""
    path = folder / "ffmpeg"
    path.write_text(f"#!/bin/sh\n{text}\n", encoding="utf-8")
    path.chmod(path.stat().st_mode | stat.S_IXUSR)
    return str(path)


def test_mp4_is_what_ffmpeg_makes_of_the_frames(tmp_path):
    # The last argument is the file; the frames come as 600 x 600 x 4 bytes each.
    program = script(tmp_path, 'for last; do :; done; cat > "$last"')
    with matplotlib.rc_context({"animation.ffmpeg_path": program}):
        save_animation(CLOCK, TURN_TIMES, TURN_STATES, {}, tmp_path / "a.mp4", fps=1.0)
    assert (tmp_path / "a.mp4").stat().st_size == 4 * 600 * 600 * 4


def test_an_ffmpeg_that_fails_is_told_and_leaves_nothing(tmp_path):
    program = script(tmp_path, "cat > /dev/null; echo 'Unknown encoder h264' >&2; exit 1")
    with (
        matplotlib.rc_context({"animation.ffmpeg_path": program}),
        pytest.raises(ContwalkError, match=r"ffmpeg could not write .*Unknown encoder h264"),
    ):
        save_animation(CLOCK, TURN_TIMES, TURN_STATES, {}, tmp_path / "a.mp4", fps=1.0)
    assert [path.name for path in tmp_path.iterdir()] == ["ffmpeg"]


def test_too_many_frames_are_refused(tmp_path):
    with pytest.raises(ContwalkError, match="6000 frames, more than 5000"):
        save_animation(HOPPER, TIMES, STATES, {}, tmp_path / "a.html", fps=30.0, slow=100.0)


def test_an_error_in_draw_leaves_what_was_there(tmp_path):
    path = tmp_path / "a.gif"
    path.write_bytes(b"before")

    def broken(axes, t, x, p):
        if t > 1.0:
            raise RuntimeError("no ink")
        axes.set_xlim(0.0, 1.0)
        axes.set_ylim(0.0, 1.0)

    with pytest.raises(PluginError, match="no ink"):
        save_animation(machine(broken), TIMES, STATES, {}, path, fps=5.0)
    assert path.read_bytes() == b"before"
    assert [found.name for found in tmp_path.iterdir()] == ["a.gif"]


def test_an_error_in_the_first_frame_is_that_error(tmp_path):
    def broken(axes, t, x, p):
        raise RuntimeError("no ink")

    with pytest.raises(PluginError, match="no ink"):
        save_animation(machine(broken), TIMES, STATES, {}, tmp_path / "a.gif")


def test_a_folder_that_is_not_there(tmp_path):
    with pytest.raises(ContwalkError, match="existing folder"):
        save_animation(CLOCK, TURN_TIMES, TURN_STATES, {}, tmp_path / "no" / "a.gif", fps=1.0)


@pytest.mark.long
def test_frames_are_evenly_spaced_in_time(tmp_path):
    film_times = []

    def draw(axes, t, x, p):
        film_times.append(t)
        axes.set_xlim(0.0, 1.0)
        axes.set_ylim(0.0, 1.0)

    save_animation(machine(draw), TURN_TIMES, TURN_STATES, {}, tmp_path / "a.gif", fps=2.0)
    np.testing.assert_allclose(np.diff(film_times[-8:]), 0.5)  # the first ones look for limits and room
