"""Trajectories as the indoor competitions EvAAL and IPIN have them; part by part as ``formats``."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from itertools import repeat

from app.trajectories.trajectory import Array, Trajectory

LOG_LINE = "%.6f,%.6f,%.6f,%d\n"
POSI_LINE = "POSI;%.6f;%d;%.9f;%.9f;%d;%d\n"
GROUND, BUILDING = 0, 0  # where no storey is told; a site is one building


def position_log_text(parts: Iterable[Trajectory]) -> Iterator[str]:
    """Lines ``timestamp,x,y,floor``: what a competitor hands in, in metres of the site.

    Notes
    -----
    Potortì et al., The IPIN 2019 Indoor Localisation Competition, IEEE Access 8, 2020. Storeys that are not told are 0.
    """
    for part in parts:
        rows = zip(part.times_s.tolist(), *part.positions_m[:, :2].T.tolist(), _floors(part), strict=True)
        yield "".join(LOG_LINE % row for row in rows)


def posi_text(parts: Iterable[Trajectory], geodetic: Callable[[Array], Array]) -> Iterator[str]:
    """Lines ``POSI;timestamp;counter;latitude;longitude;floor;building``: an IPIN log's true positions.

    Parameters
    ----------
    parts : iterable of Trajectory
    geodetic : callable
        Takes positions of shape (N, 3) of the site frame to longitude (deg), latitude (deg) and height (m).
    """
    counter = 0
    for part in parts:
        longitudes_deg, latitudes_deg, _ = geodetic(part.positions_m).T.tolist()
        numbers = range(counter + 1, counter + 1 + len(part))
        rows = zip(part.times_s.tolist(), numbers, latitudes_deg, longitudes_deg, _floors(part), strict=True)
        yield "".join(POSI_LINE % (*row, BUILDING) for row in rows)
        counter += len(part)


def _floors(part: Trajectory) -> Iterable[int]:
    return repeat(GROUND, len(part)) if part.floors is None else part.floors.tolist()
