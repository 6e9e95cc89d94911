"""What rules of your own are made of, and the checks that each kind of rule has to pass.

A kind of rule is a value, `Kind`, with a condition: a frozen object with one method, `judge`. A
package makes it known by an entry point of the group ``trecsim.rules``.

Examples
--------
A rule that holds while somebody crouches in a zone:

>>> from dataclasses import dataclass
>>> @dataclass(frozen=True)
... class Crouching:
...     polygon: Polygon
...
...     def judge(self, scene, memory=None):
...         inside, postures = scene.inside(self.polygon), scene.body.postures
...         return Judged({
...             int(scene.people.id[row]): Finding(float(inside[row]))
...             for row in scene.seen
...             if postures[row] == "low"
...         })
>>> kind = Kind(
...     "body.crouch", "Somebody crouches in the zone.", "ours",
...     lambda rule: Crouching(rule.place.shape.polygon), place="zone", on_delay_s=2.0,
... )
>>> check_kind(kind)
"""

from collections.abc import Mapping
from typing import Any

import numpy as np

from trecsim.errors import Error
from trecsim.safety.conditions.base import HERE, Condition, Judged
from trecsim.safety.directed_lines import Edge, Line
from trecsim.safety.machine import Finding, Timing
from trecsim.safety.polygons import Polygon, Prism
from trecsim.safety.rule import Key, Kind, Place, Rule
from trecsim.safety.rule_scene import Memory, Scene
from trecsim.safety.volumes import Volume
from trecsim.values import PROVISIONAL, Snapshot

__all__ = [
    "HERE",
    "Condition",
    "Edge",
    "Finding",
    "Judged",
    "Key",
    "Kind",
    "Line",
    "Place",
    "Polygon",
    "Prism",
    "Rule",
    "Scene",
    "Volume",
    "check_kind",
]

_SQUARE_M = np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]])
_SHAPES: Mapping[str, Prism | Line | Edge | Volume] = {
    "zone": Prism(Polygon(_SQUARE_M), (0.0, 2.5)),
    "line": Line(np.array([[0.0, 0.0], [4.0, 0.0]])),
    "edge": Edge(np.array([[0.0, 0.0], [4.0, 0.0]])),
    "volume": Volume(
        (1.0, 1.0, 2.0), 0.0, np.array([[0.0, 1.0], [4.0, 1.0]]), np.array([0.0, 4.0])
    ),
}


def check_kind(kind: Kind, **keys: Any) -> None:
    """Check that a kind of rule does what all rules have to do.

    It is judged on made people: nobody, somebody who walks through, somebody who is only
    provisional, somebody whom no camera supports, and joints that are unknown.

    Parameters
    ----------
    kind
        The kind.
    keys
        Values of its keys that have no default.

    Raises
    ------
    Error
        When it does not; the text says what was expected and what was found.
    """
    first, second = (_findings(kind, keys) for _ in range(2))
    if first != second:
        raise Error(f"{kind.name}: expected the same findings for the same people, found others")


def _findings(kind: Kind, keys: Mapping[str, Any]) -> list[dict[int, Finding]]:
    condition = kind.condition(_rule(kind, keys))
    people, memory, found = Memory(), None, []
    for snapshot in _made_people():
        scene = people.take(snapshot)
        judged = condition.judge(scene, memory)
        memory = judged.memory
        _check_findings(kind, scene, judged.findings)
        found.append(dict(judged.findings))
    return found


def _check_findings(kind: Kind, scene: Scene, findings: Mapping[int, Finding]) -> None:
    seen = set(scene.people.id[scene.is_seen].tolist())
    for key, finding in findings.items():
        if key != HERE and key not in seen:
            raise Error(
                f"{kind.name}: expected findings on people who are seen, found person {key}"
            )
        if (key == HERE) != kind.is_about_place:
            raise Error(f"{kind.name}: is_about_place = {kind.is_about_place} and HERE do not fit")
        if not 0.0 <= finding.probability <= 1.0:
            raise Error(
                f"{kind.name}: expected a probability from 0 to 1, found {finding.probability}"
            )


def _rule(kind: Kind, keys: Mapping[str, Any]) -> Rule:
    given = {key.name: keys.get(key.name, key.default) for key in kind.keys}
    missing = [name for name, value in given.items() if value is ...]
    if missing:
        raise Error(f"{kind.name}: give values of {', '.join(missing)} to check it")
    place = None if kind.place is None else Place(kind.place, "made", _SHAPES[kind.place])
    timing = Timing(kind.on_delay_s, kind.off_delay_s)
    others = {
        key.name: Place(key.names, "made", _SHAPES[key.names])
        for key in kind.keys
        if key.names is not None and key.names != "feed"
    }
    return Rule("made", kind, "warning", place, None, timing, kind.early_s, given, "", others)


def _made_people() -> list[Snapshot]:
    """Return moments in which everything happens that a rule has to bear."""
    height_m = np.array([1.6] * 5 + [1.4] * 2 + [1.1] * 2 + [0.9] * 4 + [0.5] * 2 + [0.1] * 2)
    moments = []
    for n in range(80):
        at_m = np.array([-1.0 + 0.08 * n, 1.0])
        xyz_m = np.zeros((3, 17, 3))
        xyz_m[..., :2] = at_m + np.arange(3)[:, None, None] * [0.0, 0.7]
        xyz_m[..., 2] = height_m if n < 60 else 0.15
        support = np.full((3, 17), 2)
        support[1] = 0 if n % 20 > 10 else 1
        xyz_m[0, 5:9] = np.nan if n % 30 == 3 else xyz_m[0, 5:9]
        state = np.array(["confirmed", "coasting" if n % 20 > 10 else "confirmed", PROVISIONAL])
        cov_m2 = np.broadcast_to(4e-4 * np.eye(3), (3, 17, 3, 3)).copy()
        whole = Snapshot(0.08 * n, np.arange(3), xyz_m, cov_m2, support, state=state)
        moments.append(whole.of(np.array([n % 40 != 39, n > 5, True])))
    return moments
