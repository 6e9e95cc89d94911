"""The command `trecsim sample`."""

from pathlib import Path

from trecsim.cli.terminal import finish, progress_bar


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
    lines = [f"{NOTICE}.", "Try:", *(f"  trecsim run {site}" for site in sites)]
    finish({"out": out, "sites": sites, "notice": NOTICE}, json, "\n".join(lines))
