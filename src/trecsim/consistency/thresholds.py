"""Every number that decides whether something is remarked, in one table."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Thresholds:
    """When poses and rig are said not to fit.

    They were chosen on synthetic scenes with and without faults; `benchmarks/fit_remarks.py` shows
    what they do there and on real recordings. On recordings without a fault nearly everything
    agrees (explained 0.9 and more, missed 0.01 and less, pairs of cameras 0.9 and more, residuals
    0.1 m and less, shifts of 0.028 rad and less), so that the limits lie far from there.

    Attributes
    ----------
    spacing_s, settle, spacing_growth, longest_spacing_s
        Frame sets are sampled this far apart; after `settle` of them the distance grows by
        `spacing_growth` with every sample, up to the longest [s].
    batch
        So many sampled frame sets are examined together.
    window
        A camera is judged by so many batches, and not before there are so many.
    wait
        A camera that agreed before and no longer does is told to be odd after so many batches: by
        then it is clear whether it was moved.
    recent
        So many sampled frame sets are kept; hypotheses are tried on them.
    most_tried
        Of more in an image, hypotheses are tried on so many.
    pairs_at_once
        With more pairs of cameras, hypotheses are tried on proportionally fewer frame sets.
    least_moments
        A recording that ends leaves a batch of so many frame sets at least.
    most_views
        So many images are kept at most until their key points are counted.
    most_detections, most_people
        Of more in an image, or tracked, the rest is left out.

    fewest_images
        A camera with fewer images is not judged by its times.
    fewest_points
        A camera with fewer key points is not judged by where they lie.
    outside_margin
        A key point is outside beyond this share of the image's width or height.
    outside_share
        From this share of key points outside, the image size is wrong.
    corner_px, corner_share
        Key points this near to the corner, in this share of the cases, are no pixels.

    gate_m
        A detection is no person whose torso its viewing rays pass further away [m].
    meet_m
        The rays of other cameras that pass a person further away do not tell where they are [m].
    fewest
        With fewer cases a camera is not suspicious.
    explained_share
        A camera is suspicious if fewer of its detections are people whom another camera sees.
    missed_share
        It is suspicious if more of the people whom two others see are not where they should be.
    empty_share
        It is suspicious if it shows nothing of more of these people: where two cameras at opposite
        corners are exchanged, each pair of cameras agrees on people whom the other does not see.
    off_m
        It is suspicious if its median residual is larger [m].
    beside_m
        A detection beside a person by more is not where it should be [m].
    good_m, good_rad
        Up to this residual and shift a batch says that a camera was right [m, rad].

    agree_share
        Two cameras agree from this share of the cases on.
    right_share, right_share_of_two
        A hypothesis is right if cameras agree in this share of the cases under it, for rigs of
        three cameras and more, and of two.
    gain_share
        It must bring so much more than nothing.
    fewest_pairs
        With fewer cases nothing is said of cameras that do not agree for an unknown reason.
    disagree_share
        Cameras do not agree below this share of the cases.
    odd_missed_share
        A camera does not agree with the others if more people than this share are not where they
        should be.

    turned_rad
        From this shift on a camera looks elsewhere than the rig says [rad].
    voted_share
        So many of its detections must be people after a turn.
    steady_share
        By so much of its size a turn may change from one half of the moments to the other.
    clean_share
        Without the camera that is off, the others' residuals must fall to this share of its own.
    fewest_in_batch
        With fewer people a batch does not tell a camera's offset.
    moved_rad, moved_m
        From this change on, and from this residual on, a camera was moved [rad, m].
    moved_noises
        The change must be so many times the usual change from batch to batch.
    steady_rad
        Which is never less than this [rad].
    """

    spacing_s: float = 0.15
    settle: int = 32
    spacing_growth: float = 1.02
    longest_spacing_s: float = 2.0
    batch: int = 10
    window: int = 2
    wait: int = 4
    recent: int = 48
    least_moments: int = 6
    most_views: int = 512
    most_detections: int = 24
    most_tried: int = 8
    pairs_at_once: int = 10
    most_people: int = 64

    fewest_images: int = 5
    fewest_points: int = 100
    outside_margin: float = 0.1
    outside_share: float = 0.1
    corner_px: float = 2.0
    corner_share: float = 0.9

    gate_m: float = 0.5
    meet_m: float = 0.15
    fewest: int = 8
    explained_share: float = 0.75
    missed_share: float = 0.2
    empty_share: float = 0.45
    off_m: float = 0.15
    beside_m: float = 0.2
    good_m: float = 0.1
    good_rad: float = 0.02

    agree_share: float = 0.75
    right_share: float = 0.85
    right_share_of_two: float = 0.95
    gain_share: float = 0.25
    fewest_pairs: int = 16
    disagree_share: float = 0.5
    odd_missed_share: float = 0.5

    turned_rad: float = 0.031
    voted_share: float = 0.6
    steady_share: float = 0.35
    clean_share: float = 0.6
    fewest_in_batch: int = 6
    moved_rad: float = 0.021
    moved_m: float = 0.04
    moved_noises: float = 5.0
    steady_rad: float = 0.002
