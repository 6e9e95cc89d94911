"""NetCDF for movement, written by movement itself: names of dimensions differ by its version."""

from pathlib import Path

import numpy as np

from trecsim.export.base import About
from trecsim.export.motions import Motion


def write_movement(motion: Motion, path: Path, about: About) -> None:
    """Write everybody as a data set of poses; confidence is NaN, as movement has no uncertainty."""
    from movement.io import load_poses

    frames = max(motion.first_frame(one) + len(one.t_s) for one in motion.people)
    shape = (frames, 3, len(about.skeleton.joints), len(motion.people))
    position = np.full(shape, np.nan)
    for number, one in enumerate(motion.people):
        first = motion.first_frame(one)
        position[first : first + len(one.t_s), ..., number] = one.xyz_m.transpose(0, 2, 1)
    poses = load_poses.from_numpy(
        position_array=position,
        confidence_array=None,
        individual_names=[f"person_{one.person}" for one in motion.people],
        keypoint_names=list(about.skeleton.joints),
        fps=motion.rate_hz,
        source_software="trecsim",
    )
    poses.attrs["first_time_s"] = motion.t0_s
    poses.to_netcdf(path)
