"""How a worker process begins: its workbench set up, everything imported, one plate read, so that no request pays."""

from __future__ import annotations

import gc

import numpy as np

from app.services import adjust_work, locate_work, report_work  # noqa: F401 - their imports are the larger part of a first request
from app.services.read_ahead import ReadAhead
from app.services.workbench import open_workbench, workbench
from app.targets.drawing import plate_rgb
from app.targets.family import family_by_name
from app.vision.detector import detect

WARM_UP_CODE = 389  # any; detection runs through all its stages on a plate, and through few on a blank picture
WARM_UP_PX_PER_U = 6
WARM_UP_BORDER_PX = 60
WARM_UP_GREY = 128


def start_worker(database_url: str, photographs_url: str) -> None:
    """Initializer of every worker that builds."""
    open_workbench(database_url, photographs_url)
    plate = plate_rgb(WARM_UP_CODE, WARM_UP_PX_PER_U)
    border = ((WARM_UP_BORDER_PX, WARM_UP_BORDER_PX), (WARM_UP_BORDER_PX, WARM_UP_BORDER_PX), (0, 0))
    picture = np.pad(plate, border, constant_values=WARM_UP_GREY)
    detect(np.ascontiguousarray(picture[..., ::-1]), family_by_name("full"))


def start_locating(database_url: str, photographs_url: str) -> None:
    """Initializer of every worker that locates: the maps that snapshots may need are read already."""
    start_worker(database_url, photographs_url)
    ReadAhead(workbench()).start()
    gc.collect()
    gc.freeze()  # what is there now stays: no later collection walks through it, which takes tens of milliseconds
