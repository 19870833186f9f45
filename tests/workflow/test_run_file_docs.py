"""The reference page says what the code does."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from contwalk.workflow.run_file import model as run_model
from contwalk.workflow.run_file import motions as run_motions
from contwalk.workflow.run_file.names import FIGURES, FOLLOWED
from contwalk.workflow.run_file.yaml_lines import parse_yaml

PAGE = (Path(__file__).parents[2] / "docs" / "reference" / "run_file.md").read_text(encoding="utf-8")


def test_the_example_has_the_right_form():
    (example,) = re.findall(r"```yaml\n(.*?)```", PAGE, flags=re.DOTALL)
    data, _ = parse_yaml(example, "run_file.md")
    model = run_model.RunModel.model_validate(data)
    assert model.continue_.parameter == "delta"
    assert list(model.figures[0]) == ["bifurcation_diagram"]


@pytest.mark.parametrize("section", ["RunModel", "Start", "Continue", "Diagram", "Events", "Span", "Engine"])
def test_every_key_is_on_the_page(section):
    for key in getattr(run_model, section).known_keys():
        assert re.search(rf"\b{key}\b", PAGE), key


@pytest.mark.parametrize("section", ["Simulation", "Sampling", "Measure", "Settled", "TimeUnit"])
def test_every_key_of_motions_is_on_the_page(section):
    for key in getattr(run_motions, section).known_keys():
        assert re.search(rf"\b{key}\b", PAGE), key


@pytest.mark.parametrize("name", [*FIGURES, *FOLLOWED])
def test_every_name_is_on_the_page(name):
    assert f"`{name}`" in PAGE
