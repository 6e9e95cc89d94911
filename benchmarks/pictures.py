"""Draw the pictures of the page about the model, each by the code it is about.

Run: ``python benchmarks/pictures.py`` (``make pictures`` does)
"""

import argparse
import sys
from importlib import import_module
from pathlib import Path

from harness.machine import ROOT

FOLDER = ROOT / "docs" / "pictures"
NAMES = (
    "responsibilities", "crossing", "smoothing", "beginning", "alone", "dragging", "near", "places",
    "leaving",
)  # fmt: skip


def draw(name: str, folder: Path, suffix: str = ".svg") -> Path:
    """Draw one picture into a folder; return its path."""
    path = folder / f"model-{name}{suffix}"
    import_module(f"pictured.{name}").draw(path)
    return path


def main() -> int:
    """Draw what is asked for, else all of them."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"of {', '.join(NAMES)}")
    parser.add_argument("--out", type=Path, default=FOLDER, help="folder for the pictures")
    parser.add_argument("--suffix", choices=(".svg", ".png"), default=".svg", help="what they are")
    asked = parser.parse_args()
    if unknown := sorted(set(asked.names) - set(NAMES)):
        parser.error(f"no picture is called {', '.join(unknown)}; there are {', '.join(NAMES)}")
    asked.out.mkdir(parents=True, exist_ok=True)
    for name in asked.names or NAMES:
        print(draw(name, asked.out, asked.suffix), flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
