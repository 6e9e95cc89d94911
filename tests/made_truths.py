"""What rules tell of made people, beside what a naive reading of the same rules says."""

from collections.abc import Sequence

import numpy as np
import pytest

from made_paths import PLACES, bodies_on, events_of, moments
from trecsim.lab.evaluation.event_episodes import EpisodeTold, episodes_of
from trecsim.lab.true_events.truth_events import truth_events


def rule(kind: str, keys: str = 'zone = "room"') -> str:
    return f'[[rules]]\nid = "r"\nkind = "{kind}"\n{keys}\n'


def bodies_at(xy_m: np.ndarray, t_s: np.ndarray) -> np.ndarray:
    """Return somebody who stands at a place at each time, (time, 2) [m]."""
    return bodies_on(lambda _: xy_m, t_s)


def both(
    rules: str, people: Sequence[np.ndarray], t_s: np.ndarray, places: str = PLACES
) -> tuple[list[EpisodeTold], list[EpisodeTold]]:
    """Return the episodes that the rules tell, and the true ones."""
    told = episodes_of(events_of(rules, moments(people, t_s), places=places))
    return told, episodes_of(truth_events(places + rules, t_s, np.array(people)))


def agreed(
    rules: str, people: Sequence[np.ndarray], t_s: np.ndarray, places: str = PLACES
) -> list[EpisodeTold]:
    """Return the true episodes, after the rules have told the same, within one frame."""
    told, true = both(rules, people, t_s, places)
    frame_s = float(t_s[1] - t_s[0]) + 1e-6
    assert [one.start_s for one in told] == pytest.approx(
        [one.start_s for one in true], abs=frame_s
    )
    assert [one.end_s is None for one in told] == [one.end_s is None for one in true]
    assert [one.end_s for one in told if one.end_s is not None] == pytest.approx(
        [one.end_s for one in true if one.end_s is not None], abs=frame_s
    )
    for one, other in zip(told, true, strict=True):
        assert one.floor_m == pytest.approx(other.floor_m, abs=0.1)  # of the same person
    return true
