"""Why an event of a rule fired: the probability of its condition over time, from the recording."""

import json
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from trecsim.errors import Error, InputError
from trecsim.page.site_draft import DraftDesk

BEFORE_S, AFTER_S = 10.0, 5.0
"""So much is shown before the beginning and after the end [s]."""
LONGEST_S = 60.0
"""So much of a long episode is shown, from its beginning [s]."""
WARM_UP_S = 6.0
"""So much before that is judged, too: rules on movement look back [s]."""
_LARGEST_SUMMARY = 10_000_000  # bytes


@dataclass(frozen=True, slots=True)
class Reasons:
    """Finds out why events fired.

    Attributes
    ----------
    recordings
        The folder with the recordings of the site, or of one; None where there are none.
    desk
        Has the site file and its earlier versions; None for a site without a file.
    """

    recordings: Path | None
    desk: DraftDesk | None

    def of(self, event: Mapping[str, Any]) -> dict[str, Any]:
        """Return the probability of the condition of an event, over time.

        Parameters
        ----------
        event
            The `data` of the newest event of an episode.

        Raises
        ------
        InputError
            No recording holds that time, or no version of the site file that rule.
        """
        from trecsim.store.playback import recordings

        start_s = float(event["t_start_s"])
        found = recordings(self.recordings) if self.recordings is not None else []
        holding = [one for one in found if one.from_s <= start_s + 1.0 and start_s <= one.to_s + 1]
        if not holding:
            raise InputError("no recording holds the time of this alert")
        folder = holding[0].folder
        rule, feeds = self._rule(event["rule"], folder)
        ended_s = event.get("t_end_s")
        end_s = start_s + LONGEST_S if ended_s is None else min(ended_s, start_s + LONGEST_S)
        return _curve(rule, feeds, event, folder, (start_s - BEFORE_S, end_s + AFTER_S))

    def _rule(self, told: Mapping[str, Any], recording: Path) -> tuple[Any, Sequence[Any]]:
        """Return the rule as it was, the one with the same digest, and the feeds of its site."""
        from trecsim.sites.rules import feeds_of, rules_of

        for site in self._sites(recording):
            with suppress(Error, ValueError):
                for rule in rules_of(site.rules, site.places, site.exclusions):
                    if rule.id == told.get("id") and rule.config == told.get("config"):
                        return rule, feeds_of(site.feeds)
        raise InputError(
            f"rule {told.get('id')} has changed since, and no kept version of the site file has it"
        )

    def _sites(self, recording: Path) -> Iterator[Any]:
        """Yield what the site file says, and what its earlier versions said."""
        from trecsim.sites.recorded_site import RecordedSite
        from trecsim.toml_models import examined, parsed

        configuration = _configuration(recording)
        if configuration is not None:
            site, _ = examined(RecordedSite, configuration, {"folder": recording})
            if site is not None:
                yield site
        if self.desk is None:
            return
        path = self.desk.site_file
        for text in _texts(self.desk):
            with suppress(Error):
                site, _ = examined(
                    RecordedSite, parsed(path, text, "site file"), {"folder": path.parent}
                )
                if site is not None:
                    yield site


def _texts(desk: DraftDesk) -> Iterator[str]:
    with suppress(Error):
        yield desk.trial_texts()["live"]
    if desk.history is not None:
        for one in desk.history.versions():
            text = desk.history.text(one["version"])
            if text is not None:
                yield text


def _configuration(recording: Path) -> dict[str, Any] | None:
    """Return the site file as it was when a recording was made; None where it is not known."""
    from trecsim.sites.ruled import RULED

    path = recording / "summary.json"
    with suppress(OSError, ValueError, KeyError, TypeError, RecursionError):
        if path.stat().st_size <= _LARGEST_SUMMARY:
            kept = dict(json.loads(path.read_bytes())["configuration"])
            return {key: kept[key] for key in RULED if key in kept}
    return None


def _curve(
    rule: Any,
    feeds: Sequence[Any],
    event: Mapping[str, Any],
    folder: Path,
    span_s: tuple[float, float],
) -> dict[str, Any]:
    from trecsim.safety.conditions.base import HERE
    from trecsim.safety.rule_scene import Memory
    from trecsim.safety.signals import Signals, recorded
    from trecsim.sites.feed_files import kept_signals
    from trecsim.store.playback import snapshots

    people: Sequence[Mapping[str, Any]] = event.get("people") or ()
    key = HERE if rule.kind.is_about_place or not people else int(people[0]["person"])
    signals, source = Signals(feeds), recorded(kept_signals(folder))
    condition, scenes, memory = rule.kind.condition(rule), Memory(signals), None
    times: list[float] = []
    probability: list[float | None] = []
    measures: dict[str, list[float | None]] = {}
    for snapshot in snapshots(folder, span_s[0] - WARM_UP_S, span_s[1]):
        signals.take(source(snapshot.t_s))
        scene = scenes.take(snapshot)
        found, memory, _ = condition.judge(scene, memory)
        if snapshot.t_s < span_s[0]:
            continue
        seen = key == HERE or key in scene.people.id[scene.is_seen].tolist()
        finding = found.get(key)
        times.append(round(snapshot.t_s, 3))
        probability.append(round(finding.probability, 4) if finding else 0.0 if seen else None)
        for name, value in (finding.measures if finding else {}).items():
            row = measures.setdefault(name, [])
            row += [None] * (len(times) - 1 - len(row))
            row.append(round(float(value), 3))
    for row in measures.values():
        row += [None] * (len(times) - len(row))
    timing = rule.timing
    return {
        "rule": rule.id,
        "kind": rule.kind.name,
        "about": rule.kind.about,
        "person": None if key == HERE else key,
        "p_on": timing.p_on,
        "p_off": timing.p_off,
        "on_delay_s": timing.on_delay_s,
        "off_delay_s": timing.off_delay_s,
        "hold_s": timing.hold_s,
        "keys": {name: value for name, value in rule.keys.items() if value is not None},
        "t_s": times,
        "probability": probability,
        "measures": measures,
    }
