"""The figure of margins."""

from __future__ import annotations

import pytest

from contwalk import plotting
from contwalk.errors import ContwalkError


def row(instant, state, sign, border, several=False):
    return {"instant": instant, "state": state, "sign": sign, "border": border, "several": several}


ROWS = [
    row(0, "q", 1, 0.01),
    row(0, "q", -1, 1.0, several=True),
    row(0, "u", 1, None),
    row(0, "u", -1, 0.1),
    row(1, "q", 1, 10.0),
    row(1, "q", -1, 0.1),
]


def test_bars_are_logarithmic_and_lie_on_the_side_of_the_push():
    first, second = plotting.plot_margins(ROWS, [0.0, 0.5], units={"q": "m", "u": "m"}).axes
    assert [label.get_text() for label in first.get_yticklabels()] == ["q (m)", "u (m)"]
    widths = [bar.get_width() for bar in first.patches]
    assert widths[0] > 0.0 > widths[1]
    assert abs(widths[1]) - widths[0] == pytest.approx(2.0)  # a hundred times as far
    assert second.patches[0].get_width() - widths[0] == pytest.approx(3.0)


def test_states_of_one_unit_share_an_axis_and_others_have_their_own():
    axes = plotting.plot_margins(ROWS, [0.0, 0.5], units={"q": "m", "u": "m/s"}).axes
    named = [[label.get_text() for label in ax.get_yticklabels()] for ax in axes]
    assert named == [["q (m)"], [], ["u (m/s)"], []]  # the first instant's panels name the states
    longest = [
        max((abs(bar.get_width()) / ax.get_xlim()[1] for bar in ax.patches), default=0.0) for ax in axes
    ]
    assert longest[1] > 0.5
    assert longest[2] > 0.2  # 0.1 m/s is not short beside 10 m


def test_what_was_not_pushed_or_met_no_border_is_said():
    first, second = plotting.plot_margins(ROWS, [0.0, 0.5]).axes
    assert "not pushed" in [text.get_text() for text in second.texts]
    assert len(first.patches) == 3  # and an arrow where no border was met
    assert len([text for text in first.texts if getattr(text, "arrow_patch", None) is not None]) == 1


def test_a_bar_beyond_which_survival_begins_again_is_pale():
    first = plotting.plot_margins(ROWS, [0.0, 0.5]).axes[0]
    plain, several = first.patches[2], first.patches[1]
    assert sum(several.get_facecolor()[:3]) > sum(plain.get_facecolor()[:3])


def test_no_rows_are_refused():
    with pytest.raises(ContwalkError, match="no margins"):
        plotting.plot_margins([], [0.0])


def test_machines_stand_above_their_panels():
    drawn = []

    def draw(number, ax):
        drawn.append(number)
        ax.plot([0.0, 1.0], [0.0, 1.0])

    plain = plotting.plot_margins(ROWS, [0.0, 0.5])
    figure = plotting.plot_margins(ROWS, [0.0, 0.5], draw=draw)
    assert drawn == [0, 1]
    assert figure.get_figheight() > plain.get_figheight() + 1.0
    figure.draw_without_rendering()
    for above, panel in zip(figure.axes[:2], figure.axes[2:], strict=True):
        assert above.get_title().startswith("instant")
        assert above.get_window_extent().y0 > panel.get_window_extent().y1
