"""Rules on bodies, read naively: joints in volumes and near edges, and who lies."""

import math
from collections.abc import Iterator, Sequence

import numpy as np

from trecsim.lab.true_events.naive_falls import fallen_since_s
from trecsim.lab.true_events.naive_places import from_edge_m, inside_m, is_inside
from trecsim.lab.true_events.true_people import ANKLES, ELBOWS, FOOT_M, WRISTS, TruePerson
from trecsim.lab.true_events.true_places import Happening, Place
from trecsim.lab.true_events.true_spans import Span, spans

STEP_M, NEAR_M = 0.35, 0.5


def restricted(at: Place, person: TruePerson) -> list[Span]:
    """Return when a joint is inside the prism."""
    low_m, high_m = at.place.get("z_m", (0.0, 2.5))
    z_m = person.xyz_m[..., 2]
    inside = is_inside(at.polygon_m, person.xyz_m[..., :2]) & (z_m >= low_m) & (z_m <= high_m)
    holds = person.there & inside.any(axis=1)
    return spans(person.t_s, holds, person.there, at.delays)


def reach(at: Place, person: TruePerson) -> list[Span]:
    """Return when an arm is inside the prism and the feet are not."""
    low_m, high_m = at.place.get("z_m", (0.0, 2.5))
    arms_m = person.xyz_m[:, [*WRISTS, *ELBOWS]]
    inside = is_inside(at.polygon_m, arms_m[..., :2])
    inside &= (arms_m[..., 2] >= low_m) & (arms_m[..., 2] <= high_m)
    holds = person.there & inside.any(axis=1) & ~at.holds(person)
    return spans(person.t_s, holds, person.there, at.delays)


def climb(at: Place, person: TruePerson) -> list[Span]:
    """Return when a foot is raised at the barrier, or the hips are over it and above its top."""
    feet_m = person.xyz_m[:, ANKLES] - [0.0, 0.0, FOOT_M]
    with np.errstate(invalid="ignore"):
        is_raised = (feet_m[..., 2] > STEP_M) & (inside_m(at.polygon_m, feet_m[..., :2]) > -NEAR_M)
        is_above = person.hips_m[:, 2] > at.place.get("z_m", (0.0, 2.5))[1]
    over = is_above & is_inside(at.polygon_m, person.hips_m[:, :2])
    holds = person.there & (is_raised.any(axis=1) | over)
    return spans(person.t_s, holds, person.there, at.delays)


def edge(at: Place, people: Sequence[TruePerson]) -> Iterator[Happening]:
    """Yield who is near the edge or beyond it."""
    for person in people:
        away_m = from_edge_m(at.points_m, person.xyz_m[..., :2])
        away_m = np.where(away_m >= -at.rule.get("depth_m", 1000.0), away_m, np.nan)
        with np.errstate(invalid="ignore"):
            near = (away_m < at.rule.get("distance_m", 0.5)).any(axis=1)
            beyond = (away_m < 0.0).any(axis=1)
        for span in spans(person.t_s, near, person.there, at.delays, at_once=near & beyond):
            end_s = math.inf if span.end_s is None else span.end_s
            over = beyond & (person.t_s >= span.start_s) & (person.t_s <= end_s)
            worse_s = float(person.t_s[over][0]) if over.any() else None
            yield Happening((person.number,), span, worse_s=worse_s)


def fall(at: Place, person: TruePerson) -> list[Span]:
    """Return when somebody lies who has fallen."""
    since_s = fallen_since_s(person)
    counts = at.holds(person) & ~at.is_spared(person)
    holds = np.isfinite(since_s) & person.lies & counts
    came_s = np.full(len(counts), -math.inf)  # of who has come here while lying: since when
    for n in range(1, len(counts)):
        came = bool(counts[n] and person.there[n - 1] and not counts[n - 1])
        came_s[n] = person.t_s[n] if came else came_s[n - 1]
    return spans(person.t_s, holds, person.there, at.delays, since_s=np.maximum(since_s, came_s))


def down(at: Place, person: TruePerson) -> list[Span]:
    """Return when somebody is on the floor who was not seen to fall."""
    holds = person.hips_down & ~np.isfinite(fallen_since_s(person)) & at.holds(person)
    holds &= ~at.is_spared(person)
    return spans(person.t_s, holds, person.there, at.delays)
