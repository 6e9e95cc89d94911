"""From 2D poses to the episodes that rules tell of them, and their comparison with the truth."""

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from trecsim.assessing import RuleSet
    from trecsim.lab.evaluation.event_episodes import EpisodeTold
    from trecsim.lab.evaluation.event_scores import EventScores
    from trecsim.lab.simulation import Simulation
    from trecsim.safety.signals import SignalSource
    from trecsim.values import Snapshot


def rules_of_site(text: str) -> "RuleSet":
    """Return the rules of a site file."""
    from tempfile import TemporaryDirectory

    from trecsim.assessing import rule_set
    from trecsim.sites.recorded_site import read_without_rig

    with TemporaryDirectory() as folder:
        file = Path(folder) / "site.toml"
        file.write_text(text, encoding="utf-8")
        site = read_without_rig(file)
    return rule_set(site.name, site, None)


def tracked(made: "Simulation", overrides: Mapping[str, Any]) -> "list[Snapshot]":
    """Return the people whom the tracker finds, at each frame set."""
    import trecsim
    from harness.options import settings_from

    return list(trecsim.follow(made.poses, made.rig, settings_from(overrides)))


def told_of(snapshots: "Iterable[Snapshot]", site: str) -> "list[EpisodeTold]":
    """Return the episodes that the rules of a site tell, early warnings among them."""
    from trecsim.assessing import RuleEvents
    from trecsim.lab.evaluation.event_episodes import episodes_of

    engine = RuleEvents(rules_of_site(site))
    return episodes_of(event for one in snapshots for event in engine.step(one))


def signals_in(messages: str, feed: str) -> "SignalSource":
    """Return the messages of a feed, given as lines of JSON, as rules take them."""
    from trecsim.safety.signals import recorded
    from trecsim.sites.feed_files import signal_of

    return recorded([signal_of(feed, line) for line in messages.splitlines()])


def truth_of(
    made: "Simulation", site: str, feeds: Mapping[str, str] | None = None
) -> "list[EpisodeTold]":
    """Return the true episodes, given the messages of feeds by the names of their files."""
    from trecsim.lab.evaluation.event_episodes import episodes_of
    from trecsim.lab.true_events.truth_events import truth_events

    return episodes_of(truth_events(site, made.truth_t_s, made.truth_xyz_m, feeds or {}))


def together(parts: "Sequence[EventScores]") -> "EventScores":
    """Return the scores of several scenes as those of one."""
    from trecsim.lab.evaluation.event_scores import together as of_all

    return of_all(parts)


def p95(values: Sequence[float]) -> float:
    """Return the size that 95 % do not exceed; NaN of none."""
    return float(np.quantile(np.abs(values), 0.95)) if len(values) else float("nan")
