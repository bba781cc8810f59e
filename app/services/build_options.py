"""What can be asked of a build, as it travels from the request through the job's row to the worker."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any, Literal, get_args

from app.geometry.control import ControlPoint
from app.vision.detectors import DetectorName

Strictness = Literal["strict", "normal", "eager"]
STRICTNESSES: tuple[Strictness, ...] = get_args(Strictness)


@dataclass(frozen=True)
class Exclusion:
    """What a build shall leave out: photographs by name, targets by code, control and check points by name."""

    images: tuple[str, ...] = ()
    codes: tuple[int, ...] = ()
    control_points: tuple[str, ...] = ()

    def points_left(self, points: tuple[ControlPoint, ...]) -> tuple[ControlPoint, ...]:
        """Control and check points that are used."""
        return tuple(
            point for point in points if point.name not in self.control_points and point.code not in self.codes
        )


@dataclass(frozen=True)
class BuildOptions:
    """Options of one build.

    Attributes
    ----------
    exclude : Exclusion
    strictness : str
        How much evidence a target needs to be believed.
    activate : bool
        Whether snapshots are located in the new map at once.
    base_version : int or None
        The map that is extended; its datum stands.
    detector : str
        Who reads the photographs. The published method is a baseline for comparisons: requests do not name it.
    """

    exclude: Exclusion = Exclusion()
    strictness: Strictness = "normal"
    activate: bool = True
    base_version: int | None = None
    detector: DetectorName = "default"

    def to_json(self) -> dict[str, Any]:
        """A record for the job's row."""
        return asdict(self)

    @classmethod
    def from_json(cls, record: dict[str, Any]) -> BuildOptions:
        """The options that ``to_json`` wrote."""
        exclude = {name: tuple(values) for name, values in record["exclude"].items()}
        return cls(**{**record, "exclude": Exclusion(**exclude)})
