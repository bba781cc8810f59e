"""Which snapshots are kept as evidence of the map: a phone that stands still says the same thing many times."""

from __future__ import annotations

from collections import OrderedDict
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from app.storage.snapshots import Heading, Located, NotFoundPose

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class SieveOptions:
    """When a snapshot says something new.

    Attributes
    ----------
    moved_m : float
        Its camera stands so far from where the device's last evidence was taken: less than half of a place, as the
        watch over the map counts them.
    passed_s : float
        Or so much later: what stood then may have been moved since.
    devices : int
        Devices that are remembered, those heard of last.
    """

    moved_m: float = 0.1
    passed_s: float = 30.0
    devices: int = 10_000


class EvidenceSieve:
    """Remembers where and when each device's last evidence was taken; for one event loop."""

    def __init__(self, options: SieveOptions | None = None) -> None:
        self._options = options or SieveOptions()
        self._last: OrderedDict[tuple[str, int, str | None], tuple[Array, float]] = OrderedDict()

    def passes(self, heading: Heading, outcome: Located | NotFoundPose) -> bool:
        """Whether a snapshot is to be kept as evidence."""
        if isinstance(outcome, NotFoundPose):
            return False
        key = heading.site_id, heading.map_version, heading.device_id
        position_m, captured_s = outcome.site_from_cam.position_m, heading.moment.captured_s
        last = self._last.get(key)
        if last is not None and self._is_same(last, position_m, captured_s):
            return False
        self._last[key] = position_m, captured_s
        self._last.move_to_end(key)
        while len(self._last) > self._options.devices:
            self._last.popitem(last=False)
        return True

    def _is_same(self, last: tuple[Array, float], position_m: Array, captured_s: float) -> bool:
        near = float(np.linalg.norm(position_m - last[0])) < self._options.moved_m
        return near and abs(captured_s - last[1]) < self._options.passed_s
