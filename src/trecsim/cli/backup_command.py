"""The command `trecsim backup`."""

from pathlib import Path

from trecsim.cli.terminal import counted, finish


def backup(folder: Path, out: Path, /, *, json: bool = False) -> None:
    """Back up the recordings and the ledger of a site to one file, while the site runs.

    The ledger (events, what people did to them, audit log) is copied as of one moment, and of each
    recording the files of one moment. The file holds personal data: only its owner may read it.

    Parameters
    ----------
    folder
        A recording, or the folder with the recordings of a site.
    out
        The file to write, for example `site.tar`.
    json
        Print the summary as one JSON object.
    """
    from dataclasses import asdict

    from trecsim.store.backup import backup as backed_up

    done = backed_up(folder, out)
    finish(
        {"out": out, **asdict(done)},
        json,
        f"{out}: {counted(done.recordings, 'recording')} and "
        f"{counted(done.events, 'event')}, "
        f"{done.size_bytes / 1e6:.1f} MB",
    )
