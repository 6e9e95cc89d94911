"""Make the technical report, the slides and a film of a minute from the stored results.

The text is that of ``docs/report``; equations and pictures of the model are those of
``docs/model.md``; every number and table is filled in from ``benchmarks/results``. PDF files are
made where a Chromium is installed.

Run: ``python benchmarks/technical_report.py [--out FOLDER] [--no-film]``
"""

import argparse
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

from figures import results
from harness.machine import ROOT
from paper.filling import filled
from paper.page import report_page, slides_page
from tables import tables

TEXTS = ROOT / "docs" / "report"
CHAPTER_S = 21.0
CHAPTERS = (
    ("gate", "A gate: waiting, and who follows without a ticket"),
    ("platform-edge", "A platform: who comes near the edge"),
    ("falling", "A hall: a fall"),
)
_MAIN = "from trecsim.cli import main; main()"
_BROWSERS = ("chromium", "chromium-browser", "google-chrome", "chrome")


def main() -> int:
    """Make all of it; return the exit status."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--out", type=Path, default=ROOT / "out" / "report", metavar="FOLDER")
    parser.add_argument("--no-film", action="store_true", help="make no film")
    given = parser.parse_args()
    given.out.mkdir(parents=True, exist_ok=True)
    found = results()
    made = tables(found)
    for name, page in (("technical-report", report_page), ("slides", slides_page)):
        text = filled((TEXTS / f"{name}.md").read_text(encoding="utf-8"), found, made)
        file = given.out / f"{name}.html"
        file.write_text(page(text), encoding="utf-8")
        print(told(file))
        print_to_pdf(file)
    if not given.no_film:
        print(told(film(given.out / "film.mp4")))
    return 0


def told(file: Path) -> str:
    """Return the name of a file that was made."""
    return str(file.relative_to(ROOT) if file.is_relative_to(ROOT) else file)


def print_to_pdf(file: Path) -> None:
    """Print a page to PDF beside it, where there is a browser."""
    browser = next(filter(None, map(shutil.which, _BROWSERS)), None)
    if browser is None:
        print(f"  no PDF: none of {', '.join(_BROWSERS)} is installed; print the page instead")
        return
    out = file.with_suffix(".pdf")
    command = [
        browser, "--headless", "--no-sandbox", "--disable-gpu", "--no-pdf-header-footer",
        f"--print-to-pdf={out}", file.resolve().as_uri(),
    ]  # fmt: skip
    done = subprocess.run(command, capture_output=True, text=True, timeout=300)
    if done.returncode or not out.is_file():
        raise RuntimeError(f"{browser} made no PDF: {done.stderr[-500:]}")
    print(told(out))


def film(out: Path) -> Path:
    """Make the film: each scene simulated, tracked, its rules judged, forecast, and drawn."""
    with tempfile.TemporaryDirectory() as name:
        chapters = [chapter(Path(name) / scene, scene, title) for scene, title in CHAPTERS]
        join(chapters, out)
    return out


def chapter(folder: Path, scene: str, title: str) -> Path:
    """Make one chapter of the film in a folder of its own."""
    run(["simulate", scene, "--out", folder, "--seconds", CHAPTER_S])
    tracks, site, made = folder / "tracks.parquet", folder / "site.toml", folder / "film.mp4"
    run(["track", folder / "rig.toml", folder / "poses.jsonl", "--out", tracks, "--lag-s", 0.2])
    run(["assess", tracks, site, "--out", folder / "events.jsonl"])
    run(["forecast", tracks, "--out", folder / "forecast.jsonl"])
    size = ["--width", 1920, "--height", 1080]
    run(["render", tracks, made, "--site", site, "--title", title, *size])
    return made


def join(films: list[Path], out: Path) -> None:
    """Put films that were coded alike one after the other, without coding them anew."""
    import av

    with av.open(str(out), "w", options={"movflags": "faststart"}) as joined:
        stream, shift = None, 0
        for film in films:
            with av.open(str(film)) as part:
                source = part.streams.video[0]
                stream = stream or joined.add_stream_from_template(source)
                length = 0
                for packet in part.demux(source):
                    if packet.dts is None:
                        continue
                    length = max(length, packet.pts + (packet.duration or 0))
                    packet.pts, packet.dts = packet.pts + shift, packet.dts + shift
                    packet.stream = stream
                    joined.mux(packet)
                shift += length


def run(arguments: list[object]) -> None:
    """Run one command of trecsim."""
    program: Callable[[list[str]], object] = subprocess.check_call
    program([sys.executable, "-c", _MAIN, *map(str, arguments), "--json"])


if __name__ == "__main__":
    sys.exit(main())
