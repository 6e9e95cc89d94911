"""Digest of the rig that a recording was made with."""

import hashlib
import json

import numpy as np

from trecsim.geometry import Rig


def rig_sha256(rig: Rig) -> str:
    """Return a digest that changes whenever any number or name of the rig does."""
    digest = hashlib.sha256()
    for camera in rig:
        named = [camera.name, list(camera.size_px), camera.distortion_model, camera.time_offset_s]
        if camera.time_drift_ppm:
            named += [camera.time_drift_ppm, camera.time_ref_s]
        digest.update(json.dumps(named).encode())
        for numbers in (camera.K, camera.T_cam_world, camera.distortion):
            digest.update(np.ascontiguousarray(numbers, dtype="<f8").tobytes())
    return digest.hexdigest()
