"""Keep what a study found, and make of it the tables and the picture that the docs show.

Run: ``python benchmarks/study_pages.py FOLDER OF THE STUDY`` (``make study`` does)
"""

import re
import shutil
import sys
from pathlib import Path

from harness import pages
from harness.machine import ROOT
from study_results import default_rank_markdown, markdown, read_results
from trecsim.lab.report.style import PALETTE
from trecsim.lab.study.analysis import findings
from trecsim.lab.study.charts import effects_svg
from trecsim.lab.study.folder import STUDY
from trecsim.lab.study.plan import planned
from trecsim.lab.study.results import DEFAULT, PAIRS, RESULTS
from trecsim.lab.study.runs_file import NAME, read_runs
from trecsim.lab.study.settings_file_table import read_study_table

KEPT = ROOT / "benchmarks" / "results" / "study_three"
PAGE = ROOT / "docs" / "parameter-study.md"
PICTURE = ROOT / "docs" / "pictures" / "study-three.svg"
TABLES = {
    "study-three": lambda: markdown(read_results(KEPT / RESULTS)),
    "study-three-default": lambda: default_rank_markdown(read_results(KEPT / DEFAULT)),
}


def picture(folder: Path) -> str:
    """Return how the error depends on each setting, as a picture file."""
    study = planned(read_study_table(folder / STUDY), str(folder))
    runs = read_runs(folder / NAME)
    found = findings(study, runs, runs[-1].code)
    drawn = effects_svg(found, found.findings[0])
    plain = re.sub(r"var\(--(\w+)\)", lambda name: PALETTE[name[1]][0], drawn)
    header = (
        '<svg xmlns="http://www.w3.org/2000/svg" font-family="sans-serif" style="background:#fff" '
    )
    return plain.replace("<svg ", header, 1) + "\n"


def main() -> None:
    """Write the tables and the picture."""
    folder = Path(sys.argv[1])
    KEPT.mkdir(parents=True, exist_ok=True)
    for name in (RESULTS, PAIRS, DEFAULT):
        shutil.copyfile(folder / name, KEPT / name)
    pages.fill(PAGE, TABLES)
    PICTURE.write_text(picture(folder))
    for path in (KEPT, PAGE, PICTURE):
        print(path.relative_to(ROOT))


if __name__ == "__main__":
    main()
