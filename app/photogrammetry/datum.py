"""The datum of a map without control points: size from the print, upright from the plates, the rest by convention."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from app.geometry.similarity import Similarity
from app.geometry.target_map import Datum
from app.photogrammetry.network import Network

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]

# Plates whose planes share an axis to this share of the scatter of their normals: walls of at least two directions.
# Plates on one wall share two axes, and their own upright edges must tell which is z.
LEAST_NORMAL_SCATTER = 0.05


@dataclass(frozen=True)
class AssumedDatum:
    """Where a free network is put when nothing fixes it.

    Attributes
    ----------
    site_from_model : Similarity
        Scale 1, origin in the middle of the targets, z upwards, x along the main normal of the plates.
    tilt_sigma_rad : float
        How well the plates agree on the upright axis.
    from_edges : bool
        Whether the plates' own upright edges had to decide, because all plates lie in parallel planes.
    """

    site_from_model: Similarity
    tilt_sigma_rad: float
    from_edges: bool


def assume_datum(network: Network, defining: Mask) -> AssumedDatum:
    """Put z along the axis most nearly in all plates' planes, up as most plates stand; mask of shape (T,)."""
    rotations, centres_m = network.target_rotations[defining], network.target_positions_m[defining]
    normals, edges = rotations[..., 2], rotations[..., 1].mean(axis=0)
    scatter, axes = np.linalg.eigh(normals.T @ normals / len(normals))  # ascending: the upright axis first
    from_edges = bool(scatter[1] < LEAST_NORMAL_SCATTER)
    up = axes[:, 0]
    if from_edges:
        up = edges - (edges @ axes[:, 2]) * axes[:, 2]
        up /= np.linalg.norm(up)
    up = up * (1.0 if up @ edges >= 0 else -1.0)
    ahead = axes[:, 2] - (axes[:, 2] @ up) * up
    ahead /= np.linalg.norm(ahead)
    rotation = np.stack([ahead, np.cross(up, ahead), up])
    tilt = float(np.sqrt(np.mean((normals @ up) ** 2) / len(normals)))
    return AssumedDatum(Similarity(1.0, rotation, -rotation @ centres_m.mean(axis=0)), tilt, from_edges)


def assumed_covariance(datum: Datum, tilt_sigma_rad: float, print_sigma: float) -> Datum:
    """The datum of an assumed map: origin and azimuth are exact by convention, scale and upright are not.

    ``print_sigma`` is relative, of a length in either direction; a plate's printed length is the mean of both.
    """
    scale_variance = datum.covariance[6, 6] + print_sigma**2 / 2.0
    covariance = np.diag([0.0, 0.0, 0.0, tilt_sigma_rad**2, tilt_sigma_rad**2, 0.0, scale_variance])
    return replace(datum, covariance=covariance, assumed_scale=True, assumed_orientation=True)
