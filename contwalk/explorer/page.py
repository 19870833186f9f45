"""One file of HTML: the page, how it looks, what it does and its data, with no request to any network."""

from __future__ import annotations

import base64
import hashlib
from collections.abc import Mapping
from html import escape
from importlib.resources import files

SCRIPTS = ("inflate", "data", "axes", "chart", "diagram", "planes", "panels", "machine", "margins", "main")


def written(title: str, blocks: Mapping[str, str], connected: bool = False) -> str:
    """The page.

    Parameters
    ----------
    title : str
    blocks : mapping
        Packed data by name; see `packing.packed`.
    connected : bool
        Whether it may ask the server that it comes from whether it has changed.
    """
    style, script = _text("page.css"), "\n".join(_text(f"{name}.js") for name in SCRIPTS)
    policy = (
        f"default-src 'none'; style-src '{_hash(style)}'; script-src '{_hash(script)}'; img-src data:; "
        "base-uri 'none'; form-action 'none'" + ("; connect-src 'self'" if connected else "")
    )
    data = "\n".join(
        f'<script type="application/octet-stream" data-block="{escape(name)}">{text}</script>'
        for name, text in blocks.items()
    )
    parts = {
        "TITLE": escape(title),
        "POLICY": escape(policy),
        "STYLE": style,
        "DATA": data,
        "SCRIPT": script,
    }
    pieces = _text("page.html").split("@@")
    return "".join(parts[piece] if number % 2 else piece for number, piece in enumerate(pieces))


def _text(name: str) -> str:
    return files("contwalk.explorer").joinpath(name).read_text(encoding="utf-8")


def _hash(text: str) -> str:
    """As a policy of contents names an inline script."""
    digest = hashlib.sha256(text.encode("utf-8")).digest()
    return f"sha256-{base64.b64encode(digest).decode('ascii')}"
