"""Whether stated covariances are true: shares of errors inside their regions, and sharpness."""

from dataclasses import dataclass
from functools import cache

import numpy as np
import numpy.typing as npt

from harness.figures import Figures, once

SHARES = (0.50, 0.90, 0.99)
Array = npt.NDArray[np.float64]
Flags = npt.NDArray[np.bool_]


@dataclass(frozen=True, slots=True, eq=False)
class Errors:
    """Errors with the covariances that were stated for them.

    Attributes
    ----------
    off
        Each error, (error, axis), in any unit.
    cov
        Its covariance, in the square of that unit, (error, axis, axis).
    """

    off: Array
    cov: Array

    @property
    def squared(self) -> Array:
        """Squared Mahalanobis distances, (error,)."""
        solved = np.linalg.solve(self.cov, self.off[..., None])[..., 0]
        out: Array = np.einsum("ij,ij->i", self.off, solved)
        return out

    @property
    def sigma(self) -> Array:
        """Root of the mean variance over the axes, (error,)."""
        out: Array = np.sqrt(np.trace(self.cov, axis1=1, axis2=2) / self.cov.shape[1])
        return out

    @property
    def norm(self) -> Array:
        """Lengths of the errors, (error,)."""
        out: Array = np.linalg.norm(self.off, axis=1)
        return out

    def of(self, chosen: Flags) -> "Errors":
        """Return some of them."""
        return Errors(self.off[chosen], self.cov[chosen])


def joined(parts: list[Errors]) -> Errors:
    """Return several as one."""
    return Errors(
        np.concatenate([part.off for part in parts]), np.concatenate([part.cov for part in parts])
    )


@cache
def limit(share: float, axes: int) -> float:
    """Return the squared distance within which a share of a Gaussian lies.

    Examples
    --------
    >>> [round(limit(0.9, axes), 2) for axes in (2, 3)]
    [4.61, 6.25]
    """
    from scipy.special import chdtri

    return float(chdtri(axes, 1.0 - share))


def inside(errors: Errors, share: float) -> float:
    """Return the share of the errors inside the region that is to hold a given share [%]."""
    return 100 * float((errors.squared <= limit(share, errors.off.shape[1])).mean())


def widest(cov: Array, share: float = 0.90) -> Array:
    """Return the longest half-axis of each region that is to hold a share, in the unit of the root.

    Parameters
    ----------
    cov
        Covariances, (..., axis, axis).
    share
        What the region is to hold.
    """
    out: Array = np.sqrt(limit(share, cov.shape[-1]) * np.linalg.eigvalsh(cov)[..., -1])
    return out


def likelihood(errors: Errors) -> float:
    """Return the mean negative log-likelihood of the errors per axis, as Gaussians [nats].

    It is least where regions are both true and small; a sigma twice too large costs about 0.3, one
    twice too small about 0.8.
    """
    axes = errors.off.shape[1]
    _, log_det = np.linalg.slogdet(2 * np.pi * errors.cov)
    return float((errors.squared + log_det).mean() / (2 * axes))


def figures(errors: Errors, unit: str = "cm") -> Figures:
    """Return coverage and sharpness as figures, the errors being in `unit`."""
    if not len(errors.off):
        return {}
    return {
        **{
            f"in {100 * share:.0f} % regions": once(
                inside(errors, share), "%", "higher", matters=1.0, watched=False
            )
            for share in SHARES
        },
        "negative log-likelihood per axis": once(likelihood(errors), "nats", matters=0.05),
        "median sigma": once(float(np.median(errors.sigma)), unit, watched=False),
        "median error": once(float(np.median(errors.norm)), unit),
        "errors": once(len(errors.off), "", watched=False),
    }
