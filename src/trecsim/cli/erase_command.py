"""The command `trecsim erase`."""

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from trecsim.cli.given_times import moment_s
from trecsim.cli.terminal import counted, finish, note


def erase(
    folder: Path,
    /,
    *,
    from_: Annotated[str, Parameter(name="--from")],
    to: str,
    person: int | None = None,
    json: bool = False,
) -> None:
    """Delete a period from recordings, for everybody or for one person.

    The files are rewritten without these rows; a site may go on recording meanwhile. The act is
    entered in the audit log (`ledger.sqlite`), which is made if it is missing. Events of the time
    stay until their own limit, without the people whom they list and where these were; what
    outputs have sent, and backups, are not changed. 2D poses (`poses.jsonl`) have no identities:
    they are deleted only where the period is deleted for everybody.

    Parameters
    ----------
    folder
        A recording, or the folder with the recordings of a site.
    from_
        First moment: seconds as in the recording, or a date and time (UTC unless it has an offset).
    to
        Last moment.
    person
        Only this identity.
    json
        Print the summary as one JSON object.
    """
    from dataclasses import asdict

    from trecsim.store.erasing import erase as erased

    done = erased(folder, moment_s(from_, "--from"), moment_s(to, "--to"), person=person)
    for remark in done.remarks:
        note(remark)
    finish(
        {"folder": folder, **asdict(done)},
        json,
        f"{counted(done.rows, 'row')} deleted from {counted(done.files, 'file')} of "
        f"{counted(len(done.recordings), 'recording')}; people taken out of "
        f"{counted(done.events, 'event')}",
    )
