"""Rules as values: what kinds there are of, and one rule of a site."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, Literal, NamedTuple

from trecsim.safety.conditions.base import Condition
from trecsim.safety.directed_lines import Edge, Line
from trecsim.safety.machine import Timing
from trecsim.safety.polygons import Prism
from trecsim.safety.schedules import Schedule
from trecsim.safety.volumes import FedVolume, Volume

Severity = Literal["info", "warning", "alarm", "critical"]
SEVERITIES: tuple[Severity, ...] = ("info", "warning", "alarm", "critical")
PlaceKind = Literal["zone", "line", "edge", "volume"]


class Place(NamedTuple):
    """A place of the site file that a rule is about.

    Attributes
    ----------
    kind, name
        Zone, line, edge or volume, and what it is called.
    shape
        Where it is.
    """

    kind: PlaceKind
    name: str
    shape: Prism | Line | Edge | Volume | FedVolume


@dataclass(frozen=True, slots=True)
class Key:
    """A key that a kind of rule has beside those that all have.

    Attributes
    ----------
    name
        In the site file, with its unit.
    type
        What its value is.
    about
        What it means, in one sentence.
    default
        Its value where it is not given; ... where it has to be.
    limits
        Constraints, as pydantic calls them: {"gt": 0}.
    names
        Of what kind of place, or of a feed, its value is the name; None where it is no name.
    """

    name: str
    type: Any
    about: str
    default: Any = ...
    limits: Mapping[str, Any] = field(default_factory=dict)
    names: PlaceKind | Literal["feed"] | None = None


@dataclass(frozen=True, slots=True)
class Kind:
    """A kind of rule.

    Attributes
    ----------
    name
        As in the site file, and in the type of its events.
    about
        When it fires, in one sentence.
    source
        Where its numbers come from.
    condition
        Makes the condition of a rule of this kind.
    place
        What it is about; None for people anywhere.
    place_is_optional
        Whether a rule of this kind may leave the place out, to hold everywhere.
    keys
        Its own keys.
    on_delay_s, off_delay_s
        Defaults [s].
    early_s
        Default of how soon an event must be expected for a warning of it [s].
    gap_s
        Gaps that are bridged before it counts [s].
    escalate_s
        After so long the severity rises; None where it does not [s].
    hold_key
        The key that says how long the condition must hold; `escalate_s` then counts in its value.
    at_once
        Whether an episode is over as soon as it begins.
    is_about_place
        Whether there is one episode for the place in place of one for each person.
    can_warn
        Whether its condition looks ahead, so that it can warn early.
    spares_exclusions
        Whether exclusion volumes apply to it.
    """

    name: str
    about: str
    source: str
    condition: Callable[["Rule"], Condition]
    place: PlaceKind | None = None
    place_is_optional: bool = False
    keys: tuple[Key, ...] = ()
    on_delay_s: float = 0.0
    off_delay_s: float = 0.5
    early_s: float = 0.0
    gap_s: float = 0.0
    escalate_s: float | None = None
    hold_key: str | None = None
    at_once: bool = False
    is_about_place: bool = False
    can_warn: bool = False
    spares_exclusions: bool = False


@dataclass(frozen=True, slots=True, eq=False)
class Rule:
    """One rule of a site.

    Attributes
    ----------
    id, kind, severity
        As in the site file.
    place
        What it is about; None where it holds everywhere.
    schedule
        When it is armed.
    timing
        What makes an episode of its condition.
    early_s
        So soon an event must be expected for a warning of it [s].
    keys
        Values of the keys of its kind.
    config
        SHA-256 of the rule and its places.
    others
        Places that its own keys name, by key.
    exclusions
        Exclusion volumes in which it does not fire, such as beds.
    """

    id: str
    kind: Kind
    severity: Severity
    place: Place | None
    schedule: Schedule
    timing: Timing
    early_s: float
    keys: Mapping[str, Any]
    config: str
    others: Mapping[str, Place] = field(default_factory=dict)
    exclusions: tuple[Prism, ...] = ()
