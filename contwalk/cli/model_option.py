"""The option `--set masses=3` of the commands that take a system."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import click

from contwalk.errors import ContwalkError


def model_option(function: Callable[..., Any]) -> Callable[..., Any]:
    """The option itself; its values arrive as `choices`."""
    return click.option(
        "--set", "choices", metavar="CHOICE=VALUE", multiple=True, help="A model choice, as masses=3."
    )(function)


def model_of(choices: Sequence[str]) -> dict[str, Any]:
    """Model choices by name; a value is read as it would be in a run file.

    Raises
    ------
    ContwalkError
        For text that is not CHOICE=VALUE.
    """
    from contwalk.workflow.run_file.yaml_lines import parse_yaml

    model = {}
    for choice in choices:
        name, equals, text = choice.partition("=")
        name = name.strip().removeprefix("model.")
        if not equals or not name:
            raise ContwalkError(
                f"--set {choice}: this is not CHOICE=VALUE.", "Write, for example, --set masses=3."
            )
        model[name] = parse_yaml(text, f"--set {choice}", numbered=False)[0]
    return model
