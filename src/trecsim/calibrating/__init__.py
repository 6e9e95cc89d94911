"""Calibration of cameras from what they see: boards, people; with a verdict on the result.

The files of rigs are read and written by `trecsim.calibration`; here the numbers in them are
estimated. Every way to calibrate ends in a `CalibrationResult`.
"""

from trecsim.calibrating.result import CalibrationResult, CameraQuality, Verdict

__all__ = ["CalibrationResult", "CameraQuality", "Verdict"]
