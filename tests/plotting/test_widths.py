"""Figures at the width of a column and of a page, for LaTeX, and legends that tell what branches are."""

from __future__ import annotations

import shutil

import numpy as np
import pytest
from synthetic_branches import branch, hopf, pitchfork

from contwalk.branch import SpecialPoint
from contwalk.errors import ContwalkError
from contwalk.plotting import new_axes, plot_bifurcation_diagram, save, style
from contwalk.plotting.branch_kinds import kinds_of
from contwalk.plotting.style import PROPORTIONS, WIDTHS, new_grid, of_width


def orbit(name, parent, label="PD"):
    mu = np.linspace(0, 1, 21)
    special = (SpecialPoint(label, 10.0),)
    return branch({"mu": mu, "x": mu}, special=special, name=name, problem="periodic_orbit", parent=parent)


def cascade():
    """An equilibrium, its cycle, and cycles of two and four periods."""
    return [hopf(), orbit("b2", ("b1", 30.0)), orbit("b3", ("b2", 10.0)), orbit("b4", ("b3", 10.0))]


@pytest.mark.parametrize("name", WIDTHS)
@pytest.mark.parametrize("kind", PROPORTIONS)
def test_a_figure_has_the_width_that_is_asked_for(name, kind):
    with of_width(name):
        figure = new_axes(kind).figure
        panels = new_grid(kind, 4, 2)[0].figure
    assert figure.get_figwidth() == pytest.approx(WIDTHS[name])
    assert panels.get_figwidth() == pytest.approx(WIDTHS[name])
    # no flatter than it is by itself, where it is narrower
    width, height = PROPORTIONS[kind]
    if width >= WIDTHS[name]:
        assert figure.get_figheight() / figure.get_figwidth() >= height / width - 1e-12
    assert new_axes(kind).figure.get_figwidth() == width


def test_in_a_column_the_legend_is_below_all_axes_and_says_all():
    with of_width("column"):
        ax = plot_bifurcation_diagram(cascade(), y="x")
    ax.figure.draw_without_rendering()
    (legend,) = ax.figure.legends
    told = {text.get_text().split("\n")[0] for text in legend.get_texts()}
    assert {"stable", "b1: equilibrium", "b3: period 2"} <= told
    assert ax.get_legend() is None
    box = legend.get_window_extent()
    assert box.y1 < ax.get_tightbbox().y0 + 2.0  # a line's width
    assert box.x1 <= ax.figure.bbox.x1
    assert ax.bbox.height > 0.4 * ax.figure.bbox.height


def test_branches_are_told_by_their_periods():
    assert kinds_of(cascade()) == ["equilibrium", "period 1", "period 2", "period 4"]
    # What leaves at another point than a doubling has the period that it had.
    left = orbit("b3", ("b2", 10.0), "BP"), orbit("b4", ("b3", 10.0))
    assert kinds_of([*cascade()[:2], *left])[2:] == ["period 2", "period 2"]


def test_where_all_are_alike_nothing_is_told():
    assert kinds_of(pitchfork()) == []
    assert kinds_of([hopf(), hopf()]) == []
    legend = plot_bifurcation_diagram(pitchfork()).get_legend()
    assert not any("equilibrium" in text.get_text() for text in legend.get_texts())


def test_pgf_needs_latex(tmp_path, monkeypatch):
    monkeypatch.setattr(style, "which", lambda name: None)
    with pytest.raises(ContwalkError, match=r"LaTeX measures.*Install one of lualatex, xelatex, pdflatex"):
        save(plot_bifurcation_diagram(pitchfork()), tmp_path / "f.pgf")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.skipif(not any(map(shutil.which, style._TEX)), reason="there is no LaTeX")
def test_pgf_is_written_where_there_is_latex(tmp_path):
    path = save(plot_bifurcation_diagram(pitchfork()), tmp_path / "f.pgf")
    text = path.read_text(encoding="utf-8")
    assert "\\begin{pgfpicture}" in text
    assert "\\selectfont" in text


def test_text_of_a_pdf_is_in_a_font_that_it_holds(tmp_path):
    content = save(plot_bifurcation_diagram(pitchfork()), tmp_path / "f.pdf").read_bytes()
    assert b"/FontFile2" in content
    assert b"/Type3" not in content
