"""Where people are whom one camera alone sees for half a minute, and whether that is known.

*New*: the other camera finds nobody from the beginning on; the person stays provisional. *Known*:
two cameras see the person for some seconds before. Everybody stands, walks about, or walks towards
the camera and away from it. The detector has the errors of a real one; seeds 1100 and up, which
nothing was tuned on (the noise of gait and feet was, on seeds 1000 to 1003).

Run: ``python benchmarks/one_view.py``; faster: ``python benchmarks/one_view.py --quick``
"""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from close import TORSO, emptied
from harness.command import alone
from harness.figures import Figure, Figures, once, over_seeds
from harness.following import Array
from harness.options import Options, fingerprint, settings_from

if TYPE_CHECKING:
    from trecsim.geometry import Camera, Rig
    from trecsim.lab.simulation import Simulation
    from trecsim.lab.simulation.actions import Action
    from trecsim.values import Snapshot

SEEDS, QUICK_SEEDS, LATER = 8, 3, 100
FPS = 25.0
KNOWN_S, ALONE_S = 4.0, 30.0
SETTLED_S = 1.0  # of the time alone, so much at the beginning is not counted
NEAR_M, FAR_M = 3.0, 8.5  # how people walk towards the camera and away from it
DOING = ("standing", "walking about", "towards and away")
FROM = ("new", "known")
WITHIN = {"50 %": 2.366, "90 %": 6.251}  # of the distribution of chi squared, 3 degrees of freedom
Task = tuple[str, str, int, Mapping[str, Any]]


def room() -> "Rig":
    """Return two cameras in neighbouring corners of a hall."""
    from trecsim.lab.simulation.room import corner_rig

    return corner_rig(9.0, 7.0, 2.8, 2)


def before(camera: "Camera", distance_m: float, aside_m: float) -> tuple[float, float]:
    """Return a point on the floor so far before a camera, and so far beside its line of sight."""
    ahead = camera.T_cam_world[2, :2] / np.linalg.norm(camera.T_cam_world[2, :2])
    x_m, y_m = (
        camera.position_m[:2] + distance_m * ahead + aside_m * np.array([-ahead[1], ahead[0]])
    )
    return float(x_m), float(y_m)


def made(what: str, seed: int) -> "tuple[Simulation, Camera]":
    """Return a scene of one person, and the camera that always sees the person."""
    from trecsim.lab.simulation.actions import Stand, Walk
    from trecsim.lab.simulation.camera_clocks import Clock
    from trecsim.lab.simulation.people import ScriptedPeople
    from trecsim.lab.simulation.roles import Role, Visit
    from trecsim.lab.simulation.scene import Scene, simulate

    rig, rng = room(), np.random.default_rng([seed, DOING.index(what)])
    eye = rig.cameras[seed % 2]
    speed_mps = float(rng.uniform(0.8, 1.4))

    def somewhere() -> tuple[float, float]:
        far_m = float(rng.uniform(NEAR_M + 0.5, FAR_M - 0.5))
        return before(eye, far_m, float(rng.uniform(-0.25, 0.25)) * far_m)

    to_and_fro = [before(eye, far_m, 0.2) for far_m in (FAR_M, NEAR_M) * 8]
    actions: dict[str, tuple[Action, ...]] = {
        "standing": (Stand(60.0),),
        "walking about": (Walk(tuple(somewhere() for _ in range(20)), speed_mps),),
        "towards and away": (Walk(tuple(to_and_fro), speed_mps),),
    }
    role = Role((Visit(somewhere(), actions[what], float(rng.uniform(-np.pi, np.pi))),))
    clocks = Clock(FPS), Clock(FPS, start_s=0.37 / FPS)
    scene = Scene(rig, ScriptedPeople((role,)), KNOWN_S + ALONE_S, clocks=clocks)
    return simulate(scene, seed), eye


def one_view(task: Task) -> tuple[dict[str, float], str]:
    """Return what became of somebody whom one camera sees alone, and the input's fingerprint."""
    from trecsim.fusion.warmup import warm_up
    from trecsim.lab.evaluation.truth_matching import truth_at
    from trecsim.store.truth import Truth
    from trecsim.tracking import Follower

    what, since, seed, overrides = task
    scene, eye = made(what, seed)
    alone_s = 0.0 if since == "new" else KNOWN_S
    poses = tuple(
        emptied(image) if image.camera != eye.name and image.t_s >= alone_s else image
        for image in scene.poses
    )
    truth = Truth(scene.truth_t_s, scene.truth_xyz_m)
    warm_up()
    follower = Follower(scene.rig, settings_from(overrides), provisional=True)
    found = []
    for image in poses:
        for snapshot in follower.add(image):
            if alone_s + SETTLED_S <= snapshot.t_s < alone_s + ALONE_S:
                truth_m = truth_at(np.array([snapshot.t_s]), truth)[0, 0]
                found.append(place(snapshot, truth_m, eye))
    return summary(np.array(found)), fingerprint(poses)


def place(snapshot: "Snapshot", truth_m: Array, eye: "Camera") -> tuple[float, ...]:
    """Return what is said of the place of the person nearest to the truth, and how far it is off.

    Off in depth [m], squared distance by the stated covariance, logarithm of the density there,
    standard deviation along the ray [m], who it is, and how many others there are.
    The covariance of the place is the mean of the joints', which share their error.
    """
    if not len(snapshot.id):
        return (np.nan,) * 4 + (-1.0, 0.0)
    torso = list(TORSO)
    off_m = snapshot.xyz_m[:, torso].mean(axis=1) - truth_m[torso].mean(axis=0)
    best = int(np.linalg.norm(off_m, axis=1).argmin())
    sight = truth_m[torso].mean(axis=0) - eye.position_m
    sight /= np.linalg.norm(sight)
    cov_m2 = snapshot.cov_m2[best, torso].mean(axis=0)
    apart = float(off_m[best] @ np.linalg.solve(cov_m2, off_m[best]))
    density = -0.5 * (apart + np.log(np.linalg.det(2 * np.pi * cov_m2)))
    return (
        *(float(off_m[best] @ sight), apart, float(density)),
        *(float(np.sqrt(sight @ cov_m2 @ sight)), float(snapshot.id[best]), len(snapshot.id) - 1.0),
    )


def summary(found: Array) -> dict[str, float]:
    """Return figures of one stay."""
    depth_m, apart, density, sigma_m, who, others = found.T
    there = np.isfinite(depth_m)
    if not there.any():
        return {}
    return {
        "off in depth, median": 100 * float(np.median(np.abs(depth_m[there]))),
        "off in depth, p95": 100 * float(np.quantile(np.abs(depth_m[there]), 0.95)),
        "stated sigma of the depth, median": 100 * float(np.median(sigma_m[there])),
        **{
            f"in {name} regions": 100 * float((apart[there] <= chi).mean())
            for name, chi in WITHIN.items()
        },
        "log density": float(density[there].mean()),
        "lost": 100 * float((~there).mean()),
        "further people": 100 * float(others.mean()),
        "switches": float((np.diff(who[there]) != 0).sum()),
    }


UNITS = {"off": "cm", "stated": "cm", "in": "%", "lost": "%", "further": "%"}


def figures_of(runs: Mapping[int, Mapping[str, float]]) -> Figures:
    """Return the figures of one activity over the seeds."""
    out: dict[str, Figure] = {}
    for name in next(iter(runs.values())):
        values = {seed: found.get(name, np.nan) for seed, found in runs.items()}
        unit = UNITS.get(name.split()[0], "")
        better = "higher" if name.startswith(("in ", "log")) else "lower"
        out[name] = over_seeds(values, unit, better)
    in_90 = np.mean([found.get("in 90 % regions", np.nan) for found in runs.values()])
    out["away from 90 %"] = once(abs(float(in_90) - 90.0), "%", matters=3.0)
    return out


def measure(options: Options) -> Figures:
    """Measure people whom one camera sees alone for half a minute."""
    later = 0 if options.only_seeds else LATER
    seeds = [seed + later for seed in options.seeds(SEEDS, QUICK_SEEDS)]
    options.input.update(data="a simulated hall", seeds=[seeds[0], seeds[-1]], fps=FPS)
    figures: dict[str, Figures] = {}
    for since in FROM:
        for what in DOING:
            tasks = [(what, since, seed, options.overrides) for seed in seeds]
            name = f"{since}, {what}"
            runs = dict(zip(seeds, options.over(one_view, tasks, name), strict=True))
            options.fingerprints[name] = runs[seeds[0]][1]
            figures[name] = figures_of({seed: one for seed, (one, _) in runs.items()})
    return figures


if __name__ == "__main__":
    raise SystemExit(alone(__file__, measure))
