"""The frame number in file names of other programs: the number that differs from name to name."""

import re
from collections.abc import Iterable, Sequence
from itertools import pairwise

from trecsim.sources.faults import FaultError

MAX_FRAME = 10**15
_NUMBER = re.compile(r"[0-9]+")


def frame_place(stems: Sequence[str], camera: str = "") -> int:
    """Return which of the numbers in file names is the frame's, counted from the end: -1, -2, ...

    It is the number that differs in every name. If the names differ in more than their numbers, or
    there is only one name, the last number is taken; in a single name, numbers in the name of the
    camera (``000012_cam1``) are ignored.

    Parameters
    ----------
    stems
        Different file names without their ending.
    camera
        Name of the camera they belong to.

    Raises
    ------
    FaultError
        When two numbers could be it, or none could.

    Examples
    --------
    >>> frame_place(["000012_cam1", "000013_cam1"]), frame_place(["cam1_000012", "cam1_000013"])
    (-2, -1)
    """
    if len(stems) == 1:
        return _last_but_of(camera, stems[0])
    if len({_NUMBER.sub("0", stem) for stem in stems}) != 1:
        return -1
    columns = list(zip(*(numbers(stem) for stem in stems), strict=True))
    varying = [place for place, column in enumerate(columns) if len(set(column)) > 1]
    unique = [place for place in varying if len(set(columns[place])) == len(stems)]
    different = {columns[place] for place in unique}
    if len(different) > 1:
        unique = [place for place in unique if _is_counted(columns[place])]
        different = {columns[place] for place in unique}
    if len(different) == 1:
        return unique[-1] - len(columns)
    raise FaultError(
        f"cannot tell the frame number in names like {stems[0][:60]!r} and {stems[1][:60]!r}: "
        f"{'several numbers count' if unique else 'no number is another in each of'} them; rename "
        "them so that one number counts the frames"
    )


def _is_counted(column: Iterable[int]) -> bool:
    """Tell whether sorted numbers grow by one as a rule, as those of frames do."""
    steps = sorted(after - before for before, after in pairwise(sorted(column)))
    return steps[len(steps) // 2] == 1


def _last_but_of(camera: str, stem: str) -> int:
    """Return the place of the last number that is no part of the camera's name."""
    found = list(_NUMBER.finditer(stem))
    start = stem.find(camera) if camera else -1
    free = [
        place
        for place, match in enumerate(found)
        if start < 0 or match.end() <= start or match.start() >= start + len(camera)
    ]
    return free[-1] - len(found) if free else -1


def numbers(stem: str) -> list[int]:
    """Return the numbers in a name, first to last; one with very many digits is no frame's."""
    return [int(match[:16]) for match in _NUMBER.findall(stem)]


def frame_number(stem: str, place: int) -> int:
    """Return the frame number in a file name.

    Parameters
    ----------
    stem
        The name without its ending.
    place
        Which number it is, of `frame_place`.

    Raises
    ------
    FaultError
        When there is none there.
    """
    found = numbers(stem)
    if len(found) < -place or found[place] >= MAX_FRAME:
        raise FaultError(f"there is no frame number in the name {stem[:60]!r}")
    return found[place]
