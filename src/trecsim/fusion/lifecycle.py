"""Confirmation, support, death and duplicates (thesis sections 3.6.4 and 3.6.7).

Support is counted in cameras and in time, never in observations, so that frame rates and
dropped frames change nothing.
"""

import numpy as np
from jaxtyping import Bool, Float64, Int64

from trecsim.fusion import kernels
from trecsim.fusion.association import Association
from trecsim.fusion.images import Images
from trecsim.fusion.kernels.presence import SUPPORT_S
from trecsim.fusion.model import Model
from trecsim.fusion.population import Population
from trecsim.fusion.tuning import (
    CLEAR_PAIR,
    MIRROR_S,
    MOST_SWAP_EVIDENCE,
    REDUNDANT_CHECKS,
    SWAP_EVIDENCE,
)


def note_support(
    people: Population,
    images: Images,
    association: Association,
    inlier: Float64[np.ndarray, "track view joint"],
    t_s: float,
    elapsed_s: float,
) -> None:
    """Write down, in place, which camera supports whom and which joint now."""
    kernels.note_support(
        images.cam, images.t_s, association.match, inlier, people.camera_s, people.joint_s
    )
    kernels.age(
        people.camera_s, association.match, association.flip, t_s, elapsed_s,
        people.two_s, people.together_s, people.mirrored_s,
    )  # fmt: skip


def doubt(
    people: Population,
    images: Images,
    association: Association,
    xyz_m: Float64[np.ndarray, "view track joint 3"],
    model: Model,
) -> None:
    """Gather evidence, in place, that people are halves of two, or that others explain them.

    To be called once in `CHECK_S`, as the errors of a detector persist. `xyz_m` is where
    everybody should be in each image.
    """
    kernels.note_needless(
        model.P, model.focal_px, images.cam, xyz_m, images.xy_px, association.match,
        people.confirmed, people.needless,
    )  # fmt: skip
    kernels.note_exchanges(
        images.cam, images.offset, images.xy_px, images.factor, association.match, model.ray_of,
        model.position_m, model.bones, model.bone_m, model.noise, CLEAR_PAIR, MOST_SWAP_EVIDENCE,
        people.crossed,
    )  # fmt: skip


def trusted_s(people: Population) -> Float64[np.ndarray, " track"]:
    """Return when two cameras last supported people; never, if they rather show two people [s]."""
    return np.where(people.crossed > SWAP_EVIDENCE, -np.inf, people.two_s)


def mend_mirrored(people: Population, model: Model) -> None:
    """Exchange left and right, in place, of people whom most cameras read the other way round."""
    if people.mirrored_s.max(initial=0.0) <= MIRROR_S:
        return
    for k in np.flatnonzero(people.mirrored_s > MIRROR_S):
        people.mirror(int(k), model.noise.mirror)
        people.mirrored_s[k] = 0.0


def support(people: Population, t_s: float) -> Int64[np.ndarray, "track joint"]:
    """Return how many cameras support each joint at `t_s`."""
    count = np.empty(people.joint_s.shape[:2], np.int64)
    kernels.count_since(people.joint_s, t_s - SUPPORT_S, count)
    return count


def confirm(people: Population, model: Model, t_s: float) -> None:
    """Confirm, in place, whom two cameras have supported long enough or three support now."""
    kernels.confirm_all(
        people.camera_s, people.together_s, t_s, model.settings.confirm_s, people.confirmed
    )


def expected_cameras(
    people: Population, model: Model, looking: Bool[np.ndarray, " cam"], t_s: float
) -> Int64[np.ndarray, " track"]:
    """Return in how many of the cameras that are looking each person should be found.

    That is where the torso is in the raw image, and no nearer person hides most of the joints. It
    is worked out only for those whose life hangs on it; for the others it is two. It is -1 where
    nearer people hide the person from every camera that has it in its image.
    """
    s, n = model.settings, len(people)
    asked, expected = np.empty(n, bool), np.full(n, 2, np.int64)
    if kernels.ask_all(people.camera_s, people.two_s, t_s, s.death_s, s.doubt_s, asked):
        kernels.expect_all(
            model.lenses, model.silhouette, looking, model.torso, people.x_m, asked, expected
        )
    return expected


def survivors(
    people: Population, model: Model, expected: Int64[np.ndarray, " track"], t_s: float
) -> Bool[np.ndarray, " track"]:
    """Return who lives on.

    Notes
    -----
    A tentative person needs two cameras again within a quarter of a second. A confirmed one
    dies when no camera supports it for `death_s` (half of that where no camera looks, 0.7 of it
    where three or more should find it), or when for `doubt_s` only one of three or more cameras
    that should find it does. Whom others hide from a camera, that camera should not find. And
    nobody lives on whom others could have explained for long.
    """
    s = model.settings
    alive = np.empty(len(people), bool)
    kernels.survive_all(
        people.camera_s, people.two_s, people.confirmed, expected, people.x_m,
        t_s, s.death_s, s.doubt_s, alive,
    )  # fmt: skip
    return alive & (people.needless < REDUNDANT_CHECKS)


def close_pairs(
    people: Population, model: Model, association: Association
) -> list[tuple[int, int]]:
    """Return pairs of tracks that lie on each other and that no image tells apart, older first.

    Only tracks that the association knows are compared.
    """
    known = len(association.match)
    torso = people.x_m[:known]
    if not kernels.any_close(torso, model.torso, model.settings.duplicate_m):
        return []
    torso = torso[:, model.torso]
    distance = np.linalg.norm(torso[:, None] - torso[None], axis=-1).mean(axis=-1)
    first, second = np.nonzero(np.triu(distance < model.settings.duplicate_m, k=1))
    seen = association.match >= 0
    return [
        (int(i), int(k)) if people.id[i] < people.id[k] else (int(k), int(i))
        for i, k in zip(first, second, strict=True)
        if not (seen[i] & seen[k]).any()
    ]


def is_known(
    people: Population,
    torso_m: Float64[np.ndarray, "joint_of_torso 3"],
    eyes: Bool[np.ndarray, " view"],
    association: Association,
    model: Model,
) -> bool:
    """Return whether somebody new is one of `people` whom some cameras failed to recognise.

    Parameters
    ----------
    people
        Those whom the association knows come first.
    torso_m
        The joints of the new torso.
    eyes
        Which images are of the cameras that see somebody new.
    association
        Who was found in each image.
    model
        Constants of the run.

    Notes
    -----
    Who stands where two other cameras see somebody, whom these cameras do not, is the same person.
    """
    known = people.x_m[: len(association.match), model.torso]
    apart_m = np.linalg.norm(known - torso_m, axis=-1).mean(axis=1)
    seen = association.match[apart_m < model.settings.duplicate_m] >= 0
    return bool((~seen[:, eyes].any(axis=1) & (seen[:, ~eyes].sum(axis=1) >= 2)).any())
