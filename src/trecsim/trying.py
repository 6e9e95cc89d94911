"""Try the rules of a draft on a recording, beside those that are live: what would have fired.

The page runs this module as a process of its own, ``python -m trecsim.trying``: a long recording
must not hold up those who look at the page. It reads one JSON object and writes one.
"""

import json
import sys
from collections import Counter
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from trecsim.assessing import RuleEvents, RuleSet, rule_set
from trecsim.errors import Error
from trecsim.safety.signals import recorded
from trecsim.sites.feed_files import kept_signals
from trecsim.sites.recorded_site import RecordedSite
from trecsim.store.playback import snapshots
from trecsim.toml_models import examined, file_faults, parsed

MOST_EPISODES = 1000
"""So many episodes are listed; all are counted."""


def try_rules(request: Mapping[str, Any]) -> dict[str, Any]:
    """Judge two versions of a site file on a part of a recording.

    Parameters
    ----------
    request
        `site_file`: from which the paths in the texts count; `texts`: `live` and `draft`;
        `recording`: its folder; `from_s`, `to_s`: the part of it [s].

    Returns
    -------
    `moments`, `people`, `from_s`, `to_s`; `rules`: for each rule how many episodes there are with
    the rules as drafted (`draft`) and as they are (`live`); `episodes`, in order of time, each with
    `in`: "both", "draft" or "live".

    Raises
    ------
    InputError
        A text is no site file, or the recording is damaged.
    """
    path = Path(request["site_file"])
    rules = {name: _rules(path, text) for name, text in request["texts"].items()}
    kept = kept_signals(Path(request["recording"]))
    engines = {name: RuleEvents(one, signals=recorded(kept)) for name, one in rules.items()}
    found: dict[str, dict[str, dict[str, Any]]] = {name: {} for name in engines}
    people: set[int] = set()
    moments, first_s, last_s = 0, None, None
    for snapshot in snapshots(Path(request["recording"]), request["from_s"], request["to_s"]):
        moments, last_s = moments + 1, snapshot.t_s
        first_s = snapshot.t_s if first_s is None else first_s
        people.update(snapshot.id[snapshot.is_confirmed].tolist())
        for name, engine in engines.items():
            _take(found[name], engine.step(snapshot))
    listed = _compared(found["draft"], found["live"])
    return {
        "moments": moments,
        "people": len(people),
        "from_s": first_s,
        "to_s": last_s,
        "rules": _counted(rules, found),
        "episodes": listed[:MOST_EPISODES],
        "left_out": max(len(listed) - MOST_EPISODES, 0),
    }


def _rules(path: Path, text: str) -> RuleSet:
    data = parsed(path, text, "site file")
    site, faults = examined(RecordedSite, data, {"folder": path.parent})
    if site is None:
        raise file_faults(path, text, faults)
    rig = None if site.rig is None else site.rig.read(_said_elsewhere)
    return rule_set(site.name, site, rig)


def _take(episodes: dict[str, dict[str, Any]], events: Iterable[Mapping[str, Any]]) -> None:
    """Take what new events tell of their episodes."""
    for event in events:
        data = event["data"]
        told = episodes.setdefault(data["event"], {"event": data["event"], "kind": "", "rule": ""})
        place = next((data[key] for key in ("zone", "line", "edge", "volume") if key in data), None)
        told.update(
            rule=data["rule"]["id"],
            kind=data["rule"]["kind"],
            severity=data["severity"],
            t_start_s=data["t_start_s"],
            t_end_s=data["t_end_s"],
            probability=max(data["probability"], told.get("probability", 0.0)),
            people=[one["person"] for one in data["people"]],
            place=place,
            predicted=data["predicted"],
        )


def _counted(
    rules: Mapping[str, RuleSet], found: Mapping[str, Mapping[str, Mapping[str, Any]]]
) -> dict[str, dict[str, int]]:
    """Return how many episodes each rule has; those of the draft come first."""
    counts = {name: Counter(one["rule"] for one in found[name].values()) for name in found}
    ids = dict.fromkeys(rule.id for name in ("draft", "live") for rule in rules[name].rules)
    return {rule: {name: counts[name][rule] for name in counts} for rule in ids}


def _compared(
    draft: Mapping[str, Mapping[str, Any]], live: Mapping[str, Mapping[str, Any]]
) -> list[dict[str, Any]]:
    """Return all episodes, each once: one of both holds of the same rule and people at once."""
    matched: dict[str, str | None] = {}
    waiting: dict[str, list[str]] = {}
    for event, one in live.items():
        waiting.setdefault(one["rule"], []).append(event)
    for event, one in draft.items():
        same = (other for other in waiting.get(one["rule"], ()) if _same(one, live[other]))
        matched[event] = next(same, None)
        if matched[event] is not None:
            waiting[one["rule"]].remove(str(matched[event]))
    both = [{**one, "in": "both" if matched[event] else "draft"} for event, one in draft.items()]
    gone = [{**live[event], "in": "live"} for events in waiting.values() for event in events]
    return sorted([*both, *gone], key=lambda one: (one["t_start_s"], one["event"]))


def _same(one: Mapping[str, Any], two: Mapping[str, Any]) -> bool:
    """Tell whether two episodes tell of one happening."""
    if one["rule"] != two["rule"] or not set(one["people"]) & set(two["people"]):
        return False
    return _begins(one) <= _ends(two) and _begins(two) <= _ends(one)


def _begins(one: Mapping[str, Any]) -> float:
    return float(one["t_start_s"])


def _ends(one: Mapping[str, Any]) -> float:
    return float("inf") if one["t_end_s"] is None else float(one["t_end_s"])


def _said_elsewhere(remark: str) -> None:
    """Drop a remark on the rig; whoever runs the site says it."""


def main() -> int:
    """Answer the request on standard input."""
    try:
        answer = try_rules(json.load(sys.stdin))
    except Error as error:
        answer = {"error": str(error)}
    json.dump(answer, sys.stdout)
    return 0


if __name__ == "__main__":
    sys.exit(main())
