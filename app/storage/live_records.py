"""Live evaluations as values: what is compared, what was sent, what came of it."""

from __future__ import annotations

from dataclasses import dataclass

from app.trajectories.alignment import AlignmentKind


@dataclass(frozen=True)
class LiveOptions:
    """How samples are compared with a reference that still grows.

    Attributes
    ----------
    max_gap_s : float
        Largest distance of the two reference poses around a sample.
    time_offset_s : float
        The reference's clock less the samples'.
    lever_arm_m : tuple of float or None
        From the reference's camera to the point that the system locates, in the camera's frame.
    floor_height_m : float or None
        Of a storey, where storeys are told by height.
    alignment : {"none", "posyaw", "se3", "sim3", "first_n"}
        Into the reference's frame, of all pairs so far.
    first_n : int
        Pairs of ``first_n``.
    """

    max_gap_s: float = 1.0
    time_offset_s: float = 0.0
    lever_arm_m: tuple[float, float, float] | None = None
    floor_height_m: float | None = None
    alignment: AlignmentKind = "none"
    first_n: int = 10


@dataclass(frozen=True)
class Sample:
    """A position that a running system tells.

    Attributes
    ----------
    time_s : float
        UTC seconds since 1970.
    z_m : float or None
        None for a system that tells the plan alone.
    arrived_s : float or None
        When the server had it, by its own clock; None for those of older versions.
    """

    time_s: float
    x_m: float
    y_m: float
    z_m: float | None = None
    floor: int | None = None
    orientation_xyzw: tuple[float, float, float, float] | None = None
    arrived_s: float | None = None


@dataclass(frozen=True)
class LivePair:
    """A sample beside the reference.

    Attributes
    ----------
    position_m : tuple of float or None
        As the system told it, x, y, z.
    error_m : tuple of float or None
        Estimate less reference, x, y, z; no z for a sample that has none.
    angle_rad : float or None
        Between the orientations, when both are known.
    reference_sigma_m : float or None
        Largest of the reference's three standard deviations.
    right_floor : bool or None
    arrived_s : float or None
        As the sample's.
    """

    time_s: float
    position_m: tuple[float, float, float | None]
    error_m: tuple[float, float, float | None]
    angle_rad: float | None = None
    reference_sigma_m: float | None = None
    right_floor: bool | None = None
    arrived_s: float | None = None


@dataclass(frozen=True)
class LiveEvaluation:
    """A live evaluation as it stands.

    Attributes
    ----------
    sample_count, pair_count, missed_count : int
        Samples that came; those that were paired; those that the reference passed by without a pose near enough.
    seen_ordinal : int
        Of the reference's snapshots, those that waiting samples were compared with.
    """

    live_id: str
    site_id: str
    reference_id: str
    name: str
    options: LiveOptions
    created_s: float
    closed_s: float | None
    sample_count: int
    pair_count: int
    missed_count: int
    seen_ordinal: int

    @property
    def waiting_count(self) -> int:
        """Samples that wait for a later pose of the reference."""
        return self.sample_count - self.pair_count - self.missed_count
