"""Fit which directions limbs take, on recorded motion; say how often that finds the true place.

The ray of a camera meets the sphere of a limb's length in two places, of which the recording tells
the true one. Cameras stand anywhere around the person; joints err by 3 cm. The weights of a
von Mises-Fisher distribution whose mean depends on the limb above are those that make true places
likelier than the others (logistic regression). They are fitted to the clips of DeepMimic, and
tried on those of Bandai Namco, which come from other people and another laboratory.

Run: ``python benchmarks/posture_fit.py`` prints the weights that it finds, and how good they are
beside those in use (``trecsim.fusion.limb_directions``)
"""

from collections.abc import Iterable
from pathlib import Path

import numpy as np
import numpy.typing as npt

from harness.options import shared_data
from trecsim.fusion import limb_directions, tuning
from trecsim.skeleton import COCO17

FITTED, TRIED = "dm_*.npz", "bn*.npz"
CHAINS = (
    ("hip", "knee"), ("shoulder", "elbow"), ("hip", "knee", "ankle"),
    ("shoulder", "elbow", "wrist"),
)  # fmt: skip
STEP = 3
VIEWS = 6
SIGMA_M = 0.03
DISTANCE_M, HEIGHT_M = (2.0, 9.0), (1.0, 4.0)
RIDGE = 1e-2
NEWTON_STEPS = 60
Array = npt.NDArray[np.float64]


def direction(along: Array) -> Array:
    """Return vectors of length one."""
    out: Array = along / np.linalg.norm(along, axis=-1, keepdims=True)
    return out


def joint(xyz_m: Array, name: str) -> Array:
    """Return where a joint is, (moment, 3)."""
    return xyz_m[:, COCO17.joints.index(name)]


def axes(xyz_m: Array, side: str, girdle: str) -> Array:
    """Return forwards, outwards and up of the trunk, (moment, 3, 3)."""
    left, right = (joint(xyz_m, f"{one}_{girdle}") for one in ("left", "right"))
    up = sum(joint(xyz_m, f"{one}_shoulder") - joint(xyz_m, f"{one}_hip")
             for one in ("left", "right"))  # fmt: skip
    up = direction(np.asarray(up))
    across = left - right
    across = direction(across - (across * up).sum(-1, keepdims=True) * up)
    outwards = across if side == "left" else -across
    return np.stack([np.cross(across, up), outwards, up], axis=1)


def features(body: Array, end_m: Array, near_m: Array, before_m: Array | None) -> Array:
    """Return what the weights multiply, (moment, 3) or (moment, 12), for an end of a limb."""
    limb = np.einsum("nij,nj->ni", body, direction(end_m - near_m))
    if before_m is None:
        return limb
    upper = np.einsum("nij,nj->ni", body, direction(near_m - before_m))
    return np.concatenate([limb, (limb[:, :, None] * upper[:, None]).reshape(-1, 9)], axis=1)


def differences(clip: Path, chain: tuple[str, ...], rng: np.random.Generator) -> Iterable[Array]:
    """Yield features of true places less those of the other ones, for cameras all around."""
    with np.load(clip) as file:
        xyz_m = np.asarray(file["joints"][::STEP, : len(COCO17.joints)], float)
    xyz_m += rng.normal(0.0, SIGMA_M, xyz_m.shape)
    for side in ("left", "right"):
        *before, near, end = (joint(xyz_m, f"{side}_{part}") for part in chain)
        before_m = before[0] if before else None
        body = axes(xyz_m, side, chain[0])
        for _ in range(VIEWS):
            angle, distance_m = rng.uniform(0.0, 2.0 * np.pi), rng.uniform(*DISTANCE_M)
            beside_m = distance_m * np.array([np.cos(angle), np.sin(angle)])
            camera_m = np.append(xyz_m.mean(axis=(0, 1))[:2] + beside_m, rng.uniform(*HEIGHT_M))
            ray = direction(end - camera_m)
            behind_m = ((end - near) * ray).sum(axis=-1)
            other = end - 2.0 * behind_m[:, None] * ray
            apart = 2.0 * np.abs(behind_m) > tuning.PLACES_APART_M
            both = [features(body, place, near, before_m) for place in (end, other)]
            yield (both[0] - both[1])[apart]


def fitted(some: Array) -> Array:
    """Return the weights that make true places likelier, by Newton's method."""
    weights = np.zeros(some.shape[1])
    for _ in range(NEWTON_STEPS):
        doubt = 1.0 / (1.0 + np.exp(some @ weights))
        slope = some.T @ doubt / len(some) - RIDGE * weights
        curve = (some * (doubt * (1.0 - doubt))[:, None]).T @ some / len(some)
        weights += np.linalg.solve(curve + RIDGE * np.eye(len(weights)), slope)
    return weights


def in_use(chain: tuple[str, ...]) -> Array:
    """Return the weights of a limb that the fusion uses, in the order of `features`."""
    known = limb_directions.postures(COCO17)
    limb = known.joints[:, 0].tolist().index(COCO17.joints.index(f"left_{chain[-1]}"))
    both = [known.mean[limb], known.mean_by_upper[limb].ravel()]
    return np.concatenate(both[: len(chain) - 1])


def main() -> None:
    """Fit each limb, and print its weights and how good they are, beside those in use."""
    folder = shared_data("mocap")
    for chain in CHAINS:
        rng = np.random.default_rng(0)
        both = [
            np.concatenate([d for clip in sorted(folder.glob(pattern))
                            for d in differences(clip, chain, rng)])
            for pattern in (FITTED, TRIED)
        ]  # fmt: skip
        weights = fitted(both[0]).round(1)
        print(f"{' -> '.join(chain)}: mean {weights[:3].tolist()}")
        if len(weights) > 3:
            print(f"  by the limb above {weights[3:].reshape(3, 3).tolist()}")
        for name, some in zip(("on the clips of the fit", "on others"), both, strict=True):
            print(f"  {name}: {len(some)} places")
            for which, used in (("these weights", weights), ("those in use", in_use(chain))):
                ratio = some @ used
                right, wrong = (ratio > 0).mean(), (ratio < -tuning.PLACE_SURE).mean()
                print(
                    f"    {which}: true one likelier in {100 * right:.1f} %, the other one by more "
                    f"than {tuning.PLACE_SURE:g} in {100 * wrong:.1f} %"
                )


if __name__ == "__main__":
    main()
