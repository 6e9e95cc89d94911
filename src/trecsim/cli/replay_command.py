"""The command `trecsim replay`."""

from pathlib import Path

from trecsim.cli.page_line import tell_page
from trecsim.cli.stopping import stopping_in_order
from trecsim.cli.terminal import finish, note
from trecsim.errors import InputError


def replay(
    recording: Path, /, *, speed: float = 1.0, port: int | None = None, json: bool = False
) -> None:
    """Play a recording on the live page.

    Shows what was seen live, number for number. It goes on until Ctrl-C; after the end of the
    recording the page shows that end.

    Parameters
    ----------
    recording
        The directory of a recording of `trecsim run`.
    speed
        How much faster than it was, as 2 or 0.5.
    port
        TCP port of the page; 0 takes a free one. Without it: 8765, or a free one if that is taken.
    json
        Print the summary as one JSON object.
    """
    from trecsim.cli.page_line import page_anywhere
    from trecsim.page.page_data import PageData
    from trecsim.service.replaying import (
        FASTEST,
        SLOWEST,
        recording_at,
        recording_view,
    )
    from trecsim.service.replaying import replay as play

    if not SLOWEST <= speed <= FASTEST:
        raise InputError(f"--speed: expected {SLOWEST:g} to {FASTEST:g}, found {speed:g}")
    found = recording_at(recording)
    view = recording_view(found)
    data = PageData(recordings=found.folder)
    with stopping_in_order() as stop, page_anywhere(view, data, port) as page:
        tell_page(page.url, json=json)
        note("the replay goes on until Ctrl-C")
        play(found, page, speed=speed, stop=stop)
    facts = {
        "recording": found.folder,
        "from_s": found.from_s,
        "to_s": found.to_s,
        "people": found.people,
    }
    finish(facts, json, f"{found.folder}: {found.people} people, {found.to_s - found.from_s:.1f} s")
