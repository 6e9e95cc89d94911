"""Output of commands: results to stdout, everything else to stderr."""

import json
import math
import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import asdict, is_dataclass
from typing import TYPE_CHECKING, Any

from trecsim.redaction import redacted

if TYPE_CHECKING:
    from rich.progress import Progress, TaskID


class ProgressBar:
    """Progress of a long task; can be passed to the library as its `progress`."""

    def __init__(self, bar: "Progress | None" = None, task: "TaskID | None" = None) -> None:
        self._bar = bar
        self._task = task

    def advance(self, n: int = 1) -> None:
        """Add `n` finished steps."""
        if self._bar is not None and self._task is not None:
            self._bar.advance(self._task, n)

    def __call__(self, done: int, total: int | None) -> None:
        """Set the finished steps and, once it is known, how many there are."""
        if self._bar is not None and self._task is not None:
            self._bar.update(self._task, completed=done, total=total)


def counted_people(count: int) -> str:
    """Return a number of people in words.

    Examples
    --------
    >>> counted_people(1), counted_people(2)
    ('1 person', '2 people')
    """
    return "1 person" if count == 1 else f"{count} people"


def counted(count: int, what: str, several: str | None = None) -> str:
    """Return a number of things in words.

    Examples
    --------
    >>> counted(1, "row"), counted(0, "row"), counted(2, "entry", "entries")
    ('1 row', '0 rows', '2 entries')
    """
    return f"{count} {what if count == 1 else several or f'{what}s'}"


def fusion_time(ms: Mapping[str, float]) -> str:
    """Return the fusion time per frame set as the end of a sentence; nothing without frame sets.

    Examples
    --------
    >>> fusion_time({"median": 0.31, "p95": 0.4})
    '; fusion: median 0.31 ms per frame set, 95th percentile 0.40 ms'
    >>> fusion_time({"median": math.nan, "p95": math.nan})
    ''
    """
    if not math.isfinite(ms["median"]):
        return ""
    return (
        f"; fusion: median {ms['median']:.2f} ms per frame set, 95th percentile {ms['p95']:.2f} ms"
    )


@contextmanager
def progress_bar(
    description: str,
    total: int | None = None,
    *,
    quiet: bool = False,
    time_left: bool = False,
) -> Iterator[ProgressBar]:
    """Show a bar on stderr while the block runs.

    Parameters
    ----------
    description
        The task, in a few words.
    total
        Number of steps; None while it is unknown.
    quiet
        Show nothing. Nothing is shown either if stderr is not a terminal.
    time_left
        Show the remaining time instead of the elapsed time.
    """
    if quiet or not sys.stderr.isatty():
        yield ProgressBar()
        return
    # Imported here: a third of the time that `trecsim --help` may take.
    from rich.console import Console
    from rich.progress import (
        BarColumn,
        MofNCompleteColumn,
        Progress,
        TextColumn,
        TimeElapsedColumn,
        TimeRemainingColumn,
    )

    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeRemainingColumn() if time_left else TimeElapsedColumn(),
    )
    with Progress(*columns, console=Console(stderr=True)) as bar:
        yield ProgressBar(bar, bar.add_task(description, total=total))


def note(text: str) -> None:
    """Write a remark to stderr."""
    print(f"trecsim: {redacted(text)}", file=sys.stderr)


def finish(summary: Mapping[str, Any], as_json: bool, text: str) -> None:
    """Print the result of a command on stdout.

    Parameters
    ----------
    summary
        The result as names and values; numbers that are not finite become null.
    as_json
        Print `summary` as one JSON object instead of `text`.
    text
        The result as text.
    """
    print(json.dumps(plain(summary), allow_nan=False) if as_json else text)


def plain(value: Any) -> Any:
    """Turn a result into what JSON can hold: arrays to lists, paths to text, NaN to null."""
    if hasattr(value, "tolist"):  # arrays and their scalars, without importing NumPy
        return plain(value.tolist())
    if isinstance(value, Mapping):
        return {str(key): plain(item) for key, item in value.items()}
    if is_dataclass(value) and not isinstance(value, type):
        return plain(asdict(value))
    if isinstance(value, (list, tuple, set, frozenset)):
        return [plain(item) for item in value]
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if value is None or isinstance(value, (bool, int, str)):
        return value
    return str(value)
