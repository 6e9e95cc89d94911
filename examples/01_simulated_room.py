"""Track people in a simulated room and compare the tracks with the ground truth.

`trecsim.follow` works the same on your own recordings. The modules under `trecsim.lab` make the
synthetic scene and the comparison; docs/reference/api.md lists them. Run it:
``python examples/01_simulated_room.py``
"""

import numpy as np

import trecsim
from trecsim.lab.evaluation.ground_truth import compare
from trecsim.lab.simulation.scene import room_scene, simulate


def main() -> None:
    """Simulate ten seconds, track them, and print what came out."""
    made = simulate(room_scene(people=3, cameras=4, seconds=10.0), seed=1)
    snapshots = list(trecsim.follow(made.poses, made.rig))
    result = compare(snapshots, made.truth_t_s, made.truth_xyz_m)
    tracks = {person for snapshot in snapshots for person in snapshot.id.tolist()}
    print(f"{len(made.truth_xyz_m)} people simulated, {len(tracks)} tracked")
    print(f"mean error {100 * result.mean_m:.1f} cm, {result.switches} identity switches")

    last = snapshots[-1]
    for person, xyz_m, sigma_m in zip(last.id, last.xyz_m, last.sigma_m, strict=True):
        nose = trecsim.COCO17.index("nose")
        print(f"person {person}: nose at {np.round(xyz_m[nose], 2)} m, +-{sigma_m[nose]:.2f} m")


if __name__ == "__main__":
    main()
