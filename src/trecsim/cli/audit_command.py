"""The command `trecsim audit verify`."""

from pathlib import Path

from trecsim.cli.terminal import counted, finish
from trecsim.errors import Error, InputError


def verify(folder: Path, /, *, json: bool = False) -> None:
    """Check that no entry of an audit log was changed, added or removed.

    Every entry holds a hash of the one before it. Entries that were cut off at the end leave no
    trace in the rest: compare number and last hash with what an earlier call printed.

    Parameters
    ----------
    folder
        The folder with the ledger of a site (`ledger.sqlite`), or a folder above it.
    json
        Print the summary as one JSON object.
    """
    from dataclasses import asdict

    from trecsim.store.ledger import Ledger

    with Ledger(_ledger_folder(folder), repair=False) as ledger:
        verdict = ledger.verify_audit()
    if not verdict.is_whole:
        raise Error(
            f"{folder}: the audit log was changed: entry {verdict.broken_at} of {verdict.entries} "
            "does not fit the one before it"
        )
    summary = {"folder": folder, **asdict(verdict)}
    finish(
        summary,
        json,
        f"{folder}: unchanged, {counted(verdict.entries, 'entry', 'entries')}, "
        f"last hash {verdict.last_hash}",
    )


def _ledger_folder(folder: Path) -> Path:
    from trecsim.store.ledger_file import NAME

    found = [path.parent for path in sorted(folder.glob(f"**/{NAME}"))]
    if len(found) != 1:
        what = f"{len(found)} of them" if found else "none"
        raise InputError(f"{folder}: expected a folder with one ledger ({NAME}), found {what}")
    return found[0]
