"""Rules on volumes that move, read naively: who is near one, in one, or in the way of the next."""

import json
import math

import numpy as np

from trecsim.lab.true_events.naive_chairs import coming, is_at_a_box, is_on_a_chair_past
from trecsim.lab.true_events.naive_places import is_inside
from trecsim.lab.true_events.true_people import TruePerson
from trecsim.lab.true_events.true_places import Place
from trecsim.lab.true_events.true_spans import Span, spans


def vehicle(at: Place, person: TruePerson) -> list[Span]:
    """Return when a joint is near the moving box."""
    margin_m = at.rule.get("distance_m", 0.3)
    near, hit = (
        np.array([
            bool(is_there) and is_at_a_box(at.place, at.messages, now, xyz_m, margin_m=m)
            for now, xyz_m, is_there in zip(
                person.t_s.tolist(), person.xyz_m, person.there, strict=True
            )
        ])
        for m in (margin_m, 0.0)
    )  # fmt: skip
    return spans(person.t_s, near, person.there, at.delays, at_once=hit)


def on_volume(at: Place, person: TruePerson) -> list[Span]:
    """Return when a joint is inside the moving box."""
    after_s = at.rule.get("after_s", 0.0)
    holds = [
        bool(is_there) and is_at_a_box(at.place, at.messages, now, xyz_m, after_s=after_s)
        for now, xyz_m, is_there in zip(
            person.t_s.tolist(), person.xyz_m, person.there, strict=True
        )
    ]
    return spans(person.t_s, np.array(holds), person.there, at.delays)


def unload(at: Place, person: TruePerson) -> list[Span]:
    """Return when somebody is still on a chair, or in the way of the next one."""
    line_m = np.array(at.site["lines"][at.rule["line"]]["points_m"], float)
    strip_m = np.array(at.site["zones"][at.rule["strip"]]["polygon_m"], float)
    in_strip = person.there & is_inside(strip_m, person.floor_m)
    holds, entered_s = np.zeros(len(person.t_s), bool), math.nan
    comes = coming(
        json.dumps(dict(at.place)),
        json.dumps(list(map(dict, at.messages))),
        tuple(map(tuple, line_m.tolist())),
        at.rule.get("next_s", 3.0),
        tuple(person.t_s.tolist()),
    )
    for n, now in enumerate(person.t_s.tolist()):
        if not in_strip[n]:
            entered_s = math.nan
        elif math.isnan(entered_s):
            entered_s = now
        waits = in_strip[n] and any(since_s >= entered_s for since_s in comes[n].values())
        rides = person.there[n] and is_on_a_chair_past(
            at.place, at.messages, line_m, now, person.xyz_m[n]
        )
        holds[n] = waits or rides
    grave = holds & in_strip & person.lies
    return spans(person.t_s, holds, person.there, at.delays, at_once=grave)
