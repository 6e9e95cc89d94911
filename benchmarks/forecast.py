"""How good floor forecasts are on ETH/UCY, each scene with a table fitted on the others only.

8 samples observed (3.2 s), 12 forecast (4.8 s), 0.4 s apart. The published protocol has ETH with a
clock 1.67 times too fast; beside it stands the mean with ETH in its true time. That fast copy is
never fitted on, and a scene's own recordings never are, in either time. Regions are calibrated
while running, from what happened in the same scene before.

Run: ``python benchmarks/forecast.py [--quick] [--store]``; quick leaves out the largest scene.
"""

import time
from itertools import chain
from pathlib import Path

import numpy as np

from harness.calibration import calibration_ms
from harness.command import alone
from harness.figures import Figures, Skipped, once, timed
from harness.options import Options, shared_data
from trecsim.forecasting.forecasts import Moment

PUBLISHED = ("eth", "hotel", "univ", "zara1", "zara2")
PEOPLE, ROUNDS = 50, 40
POSE_AHEAD_S = (0.2, 0.4, 0.6, 1.0)
LARGEST = "univ"


def recordings() -> dict[str, list[list[Moment]]]:
    """Return the recordings of each set."""
    from trecsim.store.ethucy import sets_in
    from trecsim.store.floor_paths import read_floor_paths

    files = sets_in([shared_data("ethucy")])
    return {name: [read_floor_paths(path) for path in paths] for name, paths in files.items()}


def measure(options: Options) -> Figures:
    """Measure forecasts of floor paths, leaving out the scene that is evaluated."""
    from forecast_fit import fit, windows
    from trecsim.forecasting.path_scores import evaluated, joined
    from trecsim.store.ethucy import TRUE_TIME

    options.input.update(data="ETH/UCY", protocol="8 observed, 12 forecast, every 0.4 s")
    recorded = recordings()
    if options.quick:
        del recorded[LARGEST]
        options.skipped[LARGEST] = "quick"
    seen = {name: [one for recording in found for one in windows(recording)]
            for name, found in recorded.items() if name != "eth"}  # fmt: skip
    sets, figures = {}, {}
    for name, found in recorded.items():
        own = TRUE_TIME if name == "eth" else name
        table = fit({other: known for other, known in seen.items() if other != own})
        scores = joined([evaluated(recording, table) for recording in found])
        sets[name] = scores
        figures[name] = of_scores([scores])
    published = [sets[name] for name in PUBLISHED if name in sets]
    timely = [sets[TRUE_TIME], *published[1:]]
    return {
        "mean, published protocol": of_scores(published),
        "mean, true time": of_scores(timely),
        **figures,
        f"cost, {PEOPLE} people": cost(),
        "poses": poses(options),
    }


def of_scores(scores: list) -> Figures:
    """Return the plain mean over sets of all figures of forecasts."""
    found = [one.summary() for one in scores]

    def mean(*keys: str, unit: str = "m", watched: bool = True, better: str = "lower") -> object:
        values = found
        for key in keys:
            values = [one[key] for one in values]
        return once(float(np.mean(values)), unit, better=better, watched=watched)

    off = np.abs(np.mean([one.inside.mean(axis=0) for one in scores], axis=0)
                 - np.array([0.5, 0.8, 0.9, 0.95])[:, None])  # fmt: skip
    return {
        "ADE": mean("ade_m"),
        "FDE": mean("fde_m"),
        "constant velocity": {
            "ADE": mean("constant_velocity", "ade_m", watched=False),
            "FDE": mean("constant_velocity", "fde_m", watched=False),
        },
        "best of 20": {"ADE": mean("best_of_20", "ade_m"), "FDE": mean("best_of_20", "fde_m")},
        "coverage": {
            level: mean("coverage", level, unit="", watched=False)
            for level in ("0.5", "0.8", "0.9", "0.95")
        },
        "largest coverage error at any horizon": {
            level: once(float(worst), "")
            for level, worst in zip(("0.5", "0.8", "0.9", "0.95"), off.max(axis=1), strict=True)
        },
        "whole path at 90 %": mean("whole_path_coverage", "0.9", unit="", watched=False),
        "NLL": mean("nll", unit="log m2"),
        "samples": once(sum(one["samples"] for one in found), "", watched=False),
    }


def poses(options: Options) -> Figures:
    """Return the mean joint error of pose forecasts on recorded motion, beside zero velocity.

    Positions are given with an error of 1 cm. The constants were chosen on every other clip;
    "clips not tuned on" are the rest.
    """
    try:
        files = sorted(shared_data("mocap").glob("*.npz"))
    except Skipped as reason:
        options.skipped["poses"] = str(reason)
        return {}
    parts = {"all clips": files[::4] if options.quick else files, "clips not tuned on": files[1::2]}
    errors = {file: _pose_errors(file) for file in dict.fromkeys(chain(*parts.values()))}
    figures: dict[str, Figures] = {}
    for name, chosen in parts.items():
        found = np.concatenate([errors[file] for file in chosen])
        figures[name] = {
            f"{ahead_s:g} s": {
                kind: once(100 * float(found[:, k, i].mean()), "cm", watched=i == 0)
                for i, kind in enumerate(("forecast", "zero velocity"))
            }
            for k, ahead_s in enumerate(POSE_AHEAD_S)
        }
    return figures


def _pose_errors(file: Path) -> np.ndarray:
    """Return mean joint errors of a clip, (moment, horizon, forecast or zero velocity) [m]."""
    from trecsim.forecasting import PoseForecaster
    from trecsim.values import Snapshot

    with np.load(file) as clip:
        truth_m, fps = clip["joints"][:, :17].astype(float), float(clip["fps"])
    rng = np.random.default_rng(1000)
    seen_m = truth_m + rng.normal(0, 0.01, truth_m.shape)
    steps = np.round(np.array(POSE_AHEAD_S) * fps).astype(int)
    forecaster = PoseForecaster(np.array(POSE_AHEAD_S), every_s=0.1)
    cov_m2, support = np.full((1, 17, 3, 3), 1e-4), np.full((1, 17), 4)
    found = []
    for i, xyz_m in enumerate(seen_m[: max(len(seen_m) - steps[-1], 0)]):
        made = forecaster(Snapshot(i / fps, np.array([1]), xyz_m[None], cov_m2, support))
        if made and i >= 0.4 * fps:
            ahead_m = truth_m[i + steps]
            both = [np.linalg.norm(at - ahead_m, axis=2).mean(axis=1)
                    for at in (made[0].xyz_m, xyz_m[None])]  # fmt: skip
            found.append(np.stack(both, axis=1))
    return np.array(found).reshape(-1, len(steps), 2)


def cost() -> Figures:
    """Return the thread time of one forecast of 4.8 s for a crowd."""
    from trecsim.forecasting import Forecaster

    rng = np.random.default_rng(1000)
    start_m, speed_mps = rng.uniform(0, 20, (PEOPLE, 2)), rng.normal(0, 0.8, (PEOPLE, 2))
    forecaster, people = Forecaster(), np.arange(PEOPLE)
    took_ms, calibration = [], []
    for frame in range(ROUNDS + 20):
        t_s = 0.2 * frame
        before_ms = calibration_ms()
        began_s = time.thread_time()
        forecaster.step(t_s, people, start_m + t_s * speed_mps)
        if frame >= 20:
            took_ms.append(1e3 * (time.thread_time() - began_s))
            calibration.append((before_ms + calibration_ms()) / 2)
    return {
        "thread time of a forecast": timed(took_ms, calibration, "ms", used=took_ms),
        "thread time, least": once(min(took_ms), "ms", watched=False),
    }


if __name__ == "__main__":
    raise SystemExit(alone(__file__, measure))
