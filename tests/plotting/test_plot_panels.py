"""Figures of several panels: phase portraits and multipliers of branches, and what accuracy costs."""

from __future__ import annotations

import numpy as np
import pytest
from synthetic_branches import branch, pitchfork

from contwalk.errors import ContwalkError
from contwalk.plotting import (
    Portrait,
    plot_bifurcation_diagram,
    plot_multiplier_panels,
    plot_phase_panels,
    plot_tradeoff_panels,
)

ANGLE = np.linspace(0.0, 2.0 * np.pi, 50)


def circle(radius):
    return radius * np.stack([np.cos(ANGLE), np.sin(ANGLE)], axis=1)


def test_a_panel_for_each_portrait_on_equal_scales():
    portraits = [
        Portrait("b1", [circle(1.0)], ["small"], [True]),
        Portrait("b2", [circle(2.0), circle(3.0)], ["middle", "large"], [False, True]),
        Portrait("b3", [circle(0.5)], ["tiny"], [True]),
    ]
    axes = plot_phase_panels(portraits, ["x", "y"])
    assert [ax.get_title(loc="left") for ax in axes] == ["b1", "b2", "b3"]
    assert len({ax.get_xlim() for ax in axes}) == 1
    assert axes[0].get_xlim()[1] > 3.0
    assert [text.get_text() for text in axes[1].get_legend().get_texts()] == ["middle", "large"]
    assert len(axes[0].figure.axes) == 3  # the fourth place of the grid is empty


def test_portraits_may_be_in_space():
    spiral = np.column_stack([circle(1.0), ANGLE])
    (ax,) = plot_phase_panels([Portrait("b1", [spiral])], ["x", "y", "z"])
    assert ax.name == "3d"
    axes = plot_phase_panels([Portrait("b1", [spiral]), Portrait("b2", [3.0 * spiral])], ["x", "y", "z"])
    assert [(ax.name, ax.get_title(loc="left")) for ax in axes] == [("3d", "b1"), ("3d", "b2")]
    for limits in ("get_xlim", "get_ylim", "get_zlim"):
        low, high = getattr(axes[0], limits)()
        assert getattr(axes[1], limits)() == (low, high)
        assert high > 2.9  # of the larger one
    with pytest.raises(ContwalkError, match="no orbit"):
        plot_phase_panels([], ["x", "y"])


def test_the_promise_is_drawn_with_the_errors():
    series = {"b1/HB1": [(1.0, 1e-9), (2.0, 1e-12)], "b2/PD1": [(1.0, 1e-7), (2.0, 0.0)]}
    asked = {"dop853": [(1.0, 1e-4), (2.0, 1e-8)]}
    axes = plot_tradeoff_panels({"dop853": series, "auto": series}, asked, doubt=1e-13)
    assert len(axes) == 2
    promise = next(line for line in axes[0].lines if line.get_gid() == "asked-dop853")
    assert promise.get_xydata().tolist() == [[1.0, 1e-4], [2.0, 1e-8]]
    assert [text.get_text() for text in axes[0].texts] == ["1e-4", "1e-8"]
    assert axes[0].get_ylim() == axes[1].get_ylim()
    assert any(patch.get_gid() == "doubt" for patch in axes[0].patches)
    with pytest.raises(ContwalkError, match="nothing to draw"):
        plot_tradeoff_panels({}, {})


def orbits(name):
    mu = np.linspace(0.0, 1.0, 5)
    return branch(
        {"mu": mu, "x": mu}, problem="periodic_orbit", name=name, spectrum=np.stack([0.5 * mu + 0j], axis=1)
    )


def test_each_branch_has_its_multipliers_in_the_plane_and_over_the_parameter():
    axes = plot_multiplier_panels([orbits("b1"), *pitchfork(), orbits("b2")])
    assert len(axes) == 4  # equilibria have none
    assert [ax.get_title("left") for ax in axes[::2]] == ["b1", "b2"]
    assert [ax.get_ylabel() for ax in axes[1::2]] == ["modulus of multipliers"] * 2
    (alone, over) = plot_multiplier_panels([orbits("b1")])
    assert not alone.get_title("left")
    assert over.get_yscale() == "log"
    with pytest.raises(ContwalkError, match="No branch has multipliers"):
        plot_multiplier_panels(pitchfork())


def test_many_branches_share_the_panels():
    axes = plot_multiplier_panels([orbits(f"b{k}") for k in range(8)])
    assert len(axes) == 2
    axes[0].figure.canvas.draw()


def test_a_part_of_a_diagram_has_no_labels_from_outside():
    whole = plot_bifurcation_diagram(pitchfork(), "mu", "x")
    assert "BP1" in [text.get_text() for text in whole.texts]
    part = plot_bifurcation_diagram(pitchfork(), "mu", "x", xlim=(0.2, 1.0), ylim=(-0.9, 0.9))
    assert part.get_xlim() == (0.2, 1.0)
    assert part.get_ylim() == (-0.9, 0.9)
    assert "BP1" not in [text.get_text() for text in part.texts]
