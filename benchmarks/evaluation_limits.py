"""A file with too many poses, ``python -m benchmarks.evaluation_limits [ROWS]``: what is said, kept, held in memory."""

from __future__ import annotations

import time
from collections.abc import Iterator
from pathlib import Path

from sqlalchemy import func, select

from app.services.trajectory_import_work import ImportTask, ImportWish, import_trajectory
from app.storage.models import ImportedPosesRow, TrajectoryRow
from app.trajectories.reading.table import UnreadableTrajectory
from benchmarks.evaluation import RATE_HZ, START_S, each_in_a_folder, hall, peak_memory_mib

ROWS = 10_000_000
LINES_AT_A_TIME = 100_000


def lines(count: int) -> Iterator[str]:
    """A CSV file of a device that stands still."""
    yield "time_s,x_m,y_m,z_m\n"
    for first in range(0, count, LINES_AT_A_TIME):
        numbers = range(first, min(first + LINES_AT_A_TIME, count))
        yield "".join(f"{START_S + number / RATE_HZ:.3f},1.0000,2.0000,1.5000\n" for number in numbers)


def measure(count: int, folder: Path) -> None:
    """Send one file and say what came of it."""
    database, site_id = hall(folder)
    file = folder / "walk.csv"
    with file.open("w") as out:
        out.writelines(lines(count))
    before_s = time.process_time()
    try:
        said = f"{import_trajectory(ImportTask(ImportWish(site_id), file, None, None)).pose_count} poses are kept"
    except UnreadableTrajectory as refusal:
        said = f"refused: {refusal.detail}"
    taken_s = time.process_time() - before_s
    with database.reading() as session:
        kept = [session.scalar(select(func.count()).select_from(row)) for row in (TrajectoryRow, ImportedPosesRow)]
    print(f"{count} rows, {file.stat().st_size >> 20} MiB: {said}")
    print(f"  {taken_s:.2f} s, most memory {peak_memory_mib()} MiB, trajectories {kept[0]}, rows of poses {kept[1]}")
    database.close()


if __name__ == "__main__":
    each_in_a_folder(measure, (ROWS,))
