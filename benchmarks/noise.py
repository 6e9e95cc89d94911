"""Whether the noise that the tracker states of key points is right, by joint and by score.

Three detectors: OpenPose on Shelf, MoveNet on the sample recording, and the simulated one. A figure
is the size of the errors that differ between cameras over what the tracker states; 1 is right, more
is a tracker that is too sure.

Run: ``python benchmarks/noise.py [--set NAME=VALUE]``
"""

from harness.command import alone
from harness.figures import Figures, Skipped, once
from harness.options import Options, sample_folder, shared_data


def measure(options: Options) -> Figures:
    """Measure errors of key points over the noise that the tracker states of them."""
    from detector import stated_noise
    from detector.made_views import made
    from harness.demo_video import SCENES, recorded
    from trecsim.lab.simulation.detector_errors import REAL

    options.input.update(data="Shelf, the sample recording, made people before Shelf's cameras")
    settings = options.settings()
    columns: dict[str, dict[str, float]] = {}
    try:
        rig, people = stated_noise.on_shelf(shared_data("shelf"))
        columns["OpenPose on Shelf"] = stated_noise.figures(rig, people, settings)
    except Skipped as reason:
        options.skipped["Shelf"] = str(reason)
    try:
        folder = sample_folder(options)
    except Skipped as reason:
        options.skipped["the sample recording"] = str(reason)
    else:
        for name in SCENES:
            scene = recorded(folder, name)
            actors = [stated_noise.of_actor(scene, who) for who in scene.actors]
            columns[f"MoveNet, {name}"] = stated_noise.figures(scene.rig, actors, settings)
    rig, people = made(REAL, seed=1)
    columns["simulated"] = stated_noise.figures(rig, people, settings)
    names = next(iter(columns.values()))
    return {
        name: {
            column: once(values[name], "x", watched=False)
            for column, values in columns.items()
            if values[name] == values[name]
        }
        for name in names
    }


if __name__ == "__main__":
    raise SystemExit(alone(__file__, measure))
