"""The state of one rule while it is judged: its episodes, and what it has warned of."""

from dataclasses import dataclass, field
from typing import Any, NamedTuple

from trecsim.safety.conditions.base import Condition
from trecsim.safety.early_warning import Foreseeing
from trecsim.safety.machine import LIKELY, Change, Episode, Finding
from trecsim.safety.rule import Rule
from trecsim.safety.rule_scene import Scene
from trecsim.safety.warned import Warned


class Opened(NamedTuple):
    """An episode that a warning has opened.

    Attributes
    ----------
    start_s
        The predicted time; the identity of the episode follows from it [s].
    told_s
        When the warning was given [s].
    came_s
        When the worse thing began that was warned of, where the rule warns of such [s].
    """

    start_s: float
    told_s: float
    came_s: float | None = None


@dataclass(slots=True, eq=False)
class RuleState:
    """The state of one rule.

    Attributes
    ----------
    rule, condition
        The rule, and what it looks for.
    memory
        Of the condition.
    episodes
        By person, or under `HERE`; without those of which nothing has to be remembered.
    seen
        Of each of these the scene in which the condition held last.
    foreseeing
        The condition, where the rule warns early.
    warned
        What is expected, by person.
    opened
        Episodes that a warning has opened, by person.
    """

    rule: Rule
    condition: Condition
    memory: Any = None
    episodes: dict[int, Episode] = field(default_factory=dict)
    seen: dict[int, Scene] = field(default_factory=dict)
    foreseeing: Foreseeing | None = None
    warned: dict[int, Warned] = field(default_factory=dict)
    opened: dict[int, Opened] = field(default_factory=dict)

    @staticmethod
    def of(rule: Rule) -> "RuleState":
        """Return the state of a rule that has judged nothing yet."""
        condition = rule.kind.condition(rule)
        if rule.early_s > 0.0 and isinstance(condition, Foreseeing):
            return RuleState(rule, condition, foreseeing=condition)
        return RuleState(rule, condition)

    @property
    def warns_of_worse(self) -> bool:
        """Whether warnings are of the graver thing that counts at once; see `Foreseeing`."""
        return bool(getattr(self.foreseeing, "of_worse", False))

    def is_there(self, found: Finding) -> bool:
        """Tell whether what the rule would warn of is more likely than not there now."""
        return (found.graver if self.warns_of_worse else found.probability) >= LIKELY

    def keep(self, key: int, after: Episode, t_s: float) -> None:
        """Remember an episode, or forget it where nothing follows from it any more."""
        if after.is_forgotten(t_s):
            self.episodes.pop(key, None)
            self.seen.pop(key, None)
        else:
            self.episodes[key] = after

    def lead_s(self, key: int, change: Change, t_s: float, *, predicted: bool) -> float | None:
        """Return how long before it began a warning came; None where it has not begun."""
        opened = self.opened.get(key)
        if opened is None:
            return None
        if predicted or not self.warns_of_worse:
            return change.start_s - opened.told_s
        if opened.came_s is None and change.level > 0:
            opened = self.opened[key] = opened._replace(came_s=t_s)
        return None if opened.came_s is None else opened.came_s - opened.told_s
