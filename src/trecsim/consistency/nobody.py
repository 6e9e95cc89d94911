"""Why nobody was found in a whole recording."""

from collections.abc import Mapping

from trecsim.consistency.spans import Span
from trecsim.consistency.wording import cameras
from trecsim.geometry import Rig


def why(spans: Mapping[str, Span], rig: Rig, frame_sets: int, together: int) -> str:
    """Return a remark on a recording in which nobody was found in 3D.

    Parameters
    ----------
    spans
        Of the cameras that delivered.
    rig
        The cameras.
    frame_sets, together
        How many frame sets there were, and in how many of them two cameras or more found somebody.
    """
    images = sum(span.images for span in spans.values())
    seeing = [name for name, span in spans.items() if span.with_people]
    if not images:
        return "the poses hold no image, so there are no people"
    if not seeing:
        return (
            f"0 people: the poses hold no person in {_counted(images, 'image')} of "
            f"{_counted(len(spans), 'camera')}"
        )
    if len(rig) == 1:
        return (
            "0 people: the rig has one camera; a position in 3D needs two that see the same person"
        )
    if len(seeing) == 1:
        return (
            f"0 people: only {cameras(seeing, len(rig))} sees people; a position in 3D needs two "
            "cameras that see the same person"
        )
    if not together:
        return (
            "0 people: no two cameras see a person at the same time; a position in 3D needs two "
            "cameras that see the same person. If they do, their times are wrong: give "
            "time_offset_s in the rig"
        )
    return (
        f"0 people, although two or more cameras see people in {together} of "
        f"{_counted(frame_sets, 'frame set')}: they do not agree on where people are, or see each "
        "person for too short a time. Is it the rig of these recordings, and are the times right?"
    )


def _counted(count: int, what: str) -> str:
    return f"{count} {what}" if count == 1 else f"{count} {what}s"
