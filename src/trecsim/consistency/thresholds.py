"""Every number that decides whether something is remarked, in one table."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Thresholds:
    """When poses and rig are said not to fit.

    They were chosen on synthetic scenes with and without faults; `benchmarks/fit_remarks.py` shows
    what they do there and on real recordings.

    Attributes
    ----------
    spacing_s, settle, spacing_growth, longest_spacing_s
        Frame sets are sampled this far apart; after `settle` of them the distance grows by
        `spacing_growth` with every sample, up to the longest [s].
    batch
        So many sampled frame sets are examined together.
    fewest_images
        A camera with fewer images is not judged by its times.
    fewest_points
        A camera with fewer key points is not judged by where they lie.
    outside_margin
        A key point counts as outside beyond this share of the image's width or height.
    outside_share
        From this share of key points outside, the image size is wrong.
    corner_px, corner_share
        Key points this near to the corner, in this share of the cases, are no pixels.
    """

    spacing_s: float = 0.1
    settle: int = 48
    spacing_growth: float = 1.02
    longest_spacing_s: float = 1.0
    batch: int = 16

    fewest_images: int = 5
    fewest_points: int = 100
    outside_margin: float = 0.1
    outside_share: float = 0.1
    corner_px: float = 2.0
    corner_share: float = 0.9
