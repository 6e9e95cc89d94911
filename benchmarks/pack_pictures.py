"""Picture the live page of each scenario pack while its demo runs, with a real Chromium.

Run: ``python benchmarks/pack_pictures.py [NAME ...]``; it takes half a minute a pack.
"""

import argparse
import subprocess
import sys
import time
from pathlib import Path
from tempfile import TemporaryDirectory

from PIL import Image
from playwright.sync_api import Browser

from harness.machine import ROOT
from page_shots.browser import PATIENCE_MS, SIZES, chromium
from trecsim.lab.packs.pack_files import PACKS

FOLDER = ROOT / "docs" / "pictures" / "packs"
TOLD_S = {"lift": 17.0, "platform": 10.5, "machine-cell": 11.5, "gate": 21.3, "care-room": 17.5}
"""When there is most to see [s]."""
SETTLE_S = 9.0  # before that the page is opened, to load
AFTER_S = 8.0  # the demo goes on for a browser that is slow


def picture(browser: Browser, name: str, folder: Path) -> Path:
    """Run the demo of a pack and take a picture of its page."""
    path = folder / f"{name}.png"
    with TemporaryDirectory() as out:
        command = [
            Path(sys.executable).with_name("trecsim"), "demo", name, "--out", f"{out}/demo",
            "--seconds", str(TOLD_S[name] + AFTER_S),
        ]  # fmt: skip
        demo = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
        assert demo.stdout is not None
        url = demo.stdout.readline().removeprefix("page: ").strip()
        if not url.startswith("http"):
            raise SystemExit(f"trecsim demo {name} gave no page: {url or 'nothing'}")
        began_s = _begins(Path(out) / "demo" / "run")
        time.sleep(max(began_s + TOLD_S[name] - SETTLE_S - time.monotonic(), 0.0))
        width, height, scale = SIZES["wide"]
        context = browser.new_context(
            viewport={"width": width, "height": height}, device_scale_factor=scale,
            color_scheme="light", reduced_motion="reduce", locale="en-GB",
        )  # fmt: skip
        page = context.new_page()
        page.set_default_timeout(PATIENCE_MS)
        page.goto(url)
        page.wait_for_selector(".status h1")
        time.sleep(max(began_s + TOLD_S[name] - time.monotonic(), 0.5))
        page.screenshot(path=path)
        context.close()
        demo.communicate()
    with Image.open(path) as taken:
        taken.convert("RGB").save(path, optimize=True)
    return path


def _begins(run: Path) -> float:
    """Wait until the demo writes its first tracks; return when that was."""
    while not run.is_dir():
        time.sleep(0.1)
    return time.monotonic()


def main() -> int:
    """Take the pictures that are asked for, else all of them."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("names", nargs="*", metavar="NAME", help="packs (default: all)")
    parser.add_argument("--out", type=Path, default=FOLDER, help="folder for the pictures")
    asked = parser.parse_args()
    if unknown := sorted(set(asked.names) - set(PACKS)):
        parser.error(f"no pack is called {', '.join(unknown)}; there are {', '.join(PACKS)}")
    asked.out.mkdir(parents=True, exist_ok=True)
    with chromium() as browser:
        for name in asked.names or PACKS:
            print(picture(browser, name, asked.out), flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
