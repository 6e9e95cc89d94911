"""Picture every state of the operator page with a real Chromium.

Run: ``python benchmarks/page_pictures.py`` (``make page-pictures`` does). The people are those of
the simulated scene `platform-edge`, tracked; alerts on people and forecasts are made up here.
"""

import argparse
import sys
from pathlib import Path

from PIL import Image
from playwright.sync_api import Browser, Page

from harness.machine import ROOT
from page_shots.browser import chromium, opened
from page_shots.fixture import LAG_S, fixture
from page_shots.states import STATES, State

PAGE = ROOT / "docs" / "operator-page.md"
FOLDER = ROOT / "docs" / "pictures" / "page"
SETTLE_MS = 700


def picture(browser: Browser, state: State, size: str, theme: str, folder: Path) -> Path:
    """Take one picture; fail on whatever the page reports as an error."""
    path = folder / f"{state.name}-{size}-{theme}.png"
    with opened(browser, state.situation, state.address, size=size, dark=theme == "dark") as (
        page,
        errors,
    ):
        settle(page, state)
        page.screenshot(path=path)
        _compress(path)
        faults = [text for text in errors if not _is_expected(text, state)]
        if faults:
            raise SystemExit(f"{path.name}: the page reports: {faults[0]}")
    return path


def settle(page: Page, state: State) -> None:
    """Wait until the page shows what it was told."""
    page.wait_for_selector(".status h1, .login")
    situation = state.situation
    is_told = situation.signed_in and situation.messages != "none" and not situation.broken
    if is_told and not state.address.startswith("/review"):
        last_s = situation.now_s - LAG_S - 0.05
        while float(page.evaluate("document.documentElement.dataset.t") or 0) < last_s:
            page.wait_for_timeout(100)
    page.wait_for_timeout(SETTLE_MS)
    if state.act is not None:
        state.act(page)
        page.wait_for_timeout(SETTLE_MS)


def _compress(path: Path) -> None:
    with Image.open(path) as taken:
        taken.convert("RGB").save(path, optimize=True)


def _is_expected(text: str, state: State) -> bool:
    situation = state.situation
    return (
        "GPU stall" in text
        or ("401" in text and not situation.signed_in)
        or ("Unexpected identifier" in text and situation.broken)
    )


def main() -> int:
    """Take the pictures that are asked for, else all of them."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("names", nargs="*", metavar="NAME", help="states (default: all)")
    parser.add_argument("--out", type=Path, default=FOLDER, help="folder for the pictures")
    parser.add_argument("--size", choices=("wide", "tablet", "phone"), help="only this size")
    parser.add_argument("--docs", action="store_true", help="only those that the docs show")
    parser.add_argument("--theme", choices=("light", "dark"), help="only this theme")
    asked = parser.parse_args()
    known = {state.name for state in STATES}
    if unknown := sorted(set(asked.names) - known):
        parser.error(f"no state is called {', '.join(unknown)}; there are {', '.join(known)}")
    asked.out.mkdir(parents=True, exist_ok=True)
    shown = PAGE.read_text()
    fixture()  # before the browser waits for it
    with chromium() as browser:
        for state in STATES:
            if asked.names and state.name not in asked.names:
                continue
            for size in state.sizes:
                for theme in state.themes:
                    if asked.docs and f"{state.name}-{size}-{theme}.png" not in shown:
                        continue
                    if asked.size in (None, size) and asked.theme in (None, theme):
                        print(picture(browser, state, size, theme, asked.out), flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
