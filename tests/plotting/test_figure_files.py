"""Figures as files, and what importing them costs."""

from __future__ import annotations

import subprocess
import sys

import matplotlib
import pytest
from matplotlib.figure import Figure
from PIL import Image
from synthetic_branches import fold, pitchfork

import contwalk.plotting
from contwalk.errors import ContwalkError
from contwalk.plotting import new_axes, plot_bifurcation_diagram, save

SIGNATURES = {".png": b"\x89PNG", ".svg": b"<?xml", ".pdf": b"%PDF"}


@pytest.mark.parametrize("suffix", SIGNATURES)
def test_a_figure_is_written_in_each_format_and_equal_figures_are_equal_files(tmp_path, suffix):
    paths = [tmp_path / f"{name}{suffix}" for name in "ab"]
    for path in paths:
        assert save(plot_bifurcation_diagram(pitchfork()), path) == path
    first, second = (path.read_bytes() for path in paths)
    assert first.startswith(SIGNATURES[suffix])
    assert first == second


def test_a_png_has_150_dots_per_inch(tmp_path):
    ax = new_axes("bifurcation_diagram")
    save(ax.figure, tmp_path / "f.PNG")
    height, width, _ = matplotlib.image.imread(tmp_path / "f.PNG", format="png").shape
    assert (width, height) == tuple(150 * ax.figure.get_size_inches())


def test_a_figure_without_layout_gets_one(tmp_path):
    figure = Figure()
    plot_bifurcation_diagram([fold()], ax=figure.add_subplot())
    save(figure, tmp_path / "f.svg")
    assert figure.get_layout_engine() is not None


@pytest.mark.parametrize("name", ["f.jpg", "f", "f.eps"])
def test_other_formats_are_refused(tmp_path, name):
    with pytest.raises(ContwalkError, match=r"Allowed: \.png, \.svg, \.pdf"):
        save(new_axes("machine"), tmp_path / name)
    assert not (tmp_path / name).exists()


def test_a_path_that_cannot_be_written_is_an_error_with_a_remedy(tmp_path):
    with pytest.raises(ContwalkError, match=r"cannot be written.*existing folder"):
        save(new_axes("machine"), tmp_path / "missing" / "f.png")


def test_an_unknown_figure_is_answered_with_the_nearest():
    with pytest.raises(ContwalkError, match="Did you mean 'eigenvalues'"):
        new_axes("eigenvalue")


def test_every_export_can_be_had():
    for name in contwalk.plotting.__all__:
        assert callable(getattr(contwalk.plotting, name))
        assert name in dir(contwalk.plotting)
    with pytest.raises(AttributeError, match="no attribute 'plot_nothing'"):
        contwalk.plotting.plot_nothing  # noqa: B018


def test_importing_plotting_imports_no_matplotlib_and_figures_no_pyplot():
    code = (
        "import sys, contwalk.plotting as plotting\n"
        "assert 'matplotlib' not in sys.modules\n"
        "[getattr(plotting, name) for name in plotting.__all__]\n"
        "assert 'matplotlib.pyplot' not in sys.modules\n"
    )
    subprocess.run([sys.executable, "-W", "error", "-c", code], check=True)


def test_a_command_has_no_manuals_and_the_same_pictures(tmp_path):
    """What matplotlib writes for readers and what draws in space is left out, until it is asked for."""
    drawn = (
        "import sys\n"
        "from contwalk import plotting\n"
        "plotting.manuals.read = {read}\n"
        "ax = plotting.new_axes('eigenvalues')\n"
        "ax.plot([0, 1], [2, 3], label='a')\n"
        "ax.legend()\n"
        "plotting.save(ax, {path!r})\n"
        "print('%(Line2D' not in ax.plot.__doc__, 'mpl_toolkits.mplot3d' in sys.modules)\n"
        "print(plotting.new_axes('phase_portrait', projection='3d').name)\n"
    )
    told = []
    for read in (True, False):
        code = drawn.format(read=read, path=str(tmp_path / f"{read}.png"))
        told.append(
            subprocess.run(
                [sys.executable, "-W", "error", "-c", code], check=True, capture_output=True, text=True
            ).stdout.split()
        )
    assert told == [["True", "True", "3d"], ["False", "False", "3d"]]
    assert (tmp_path / "True.png").read_bytes() == (tmp_path / "False.png").read_bytes()


def test_a_picture_of_a_canvas_of_its_own_is_saved_in_our_resolution(tmp_path):
    figure = Figure(figsize=(2, 1), dpi=40)
    figure.add_subplot().plot([0, 1])
    save(figure, tmp_path / "own.png")
    with Image.open(tmp_path / "own.png") as image:
        assert image.size == (300, 150)
