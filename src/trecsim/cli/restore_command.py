"""The command `trecsim restore`."""

from pathlib import Path

from trecsim.cli.terminal import counted, finish


def restore(archive: Path, folder: Path, /, *, json: bool = False) -> None:
    """Restore a backup to a new folder.

    Parameters
    ----------
    archive
        What `trecsim backup` has written.
    folder
        The folder to make; it must be new or empty.
    json
        Print the summary as one JSON object.
    """
    from dataclasses import asdict

    from trecsim.store.backup import restore as restored

    done = restored(archive, folder)
    finish(
        {"folder": folder, **asdict(done)},
        json,
        f"{folder}: {counted(done.recordings, 'recording')} and "
        f"{counted(done.events, 'event')}, "
        f"{done.size_bytes / 1e6:.1f} MB",
    )
