"""What it costs to judge 25 rules on 50 people, with early warnings, 25 frame sets a second.

People walk about in a hall of 20 m x 20 m, with errors and covariances as tracked ones have. Times
are of the processor, in one thread; forecasts of 4.8 s, made 5 times a second, are part of them.

Run: ``python benchmarks/rules_cost.py [--quick] [--store]``; quick takes 5 s.
"""

import time
from pathlib import Path

import numpy as np

from harness.calibration import calibration_ms
from harness.command import alone
from harness.figures import Figures, once, timed
from harness.options import Options
from trecsim.assessing import RuleEvents, rule_set
from trecsim.sites.recorded_site import RecordedSite
from trecsim.toml_models import parsed
from trecsim.toml_models.toml_reading import examined
from trecsim.values import Snapshot

PEOPLE, FPS, SECONDS, ROUNDS = 50, 25.0, 20.0, 3
HALL_M, SIGMA_M = 20.0, 0.02
KINDS = {
    "zone.enter": 4, "zone.exit": 2, "zone.dwell": 2, "zone.restricted": 3, "line.cross": 3,
    "occupancy.limit": 2, "density.level": 1, "edge.platform": 2, "speed.running": 1,
    "flow.wrong_way": 1, "body.fall": 1, "body.down": 1, "body.reach": 1, "body.distress": 1,
}  # fmt: skip
NEEDS = {
    "line.cross": 'line = "l{n}"', "edge.platform": 'edge = "e{n}"',
    "occupancy.limit": 'zone = "z{n}"\nlimit = 9',
    "flow.wrong_way": 'zone = "z{n}"\nheading_deg = 0',
    "speed.running": "", "body.fall": "", "body.down": "", "body.distress": "",
}  # fmt: skip
_BODY_M = np.array(
    [[0, 0, 1.6]] * 5 + [[0, s, 1.4] for s in (0.2, -0.2)] + [[0, s, 1.15] for s in (0.25, -0.25)]
    + [[0, s, 0.9] for s in (0.28, -0.28)] + [[0, s, 0.92] for s in (0.12, -0.12)]
    + [[0, s, 0.5] for s in (0.12, -0.12)] + [[0, s, 0.09] for s in (0.12, -0.12)]
)  # fmt: skip


def measure(options: Options) -> Figures:
    """Measure the cost of rules per frame set."""
    seconds = 5.0 if options.quick else SECONDS
    options.input.update(people=PEOPLE, rules=sum(KINDS.values()), fps=FPS, seconds=seconds)
    people = snapshots(seconds)
    site = site_of()
    each: list[list[float]] = []
    calibration: list[float] = []
    for _ in range(ROUNDS):
        calibration.append(calibration_ms())
        each.append(judged_ms(site, people))
    means = [float(np.mean(one)) for one in each]
    least = np.min(each, axis=0)
    return {
        "per frame set, mean": timed(means, calibration, "ms"),
        "per frame set, mean of the least of all rounds": once(float(least.mean()), "ms"),
        "per frame set, 95 %": once(float(np.percentile(least, 95)), "ms", watched=False),
    }


def judged_ms(site: RecordedSite, people: list[Snapshot]) -> list[float]:
    """Return what each frame set costs, after those of the first two seconds [ms]."""
    events = RuleEvents(rule_set("hall", site, None))
    took_ms = []
    for snapshot in people:
        began_s = time.thread_time()
        events.step(snapshot)
        took_ms.append(1e3 * (time.thread_time() - began_s))
    return took_ms[round(2 * FPS) :]


def snapshots(seconds: float) -> list[Snapshot]:
    """Return people who walk about, turn at the walls, and are measured with errors."""
    rng = np.random.default_rng(1000)
    at_m = rng.uniform(0.0, HALL_M, (PEOPLE, 2))
    heading, speed_mps = rng.uniform(0.0, 2 * np.pi, PEOPLE), rng.normal(1.3, 0.25, PEOPLE)
    cov_m2 = np.broadcast_to(SIGMA_M**2 * np.eye(3), (PEOPLE, 17, 3, 3)).copy()
    cov_m2[..., 0, 2] = cov_m2[..., 2, 0] = 0.2 * SIGMA_M**2
    made = []
    for n in range(round(seconds * FPS)):
        heading = heading + rng.normal(0.0, 0.05, PEOPLE)
        at_m = at_m + (speed_mps / FPS)[:, None] * np.stack([np.cos(heading), np.sin(heading)], 1)
        heading = np.where(((at_m < 0) | (at_m > HALL_M)).any(axis=1), heading + np.pi / 2, heading)
        xyz_m = np.broadcast_to(_BODY_M, (PEOPLE, 17, 3)) + rng.normal(0, SIGMA_M, (PEOPLE, 17, 3))
        xyz_m[..., :2] += np.clip(at_m, 0.0, HALL_M)[:, None]
        made.append(Snapshot(n / FPS, np.arange(PEOPLE), xyz_m, cov_m2, np.full((PEOPLE, 17), 3)))
    return made


def site_of() -> RecordedSite:
    """Return a site with all rules, places all over the hall."""
    text = ['format = "trecsim.site/1"\nname = "hall"\n']
    n = 0
    for kind, count in KINDS.items():
        for _ in range(count):
            x, y = 3.5 * (n % 5) + 1.0, 3.5 * (n // 5) + 1.0
            text.append(
                f"[zones.z{n}]\npolygon_m = [[{x}, {y}], [{x + 3}, {y}], [{x + 3}, {y + 3}], "
                f"[{x + 1}, {y + 3.5}], [{x}, {y + 3}]]\n"
                f"[lines.l{n}]\npoints_m = [[{x}, {y}], [{x + 3}, {y}]]\n"
                f"[edges.e{n}]\npoints_m = [[{x}, {y}], [{x + 3}, {y}]]\n"
            )
            needs = NEEDS.get(kind, 'zone = "z{n}"').format(n=n)
            text.append(f'[[rules]]\nid = "r{n}"\nkind = "{kind}"\n{needs}\n')
            n += 1
    data = parsed(Path("site.toml"), "".join(text), "site file")
    site, faults = examined(RecordedSite, data)
    assert site is not None, faults
    return site


if __name__ == "__main__":
    raise SystemExit(alone(__file__, measure))
