"""What is known of the mappings that a database keeps: the types of the keys that are read again."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, TypedDict


class Settings(TypedDict, total=False):
    """`settings` of a branch: what its problem is restored from."""

    pins: tuple[str, ...]
    undeclared: tuple[tuple[float, ...], ...]
    path: tuple[Mapping[str, float], Mapping[str, float]] | None
    mode: str
    fold: int
    turns: tuple[float, ...]
    reported: str
    segments: int
    scheme: str
    evenly_first: bool
    parts: int
    power: int
    legs: tuple[tuple[str | bool | None, ...], ...]
    image: str | None
    room: int
    of: str
    of_problem: str
    curve: Mapping[str, Any]
    limit: Mapping[str, Any]
    further: int
    ranges: Mapping[str, tuple[float, ...]]
    mirror: tuple[str, ...]


class Provenance(TypedDict, total=False):
    """`provenance` of a run, and of the files of other studies."""

    author: str
    description: str
    system_reference: str
    run_file_directory: str
    plugin_sha256: str
    plugin_files: Mapping[str, str]
    equations_sha256: str
    units: Mapping[str, str] | None
    called: Mapping[str, str]
    engine: Mapping[str, Any]
    accuracy: float
    widened: bool


class Mark(TypedDict, total=False):
    """`mark` of a special point."""

    name: str
    value: float | None


class Header(TypedDict, total=False):
    """`header` of a file of motions, samples or margins."""

    config: str
    overrides: tuple[str, ...]
    model: Mapping[str, Any]
    units: Mapping[str, str] | None
    parameters: Mapping[str, float]
    notes: tuple[str, ...]
    provenance: Mapping[str, Any]
