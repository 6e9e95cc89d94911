"""The command `trecsim sample`."""

from pathlib import Path
from shlex import quote

from trecsim.cli.terminal import finish, progress_bar
from trecsim.extras import has_extra


def sample(*, out: Path = Path("sample"), json: bool = False) -> None:
    """Download a real multi-camera recording to try.

    It is the demo recording of Pose2Sim (BSD-3-Clause): four calibrated cameras, 100 frames each,
    one scene with one person and one with two actors and a bystander. A site file is written
    beside each scene, ready to run.

    Parameters
    ----------
    out
        Directory to write to.
    json
        Print the summary as one JSON object.
    """
    from trecsim.lab.sample import NOTICE, fetch_sample

    with progress_bar("bytes", quiet=json) as bar:
        sites = fetch_sample(out, progress=bar)
    tried = [line for site in sites for line in _tried(site)]
    finish({"out": out, "sites": sites, "notice": NOTICE}, json, "\n".join([NOTICE + ".", *tried]))


def _tried(site: Path) -> list[str]:
    """Return what to try with a scene: people in 3D, then the film of them over the videos."""
    name = site.parent.name.removesuffix("Person").lower()
    lines = [f"{site.parent.name}:", f"  trecsim run {quote(str(site))} --out {name}"]
    if has_extra("render"):
        lines.append(f"  trecsim render {name} {name}.mp4 --site {quote(str(site))}")
    return lines
