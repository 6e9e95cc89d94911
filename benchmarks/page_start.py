"""Measure the operator page: first paint from a real page process, its size, draw calls.

Run: ``python benchmarks/page_start.py`` (needs Chromium and the built page)
"""

import gzip
import sys
from statistics import median
from threading import Event, Thread
from time import time

import numpy as np

from page_shots.browser import chromium
from trecsim.health import CameraHealth, FusionHealth, Health
from trecsim.lab.simulation.scene import simulate
from trecsim.lab.simulation.scene_file import read_scene
from trecsim.page.address import PageAddress
from trecsim.page.bundle import STATIC
from trecsim.page.page_process import PageProcess
from trecsim.page.site_view import SiteView, cameras_of, floor_of
from trecsim.values import Snapshot

PEOPLE, STARTS = 50, 5
PAINT = "performance.getEntriesByName('first-contentful-paint')[0]?.startTime ?? 0"


def size_kb() -> float:
    """Return the size of the page, compressed [kB]."""
    files = (path for path in STATIC.rglob("*") if path.is_file())
    return sum(len(gzip.compress(path.read_bytes())) for path in files) / 1000


def told(process: PageProcess, cameras: list[str], ended: Event) -> None:
    """Tell the page of 50 people, ten times a second."""
    body_m = np.column_stack((np.zeros(17), np.linspace(-0.2, 0.2, 17), np.linspace(1.7, 0.1, 17)))
    grid_m = np.array(
        [[row - 5.0, 2.0 * column - 4.0, 0.0] for row in range(10) for column in range(5)]
    )
    xyz_m = body_m + grid_m[:, None, :]
    cov_m2 = np.tile(np.eye(3) * 4e-4, (PEOPLE, 17, 1, 1))
    while not ended.wait(0.1):
        t_s = time()
        shift_m = np.array([np.sin(t_s), np.cos(t_s), 0.0])
        support = np.full((PEOPLE, 17), 2)
        process.write(Snapshot(t_s, np.arange(PEOPLE), xyz_m + shift_m, cov_m2, support))
        live = {name: CameraHealth("live", 10.0, 0.05) for name in cameras}
        process.health(Health(t_s, live, FusionHealth("running", 10.0, 2.0, 0.05, PEOPLE)))


def main() -> int:
    """Print the figures."""
    rig = simulate(read_scene("crowded-room"), 0).rig
    site = SiteView("room", cameras=cameras_of(rig), floor_m=floor_of(rig))
    ended = Event()
    with PageProcess(PageAddress(port=0), site) as process, chromium() as browser:
        telling = Thread(target=told, args=(process, list(site.cameras), ended))
        telling.start()
        try:
            page = browser.new_page(viewport={"width": 1440, "height": 900})
            page.set_default_timeout(120_000)
            page.goto(process.url)
            page.wait_for_selector(f".view[data-drawn='{PEOPLE}']")
            calls = page.get_attribute(".view", "data-calls")
            paints = []
            for _ in range(STARTS):
                page.goto(f"{process.url}live?view=plan")
                page.wait_for_selector(".status h1")
                while not (paint := float(page.evaluate(PAINT))):
                    page.wait_for_timeout(20)
                paints.append(paint)
        finally:
            ended.set()
            telling.join()
    print(f"size of the page, compressed        {size_kb():6.0f} kB   (at most 250)")
    print(f"draw calls with {PEOPLE} people          {calls:>6}      (at most 20)")
    print(f"first paint, median of {STARTS} starts      {median(paints):6.0f} ms   (at most 1000)")
    return 0


if __name__ == "__main__":
    sys.exit(main())
