"""Match names of cameras in other files to those of the rig."""

import difflib
import re
from collections.abc import Collection, Mapping

RENAMED = "where the poses come from"
_WORD = re.compile(r"[A-Za-z]+|[0-9]+")


def unknown_camera(name: str, known: Collection[str], elsewhere: str = RENAMED) -> str:
    """Return the message that the rig has no camera `name`, with the one that may be meant.

    No suggestion is made for names with numbers: the wrong camera would spoil all results.

    Parameters
    ----------
    name
        The camera.
    known
        Those of the rig.
    elsewhere
        Where else the name can be changed than in the rig.

    Examples
    --------
    >>> unknown_camera("nord", ["north", "south"])
    "camera 'nord' is not in the rig; known: north, south; did you mean 'north'?"
    """
    text = f"camera {name!r} is not in the rig; known: {', '.join(sorted(known)) or 'none'}"
    numbered = any(character.isdigit() for character in name)
    near = [] if numbered else difflib.get_close_matches(name, sorted(known), n=1)
    if near:
        return f"{text}; did you mean {near[0]!r}?"
    return f"{text}; rename it in the rig or {elsewhere}"


def candidates(name: str, cameras: Collection[str]) -> list[str]:
    """Return the cameras whose name is contained in another name, or contains it.

    Words and numbers are compared; capitals and separators do not matter.

    Examples
    --------
    >>> candidates("2024_Cam1_walk", ["cam1", "cam2", "cam12"])
    ['cam1']
    >>> candidates("cam_01", ["int_cam01_img", "int_cam02_img"])
    ['int_cam01_img']
    """
    if name in cameras:
        return [name]
    words = _words(name)
    return [c for c in cameras if _stands_in(_words(c), words) or _stands_in(words, _words(c))]


def _words(name: str) -> list[str]:
    return _WORD.findall(name.lower())


def _stands_in(part: list[str], whole: list[str]) -> bool:
    n = len(part)
    return n > 0 and any(whole[i : i + n] == part for i in range(len(whole) - n + 1))


def renamed(names: Collection[str], cameras: Collection[str]) -> Mapping[str, str]:
    """Return the camera of the rig for each name, where that is beyond doubt; else the name.

    Examples
    --------
    >>> renamed(["cam1", "cam2"], ["int_cam1_img", "int_cam2_img"])
    {'cam1': 'int_cam1_img', 'cam2': 'int_cam2_img'}
    """
    found = {name: candidates(name, cameras) for name in names}
    taken = [near[0] for near in found.values() if len(near) == 1]
    return {
        name: near[0] if len(near) == 1 and taken.count(near[0]) == 1 else name
        for name, near in found.items()
    }
