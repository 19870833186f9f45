"""The entry point: the group of all commands, and what becomes of errors."""

from __future__ import annotations

import errno
import os
import sys
import traceback
from collections.abc import Sequence
from contextlib import suppress
from typing import Any

import click

from contwalk.cli.collector import hold_collector
from contwalk.cli.lazy_group import LazyGroup
from contwalk.errors import ContwalkError
from contwalk.plotting import manuals
from contwalk.printable import printable
from contwalk.workflow.process_end import refuse_exit
from contwalk.workflow.watching import watching

_UNWRITABLE = (errno.ENOSPC, errno.EDQUOT)
INTERRUPTED, TERMINATED = 130, 143  # 128 + SIGINT, 128 + SIGTERM, as shells count

_COMMANDS = {
    "new": ("contwalk.cli.new_command", "Write a plugin and a run file that run as they are."),
    "import": ("contwalk.cli.import_command", "Make a plugin of a model that exists: .ode, .txt."),
    "examples": ("contwalk.cli.examples_command", "List run files that come along, or copy one."),
    "init": ("contwalk.cli.init_command", "Write a commented run file for a system, to start from."),
    "continue": ("contwalk.cli.continue_command", "Compute the study that a run file describes."),
    "simulate": ("contwalk.cli.simulate_command", "Integrate one motion and locate its events."),
    "sample": ("contwalk.cli.sample_command", "Measure many motions from drawn states and parameters."),
    "margins": ("contwalk.cli.margins_command", "Find how far a stored motion may be pushed."),
    "show": ("contwalk.cli.show_command", "Show what a database holds, as text or as JSON."),
    "diff": ("contwalk.cli.diff_command", "Compare two databases, within the errors that they claim."),
    "plot": ("contwalk.cli.plot_command", "Draw a figure of a database."),
    "explore": ("contwalk.cli.explore_command", "Write a database as a page to look at and to mail."),
    "animate": ("contwalk.cli.animate_command", "Play an orbit of a database as GIF, MP4 or HTML."),
    "verify": ("contwalk.cli.verify_command", "Recompute the special points of a database, and compare."),
    "tradeoff": ("contwalk.cli.tradeoff_command", "Measure what accuracy costs in a study."),
    "export": ("contwalk.cli.export_command", "Write a database as CSV tables."),
    "systems": ("contwalk.cli.systems_command", "List, describe and check systems."),
    "warmup": ("contwalk.cli.warmup_command", "Compile beforehand what a first run would compile."),
}


@click.group(
    cls=LazyGroup,
    lazy=_COMMANDS,
    invoke_without_command=True,
    context_settings={"help_option_names": ["-h", "--help"]},
)
@click.version_option(package_name="contwalk", prog_name="contwalk", message="%(prog)s %(version)s")
@click.pass_context
def group(context: click.Context) -> None:
    """Continuation and bifurcation analysis of smooth and impacting machines.

    A first study: `contwalk examples autobalancer_load`, `contwalk continue autobalancer_load.yaml`.
    """
    if context.invoked_subcommand is None:
        click.echo(context.get_help())


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the command line and leave the process with its exit code.

    Computations take one thread of the linear algebra whatever is set, see `numerics.threads`: where nobody
    has set anything, others need not be made at all.
    """
    hold_collector()
    refuse_exit()
    manuals.read = False
    for library in ("OPENBLAS", "MKL", "OMP"):
        os.environ.setdefault(f"{library}_NUM_THREADS", "1")
    sys.exit(run(arguments))


def run(arguments: Sequence[str] | None = None) -> int:
    """Run the command line.

    Returns
    -------
    int
        0; 1 where a computation failed; 2 for bad input; 130 after Ctrl-C, 143 after SIGTERM.
    """
    sys.excepthook = sys.unraisablehook = _untold
    for name in ("stdout", "stderr"):
        if getattr(sys, name) is None:  # closed by whoever has called, as after >&-
            setattr(sys, name, open(os.devnull, "w", encoding="utf-8"))  # noqa: SIM115 (to the end)
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):  # a terminal that lacks a letter shows its code
            stream.reconfigure(errors="backslashreplace")
    try:
        _check_names(sys.argv[1:] if arguments is None else arguments)
        with watching(say):
            code = group.main(args=arguments, prog_name="contwalk", standalone_mode=False)
        sys.stdout.flush()
        return code if isinstance(code, int) else 0
    except ContwalkError as error:
        say(f"error: {error}")
        return error.exit_code
    except click.UsageError as error:
        say(f"error: {error.format_message()}")
        if error.ctx is not None:
            say(f"See: {error.ctx.command_path} --help")
        return error.exit_code
    except click.ClickException as error:
        say(f"error: {error.format_message()}")
        return error.exit_code
    except SystemExit as error:  # whatever asks for this is no code of contwalk, but for click's completion
        if "_CONTWALK_COMPLETE" in os.environ and isinstance(error.code, int):
            return error.code
        say(f"error: the plugin leaves the process (exit code {error.code!r}). Let it raise an exception.")
        return 1
    except (KeyboardInterrupt, click.Abort):
        say("Interrupted.")
        return INTERRUPTED
    except UnicodeEncodeError as error:  # a name in a run file that the locale cannot have
        say(f"error: {_not_a_name(error.object)}")
        return ContwalkError.exit_code
    except BrokenPipeError:
        _close_stdout()
        return 1
    except OSError as error:
        if error.errno == errno.ENAMETOOLONG:
            say(f"error: a name is too long for a file: {str(error.filename)[:60]}... Choose a shorter one.")
            return ContwalkError.exit_code
        if error.errno not in _UNWRITABLE:
            return _internal(error)
        say(f"error: what is printed cannot be written: {error.strerror}. Free some space.")
        _close_stdout()
        return 1
    except Exception as error:
        return _internal(error)
    finally:
        cache = sys.modules.get("contwalk.object_cache")  # nobody else has a reason to load it
        if cache is not None and cache.refusal:
            say(f"note: {cache.refusal}")


def _untold(*given: Any) -> None:
    """What nobody catches is printed, but for what h5py prints where it lets go of a file that cannot be
    written any more: the command tells that itself.
    """
    error = given[1] if len(given) > 1 else given[0].exc_value
    if str(error).startswith("Can't decrement id ref count"):
        return
    if len(given) > 1:
        sys.__excepthook__(*given)
    else:
        sys.__unraisablehook__(given[0])


def say(text: str) -> None:
    """A line on stderr."""
    click.echo(printable(text), err=True)


def _check_names(arguments: Sequence[str]) -> None:
    """Refuse what is no text, as a name of a file that was written in another encoding.

    Raises
    ------
    ContwalkError
    """
    with suppress(FileNotFoundError):  # the current directory has been removed
        arguments = [*arguments, os.getcwd()]
    for word in arguments:
        try:
            word.encode()
        except UnicodeEncodeError:
            raise ContwalkError(_not_a_name(word)) from None


def _not_a_name(word: str) -> str:
    """A sentence on a name of a file, or another word, that cannot be used, and its remedy."""
    try:
        text = os.fsencode(word).decode()
    except UnicodeEncodeError:
        text = word
    except UnicodeDecodeError:
        return f"The name {word[-60:]!a} is not UTF-8 text. Rename the file or the folder."
    return (
        f"The name {text[-60:]!a} has letters that this locale has not. "
        "Choose one of UTF-8, as LC_ALL=C.UTF-8, or set PYTHONUTF8=1."
    )


def _close_stdout() -> None:
    """Nobody reads any more, as after `| head`, or nothing fits: let what is still buffered go nowhere."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _internal(error: Exception) -> int:
    """An error that is not the user's."""
    if os.environ.get("CONTWALK_TRACEBACK") == "1":
        traceback.print_exception(error)
        where = ""
    else:
        where = " Set CONTWALK_TRACEBACK=1 to see where, and add that to the report."
    say(f"internal error: {type(error).__name__}: {error}. Please report it; it is not your mistake.{where}")
    return 1
