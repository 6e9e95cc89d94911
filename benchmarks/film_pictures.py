"""Draw the picture of a film for README and the docs: a simulated fall, its alarm and forecasts.

Run: ``python benchmarks/film_pictures.py``
"""

import sys
import tempfile
from pathlib import Path

from harness.machine import ROOT

SCENE, SEED, SECONDS = "falling", 1, 20.0
PICTURE = ROOT / "docs" / "pictures" / "render.png"
AFTER_S = 0.6  # the first alarm
SITE = """
format = "trecsim.site/1"
name = "hall"
rig = "rig.toml"

[[rules]]
id = "fall"
kind = "body.fall"
severity = "alarm"
"""


def draw(out: Path) -> Path:
    """Simulate, track, judge, forecast, and draw the moment after the first alarm."""
    from trecsim.films.alerts import read_alerts
    from trecsim.store.tracks import read_tracks

    with tempfile.TemporaryDirectory() as name:
        scene = Path(name) / "scene"
        tracks, site, events = scene / "tracks.parquet", scene / "hall.toml", scene / "events.jsonl"
        run("simulate", SCENE, "--out", scene, "--seconds", SECONDS, "--seed", SEED)
        run("track", scene / "rig.toml", scene / "poses.jsonl", "--out", tracks, "--lag-s", 0.2)
        site.write_text(SITE, encoding="utf-8")
        run("assess", tracks, site, "--out", events)
        run("forecast", tracks, "--out", scene / "forecast.jsonl")
        at_s = read_alerts(events)[0].from_s + AFTER_S - next(read_tracks(tracks)).t_s
        run("render", tracks, out, "--site", site, "--at-s", at_s, "--height", 560)
    return out


def run(*arguments: object) -> None:
    """Run one command of trecsim."""
    from trecsim.cli import main

    try:
        main([*map(str, arguments), "--json"])
    except SystemExit as ended:
        if ended.code:
            raise


if __name__ == "__main__":
    print(draw(PICTURE).relative_to(ROOT), file=sys.stderr)
