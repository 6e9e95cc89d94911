"""The folder of a demo: its site file, and what is replaced in it."""

from pathlib import Path

from trecsim.errors import InputError
from trecsim.extras import has_extra
from trecsim.lab.packs.pack_files import pack_feeds, pack_site
from trecsim.store.atomic import atomic_write, disk_faults
from trecsim.store.ledger_file import discard_ledger
from trecsim.store.names import POSES, RIG, TRUTH
from trecsim.store.recordings import discard_recording

MARK = "# Made by trecsim demo."
HEAD = f"{MARK} Run it again as any other site: trecsim run site.toml\n"
SITE = f"""{HEAD}format = "trecsim.site/1"
name = "demo"
rig = "{RIG}"
poses = "{POSES}"

[zones.middle]
polygon_m = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]

[[rules]]     # advisory: trecsim is no certified safety function
id = "middle"
kind = "zone.enter"
zone = "middle"
severity = "info"

[[rules]]
id = "crowd"
kind = "occupancy.limit"
zone = "middle"
limit = 3

[[rules]]
id = "running"
kind = "speed.running"

[[rules]]
id = "fall"
kind = "body.fall"
severity = "alarm"
"""
PAGE = """
[page]
port = 0      # takes a free port
"""
RUN = "run"
RUN_FILES = ("tracks.parquet", RIG, TRUTH, "timing.csv", "summary.json", "paths.png")


def make_room(folder: Path, pack: str | None = None) -> None:
    """Make the folder of a demo, or remove what an earlier one left there, and nothing else.

    Then write its site file, which marks the folder as that of a demo.

    Parameters
    ----------
    folder
        The folder.
    pack
        A scenario pack whose site it is; None for the usual room.

    Raises
    ------
    InputError
        There is something in it that no demo has made.
    SetupError
        The disk is full.
    """
    with disk_faults(folder):
        if folder.exists() and any(folder.iterdir()) and not _is_ours(folder):
            raise InputError(
                f"{folder} holds something that trecsim demo has not made; nothing is "
                "overwritten: give another directory with --out"
            )
        folder.mkdir(parents=True, exist_ok=True)
        pictures = (folder / "paths.png", folder / "moment.png")
        made = [*pictures, *(folder / RUN / name for name in RUN_FILES)]
        for path in made:
            path.unlink(missing_ok=True)
        discard_recording(folder / RUN)
        discard_ledger(folder / RUN)
    for name, text in ({} if pack is None else pack_feeds(pack)).items():
        with atomic_write(folder / name) as file:
            file.write(text)
    with atomic_write(folder / "site.toml") as file:
        site = SITE if pack is None else f"{HEAD}{pack_site(pack)}"
        file.write(site + (PAGE if has_extra("page") else ""))


def _is_ours(folder: Path) -> bool:
    site = folder / "site.toml"
    if not site.is_file():
        return False
    with site.open("rb") as file:
        return file.read(len(MARK)) == MARK.encode()
