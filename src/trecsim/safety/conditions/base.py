"""The seam of the rules: a condition judges one moment."""

from collections.abc import Mapping
from typing import Any, NamedTuple, Protocol, runtime_checkable

from trecsim.safety.machine import Finding
from trecsim.safety.rule_scene import Scene

HERE = -(2**63)
"""Stands in place of a person in findings about a place."""
LEAST = 0.01
"""Findings that are less probable need not be told [probability]."""


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
        Why it could not judge this moment, as a feed is silent; all episodes stay as they are.
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
