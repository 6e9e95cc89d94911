"""Measure the operator page: first paint from a real page process, its size, draw calls.

Run: ``python benchmarks/page_start.py`` (needs Chromium and the built page). Each start is a
browser session of its own with an empty cache. Beside the time until something is painted stands
the CPU time that the page's main thread has used until then: that is the page's own part, whatever
else the machine does.
"""

import gzip
import json
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from statistics import median
from threading import Event, Thread
from time import time

import numpy as np
from playwright.sync_api import Browser

from harness.command import alone
from harness.figures import Figures, Skipped, once
from harness.options import Options
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
PATIENCE_MS = 120_000
CATEGORIES = ["blink.user_timing", "loading", "toplevel", "disabled-by-default-devtools.timeline"]
# Notes when the sentence at the top says something of the site, and how far anything moved.
WATCH = """
  window.moved = 0;
  new PerformanceObserver((list) => {
    for (const entry of list.getEntries()) if (!entry.hadRecentInput) window.moved += entry.value;
  }).observe({ type: "layout-shift", buffered: true });
  new MutationObserver(() => {
    if (window.toldAt || !document.querySelector(".status[data-row]:not([data-row='0'])")) return;
    requestAnimationFrame(() => { window.toldAt ??= performance.now(); });
  }).observe(document, { childList: true, subtree: true, attributes: true });
"""


@dataclass(frozen=True)
class Start:
    """One start of the page.

    Attributes
    ----------
    paint_ms, told_ms
        Time until something is painted, and until the sentence at the top tells of the site [ms].
    cpu_ms
        CPU time of the page's main thread until something is painted [ms].
    moved
        Cumulative layout shift.
    """

    paint_ms: float
    told_ms: float
    cpu_ms: float
    moved: float


def size_kb() -> float:
    """Return the size of the page, compressed [kB]."""
    files = (path for path in STATIC.rglob("*") if path.is_file())
    return sum(len(gzip.compress(path.read_bytes())) for path in files) / 1000


def tell(process: PageProcess, cameras: list[str], ended: Event) -> None:
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


@contextmanager
def told() -> Iterator[str]:
    """Run a page process that is told of 50 people; yield its address."""
    rig = simulate(read_scene("crowded-room"), 0).rig
    site = SiteView("room", cameras=cameras_of(rig), floor_m=floor_of(rig))
    ended = Event()
    with PageProcess(PageAddress(port=0), site) as process:
        telling = Thread(target=tell, args=(process, list(site.cameras), ended))
        telling.start()
        try:
            yield process.url
        finally:
            ended.set()
            telling.join()


def started(browser: Browser, url: str) -> Start:
    """Open the page once in a new session."""
    context = browser.new_context(viewport={"width": 1440, "height": 900})
    context.add_init_script(WATCH)
    page = context.new_page()
    page.set_default_timeout(PATIENCE_MS)
    browser.start_tracing(page=page, categories=CATEGORIES)
    page.goto(url, wait_until="commit")
    while not page.evaluate("window.toldAt ?? 0"):  # the page's policy forbids to wait in it
        page.wait_for_timeout(50)
    paint = page.evaluate(
        "performance.getEntriesByName('first-contentful-paint')[0]?.startTime ?? NaN"
    )
    told_ms, moved = page.evaluate("[window.toldAt, window.moved]")
    trace = json.loads(browser.stop_tracing())["traceEvents"]
    context.close()
    return Start(paint, told_ms, cpu_until_paint_ms(trace), moved)


def cpu_until_paint_ms(trace: list[dict]) -> float:
    """Return the CPU time of the tasks of the main thread between navigation and first paint."""
    painted = next((one for one in trace if one["name"] == "firstContentfulPaint"), None)
    if painted is None:
        return float("nan")
    main = (painted["pid"], painted["tid"])
    ours = [one for one in trace if (one["pid"], one["tid"]) == main and one["ts"] < painted["ts"]]
    begun_us = max(one["ts"] for one in ours if one["name"] == "navigationStart")
    tasks = [one for one in ours if one["name"] == "ThreadControllerImpl::RunTask"]
    return sum(one.get("tdur", 0) for one in tasks if one["ts"] >= begun_us) / 1000


def measure(options: Options) -> Figures:
    """Measure the first paint of the operator page, its size and its draw calls."""
    options.input.update(people=PEOPLE, starts=STARTS, data="made people that move in a ring")
    if not (STATIC / "index.html").is_file():
        raise Skipped("the page is not built; make page does so")
    with told() as url, chromium() as browser:
        starts = [started(browser, f"{url}live?view=plan") for _ in range(STARTS)]
        page = browser.new_page(viewport={"width": 1440, "height": 900})
        page.set_default_timeout(PATIENCE_MS)
        page.goto(url)
        page.wait_for_selector(f".view[data-drawn='{PEOPLE}']")
        calls = page.get_attribute(".view", "data-calls")
    assert calls is not None
    paint_ms, told_ms, cpu_ms, moved = (
        median(getattr(one, name) for one in starts)
        for name in ("paint_ms", "told_ms", "cpu_ms", "moved")
    )
    return {
        "first paint": once(paint_ms, "ms", watched=False),
        "processor time of the page until then": once(cpu_ms, "ms", watched=False),
        "the status sentence tells of the site": once(told_ms, "ms", watched=False),
        "layout shift": once(moved, "", matters=0.05),
        "size": once(size_kb(), "kB", matters=5.0),
        f"draw calls with {PEOPLE} people": once(float(calls), "", matters=0.5),
    }


if __name__ == "__main__":
    raise SystemExit(alone(__file__, measure))
