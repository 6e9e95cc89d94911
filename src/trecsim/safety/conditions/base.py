"""The seam of the rules: a condition judges one moment."""

from collections.abc import Mapping
from functools import lru_cache
from typing import Any, NamedTuple, Protocol, runtime_checkable

import numpy as np
from jaxtyping import Bool

from trecsim.safety.machine import Finding
from trecsim.safety.rule_scene import Scene
from trecsim.skeleton import COCO17

HERE = -(2**63)
"""Stands in place of a person in findings about a place."""
LEAST = 0.01
"""Findings that are less probable need not be told [probability]."""


def joints_in(row: Bool[np.ndarray, " joint"]) -> tuple[str, ...]:
    """Return the names of the joints for which the row is true.

    Examples
    --------
    >>> joints_in(np.arange(17) < 2)
    ('nose', 'left_eye')
    """
    return _names(row.tobytes())


@lru_cache(4096)
def _names(row: bytes) -> tuple[str, ...]:
    return tuple(name for name, is_in in zip(COCO17.joints, row, strict=True) if is_in)


class Judged(NamedTuple):
    """What a condition found at one moment.

    Attributes
    ----------
    findings
        By person; about a place under `HERE`. Who was seen and is not among them does not fulfil
        the condition.
    memory
        What the condition wants to be given at the next moment.
    fault
        Why it could not judge this moment, such as a silent feed; all episodes stay as they are.
    """

    findings: Mapping[int, Finding]
    memory: Any = None
    fault: str | None = None


@runtime_checkable
class Condition(Protocol):
    """Finds out who fulfils a condition; depends on nothing but what it is given."""

    def judge(self, scene: Scene, memory: Any = None) -> Judged:
        """Judge one moment.

        Parameters
        ----------
        scene
            The moment. Only people in `scene.seen` are judged.
        memory
            What the condition returned the moment before; None at the first.
        """
        ...
