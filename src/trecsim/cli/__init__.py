"""The command `trecsim`, and the one place where errors become a line.

Commands are registered by name only; their module is imported when one is called, so that
``trecsim --help`` needs neither NumPy nor the rest of the package.
"""

import logging
import os
import signal
import sys
import warnings
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from difflib import get_close_matches
from importlib.metadata import version
from threading import current_thread, main_thread

from cyclopts import App, CycloptsError, Parameter, UnknownCommandError

from trecsim.errors import Error
from trecsim.redaction import redacted

COMMANDS = {
    "demo": "Run a simulated site, with its live page: no camera, no download.",
    "run": "Run the pipeline of a site file: cameras or recordings in, people in 3D out.",
    "replay": "Play a recording on the live page.",
    "estimate": "Estimate 2D poses in videos.",
    "track": "Track people in 3D from 2D poses.",
    "sync": "Bring the clocks of cameras into step, by the people whom several of them see.",
    "assess": "Judge the rules of a site file on recorded tracks; write the events.",
    "evaluate": "Evaluate tracks with or without ground truth.",
    "evaluate-events": "Evaluate events of rules against true events.",
    "forecast": "Forecast where people will be in the next seconds.",
    "evaluate-forecast": "Evaluate forecasts on recorded paths.",
    "export": (
        "Convert tracks to another format: tables, OpenSim, C3D, Blender, USD, PedPy and others."
    ),
    "render": "Make a film or a picture of tracks: over the videos, in 3D and on the floor plan.",
    "backup": "Back up the recordings and the ledger of a site to one file, while the site runs.",
    "restore": "Restore a backup to a new folder.",
    "erase": "Delete a period from recordings, for everybody or for one person.",
    "report": "Write a report on a recording: one HTML page with quality checks.",
    "day-report": (
        "Write the report of a day of a site: alerts, counts, dwell and density on one HTML page."
    ),
    "simulate": "Simulate a scene: synthetic 2D poses with ground truth.",
    "study": "Vary settings of the fusion on synthetic scenes; report which of them matter.",
    "doctor": "Check the installation, and the cameras of a site.",
    "warmup": "Compile the kernels of the fusion and the rules now instead of at the first run.",
    "sample": "Download a real multi-camera recording to try.",
}
GROUPS = {
    "rig": (
        "Show and convert camera calibrations.",
        {
            "show": "Show the cameras of a rig: a table, and a picture from above.",
            "convert": "Convert a rig to another format.",
        },
    ),
    "calibrate": (
        "Calibrate cameras, and judge the result.",
        {
            "intrinsics": "Calibrate lenses with a board: focal length, centre and distortion.",
            "rig": "Calibrate where cameras stand with a board that is carried through the room.",
            "floor": "Put a rig on its floor, with origin and heading, by a board or known points.",
            "board": "Write a calibration board to print, in true size, as PDF.",
            "people": "Calibrate cameras from people who walk: poses, clocks, and a verdict.",
            "check": "Check by the people in a recording whether a rig is still right.",
            "repair": "Repair a rig by the people in a recording: as it is at the end.",
            "revoke": "Take back the repair of a rig that a live site made by itself.",
        },
    ),
    "site": (
        "Write and check site files, and print their schema.",
        {
            "new": "Write a site file for live cameras, for videos, or for 2D poses.",
            "check": "Check a site file and everything it names.",
            "schema": "Print the JSON schema of site files.",
        },
    ),
    "users": (
        "Manage who may sign in at the live page.",
        {
            "add": "Add a user of the page, or give one a new password.",
            "list": "List the users of the page.",
            "role": "Give a user of the page another role.",
            "remove": "Remove a user of the page.",
        },
    ),
    "audit": (
        "Check the audit log of a site.",
        {"verify": "Check that no entry of an audit log was changed, added or removed."},
    ),
    "models": (
        "Manage the files of pose models.",
        {
            "list": "List the known models and whether they are downloaded.",
            "pull": "Download a model and verify it.",
            "path": "Print the path of a model.",
        },
    ),
}


def command_line(called: Sequence[str] = ()) -> App:
    """Return the command with all its sub-commands, none of them imported.

    Parameters
    ----------
    called
        The command about to run. Its help is its full docstring; the help of all others is the
        line in the list of commands.
    """
    app = App(
        name="trecsim",
        help="Track every person in 3D from two or more fixed, calibrated cameras.",
        version=lambda: f"trecsim {version('mc3d-trecsim')}",
        help_epilogue="Exit codes: 0 done, 2 the input is wrong, 1 anything else.",
        default_parameter=Parameter(negative=()),
        suppress_keyboard_interrupt=False,
    )
    _add(app, "", COMMANDS, called[:1])
    for group, (about, commands) in GROUPS.items():
        sub = App(name=group, help=about)
        _add(sub, f"{group}:", commands, called[1:2] if called[:1] == [group] else ())
        app.command(sub)
    app.register_install_completion_command(help="Install shell completion (bash, zsh, fish).")
    return app


def _add(app: App, group: str, commands: Mapping[str, str], called: Sequence[str]) -> None:
    for name, text in commands.items():
        module = f"{(group or name).rstrip(':').replace('-', '_')}_command:"
        function = f"{name}_" if name == "list" else name.replace("-", "_")  # a word of Python
        help_text = None if [name] == list(called) else text
        app.command(f"trecsim.cli.{module}{function}", name=name, help=help_text)


def main(arguments: Sequence[str] | None = None) -> None:
    """Run one command; end the process with the exit code that scripts rely on.

    Parameters
    ----------
    arguments
        The arguments after ``trecsim``; None takes them from the command line.

    Raises
    ------
    SystemExit
        Always, with 0 (done), 2 (the user's input is wrong) or 1 (anything else).
    """
    with _warnings_as_lines(), _terminated_as_interrupted():
        raise SystemExit(_run(sys.argv[1:] if arguments is None else list(arguments)))


class _Line(logging.Formatter):
    """Formats a message of the library without the passwords in its addresses."""

    def format(self, record: logging.LogRecord) -> str:
        return redacted(super().format(record))


@contextmanager
def _terminated_as_interrupted() -> Iterator[None]:
    """Let SIGTERM, as systemd and containers send it, do what Ctrl-C does."""
    if current_thread() is not main_thread():  # only there signals are handled
        yield
        return
    before = signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)


@contextmanager
def _warnings_as_lines() -> Iterator[None]:
    """Show warnings and log messages of the library like errors: one line each on stderr."""
    if logging.lastResort is not None:
        logging.lastResort.setFormatter(_Line("trecsim: %(message)s"))
    with warnings.catch_warnings():
        warnings.showwarning = lambda message, *_, **__: print(
            f"trecsim: {message}", file=sys.stderr
        )
        yield


def _run(arguments: list[str]) -> int:
    try:
        app = command_line(arguments[:2])
        app(arguments, exit_on_error=False, print_error=False, result_action="return_none")
        sys.stdout.flush()
    except CycloptsError as error:
        return _tell(_argument_fault(error), 2)
    except Error as error:
        return _tell(str(error), error.exit_code)
    except KeyboardInterrupt as error:  # a command that kept something says so in the text
        return _tell(str(error) or "stopped", 1)
    except BrokenPipeError:  # the reader of stdout went away, as `head` does
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 1
    except Exception as error:  # the boundary: users get a line, not a traceback
        if os.environ.get("TRECSIM_DEBUG"):
            raise
        return _tell(_report(error), 1)
    return 0


def _tell(message: str, exit_code: int) -> int:
    print(f"trecsim: {redacted(message)}", file=sys.stderr)
    return exit_code


def _argument_fault(error: CycloptsError) -> str:
    chain = error.command_chain or ()
    if isinstance(error, UnknownCommandError):  # its own text would import every command
        known = GROUPS[chain[0]][1] if chain else [*COMMANDS, *GROUPS]
        text = _unknown_command((error.unused_tokens or ["?"])[0], known)
    else:
        text = _one_line(str(error))
    return f"{text} See: {' '.join(['trecsim', *chain, '--help'])}"


def _unknown_command(name: str, known: Iterable[str]) -> str:
    if name.startswith("-"):
        return f"there is no option {name!r}."
    near = get_close_matches(name, known, n=1)
    if near:
        return f"there is no command {name!r}; did you mean {near[0]!r}?"
    return f"there is no command {name!r}; there are: {', '.join(sorted(known))}."


def _one_line(text: str) -> str:
    return " ".join(text.split())


def _report(error: Exception) -> str:
    return (
        f"internal error: {type(error).__name__}: {_one_line(str(error))}; set TRECSIM_DEBUG=1 "
        "to see the traceback, and report it with that output"
    )
