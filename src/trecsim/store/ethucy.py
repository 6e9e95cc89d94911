"""The sets of ETH/UCY, as tables of forecasts use them."""

from collections.abc import Sequence
from pathlib import Path

from trecsim.errors import InputError

TRUE_TIME = "eth in true time"
"""The ETH scene with its own clock; the copy that published tables use runs 1.67 times too fast."""
SETS = {
    "eth": ("biwi_eth",),
    TRUE_TIME: ("eth_original_obsmat",),
    "hotel": ("biwi_hotel",),
    "univ": ("students001", "students003"),
    "zara1": ("crowds_zara01",),
    "zara2": ("crowds_zara02",),
}
"""The recordings of each set."""


def sets_in(inputs: Sequence[Path]) -> dict[str, list[Path]]:
    """Return the files of each set, by name: the sets of an ETH/UCY folder, and other inputs.

    Raises
    ------
    InputError
        When an ETH/UCY folder lacks a file.
    """
    found: dict[str, list[Path]] = {}
    for path in inputs:
        if (path / "biwi_hotel.txt").is_file():
            found |= _of_folder(path)
        else:
            found[_name(path, found)] = [path]
    return found


def _of_folder(folder: Path) -> dict[str, list[Path]]:
    files = {name: [folder / f"{stem}.txt" for stem in stems] for name, stems in SETS.items()}
    missing = [file.name for found in files.values() for file in found if not file.is_file()]
    if missing:
        raise InputError(f"{folder}: this looks like ETH/UCY, but lacks {', '.join(missing)}")
    return files


def _name(path: Path, taken: dict[str, list[Path]]) -> str:
    return path.stem if path.stem not in taken else str(path)
