"""`contwalk warmup`: compile what a first run would compile."""

from __future__ import annotations

import click


@click.command("warmup")
def command() -> None:
    """Compile the integrators and keep them on disk, so that no later run waits for it.

    Runs compile what they need by themselves; this only chooses the moment. The cache is the folder
    $CONTWALK_CACHE_DIR, or contwalk in the user's cache directory.
    """
    from contwalk.cli.terminal import console, line, table
    from contwalk.workflow.warming import warm

    done, folder = warm()
    out = console()
    rows = [[part.name, part.state, f"{part.seconds:.2f} s"] for part in done]
    table(out, ["", "", ""], rows, right=(2,))
    line(out, f"cache: {folder}")
    if any(part.state == "not kept" for part in done):
        line(out, "The cache cannot be written, so nothing is kept. Name a folder with CONTWALK_CACHE_DIR.")
