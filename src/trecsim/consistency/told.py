"""What is said of cameras that do not fit: what is seen, the likely cause, what to do."""

import math
from collections.abc import Sequence
from fractions import Fraction

from trecsim.consistency.hypotheses import Hypothesis
from trecsim.consistency.spans import Span
from trecsim.consistency.turns import Turn
from trecsim.consistency.wording import cameras, listed, seconds
from trecsim.geometry import Rig

_NO_HINT = "it was moved, its times are wrong, or it is another camera"
_WRONG_RIG = (
    "is it the rig of these recordings, are cameras called alike in both, and are their times "
    "right?"
)
LATE_S = 1.0  # a camera that begins so much later or earlier may have a wrong clock
RATE = 0.1  # by how much the ratio of lengths may be beside that of images


def hypothesis(found: Hypothesis, rig: Rig, other: Hypothesis | None = None) -> tuple[str, str]:
    """Return cause and text of what would make the cameras agree, or `other` would as well."""
    names = [rig.names[c] for c in sorted(found.source)]
    which = cameras(names, len(rig))
    cause = f"{found.cause} {names}"
    if found.cause == "exchanged":
        return cause, _exchanged(found, rig) if other is None else _either(found, other, rig)
    if found.cause == "mirrored":
        return cause, (
            f"the images of {which} seem to be mirrored: when they are flipped, the cameras agree "
            "on where people are; flip the images, or estimate the poses without mirroring"
        )
    width, height = rig[names[0]].size_px
    size = f"{width / found.factor:.0f} x {height / found.factor:.0f}"
    example = f" (camera {names[0]!r}: {size} instead of {width} x {height})"
    return cause, (
        f"the key points of {which} seem to be in pixels of images {_times(1 / found.factor)} the "
        f"size that the rig states{example}: with that size the cameras agree on where people are; "
        f"multiply the key points by {found.factor:.3g}, or use a rig for that size"
    )


def _exchanged(found: Hypothesis, rig: Rig) -> str:
    names = [rig.names[c] for c in sorted(found.source)]
    if len(names) == 2:
        swap = f"{cameras(names, 0)} seem to be exchanged"
    else:
        whose = [
            f"{rig.names[b]!r} shows {rig.names[a]!r}" for a, b in sorted(found.source.items())
        ]
        swap = f"cameras seem to be exchanged: what is called {listed(whose)}"
    return (
        f"{swap}: with exchanged names they agree on where people are; "
        "exchange their names in the poses or in the rig"
    )


def _either(found: Hypothesis, other: Hypothesis, rig: Rig) -> str:
    one, two = (
        " and ".join(repr(rig.names[c]) for c in sorted(it.source))
        for it in sorted((found, other), key=lambda it: min(it.source))
    )
    return (
        f"either cameras {one} or cameras {two} seem to be exchanged: with one of these pairs "
        "exchanged all agree on where people are; find out whose image is whose, and exchange "
        "their names in the poses or in the rig"
    )


def _times(factor: float) -> str:
    """Return a factor in words.

    Examples
    --------
    >>> _times(0.5), _times(2.0), _times(2 / 3), _times(1.5)
    ('half', 'twice', '2/3', '3/2')
    """
    words = {0.5: "half", 2.0: "twice"}
    return words.get(factor, str(Fraction(factor).limit_denominator(4)))


def turned(name: str, turn: Turn, since_s: float | None) -> str:
    """Return what is said of a camera that looks elsewhere than the rig states."""
    size = f"about {math.degrees(turn.shift_rad):.2g} degrees ({turn.before_m:.2g} m at the people)"
    if since_s is not None:
        return (
            f"camera {name!r} seems to have been moved at about {seconds(since_s)} s: since then "
            f"people appear {size} away from where the other cameras see them; calibrate it again"
        )
    return (
        f"camera {name!r} does not look where the rig says: people appear {size} away from where "
        "the other cameras see them; it was turned or moved after calibration: calibrate it again"
    )


def moved(name: str, size_rad: float, off_m: float, since_s: float) -> str:
    """Return what is said of a camera that was moved during the recording."""
    return (
        f"camera {name!r} seems to have been moved at about {seconds(since_s)} s: since then "
        f"people appear {math.degrees(size_rad):.2g} degrees ({off_m:.2g} m) away from where they "
        "did before; calibrate it again for the time from then on"
    )


def odd(name: str, share: float, since_s: float | None, hint: str) -> str:
    """Return what is said of a camera that does not agree with the others, for whatever reason."""
    since = "" if since_s is None else f" since about {seconds(since_s)} s"
    return (
        f"camera {name!r} does not agree with the others on where people are{since} (in "
        f"{share:.0%} of the cases): {hint or _NO_HINT}"
        "; look at its images, its entry in the rig and its times"
    )


def wrong_rig(names: Sequence[str], tried: Sequence[int], share: float, hint: str) -> str:
    """Return what is said where no cameras agree."""
    two = len(tried) == 2
    which = f"{cameras([names[c] for c in tried], 0)} do not" if two else "no two cameras"
    return (
        f"{which} agree on where people are (in {share:.0%} of the cases, as by chance): "
        f"{f'of one of them, {hint}' if hint else _WRONG_RIG}"
    )


def clock(name: str, hint: str) -> str:
    """Return what is said at the end of a camera that did not agree with the others."""
    return f"camera {name!r}, which does not agree with the others: {hint}"


def clock_hint(c: int, spans: Sequence[Span]) -> str:
    """Return what is odd about a camera's times, if something is."""
    own, others = spans[c], [one for k, one in enumerate(spans) if k != c and one.images]
    if not others or not own.images:
        return ""
    begin_s = sorted(one.first_s for one in others)[len(others) // 2]
    late_s = own.first_s - begin_s
    rest_s = sorted(one.last_s - one.first_s for one in others)[len(others) // 2]
    images = sorted(one.images for one in others)[len(others) // 2]
    if abs(late_s) >= LATE_S:
        when = "after" if late_s > 0 else "before"
        return (
            f"its images begin {seconds(abs(late_s))} s {when} the others', so that its clock or "
            "time_offset_s may be wrong"
        )
    length_s = own.last_s - own.first_s
    ratio = own.images / max(1, images)
    if ratio < 0.8 and abs(length_s / max(rest_s, 1e-9) - ratio) < RATE * ratio:
        return (
            f"it has {own.images} images in {seconds(length_s)} s where the others have {images} "
            f"in {seconds(rest_s)} s, so that its rate may be another one than stated"
        )
    return ""
