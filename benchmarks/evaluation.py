"""What imports and evaluations cost: ``python -m benchmarks.evaluation [POSES ...]``, processor seconds."""

from __future__ import annotations

import resource
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from app.services.evaluate_work import EvaluationWish, make_evaluation
from app.services.evaluation_report_work import tell_evaluation
from app.services.trajectory_import_work import ImportTask, ImportWish, import_trajectory
from app.services.workbench import open_workbench, workbench
from app.storage.database import Database
from app.storage.migrate import upgrade
from app.storage.pose_reading import all_poses
from app.storage.sites import SiteRepository
from app.trajectories.evaluation import EvaluationOptions
from app.trajectories.robotics_formats import tum_text
from app.trajectories.trajectory import Trajectory

START_S, RATE_HZ = 1_760_000_000.0, 10.0
NOISE_M = 0.05
KIB_PER_MIB = 1024
USUAL = (1_000, 100_000, 1_000_000)  # poses


def walk(count: int, noise_m: float) -> Trajectory:
    """A figure of eight that turns as it goes."""
    t = np.arange(count) / RATE_HZ
    course_m = np.column_stack([4.0 * np.sin(0.31 * t), 2.0 * np.sin(0.62 * t), 1.5 + 0.2 * np.sin(0.17 * t)])
    noise = np.random.default_rng(1).normal(0.0, noise_m, course_m.shape)
    return Trajectory(START_S + t, course_m + noise, Rotation.from_euler("z", 0.4 * t[:, None]).as_quat(canonical=True))


def timed(name: str, work: Callable[[], str]) -> str:
    """Do a piece of work and say what it cost."""
    before_s = time.process_time()
    result = work()
    print(f"  {name:28} {time.process_time() - before_s:8.2f} s")
    return result


def hall(folder: Path) -> tuple[Database, str]:
    """A new database on SQLite with a workbench on it, and its only site."""
    url = f"sqlite:///{folder / 'benchmark.db'}"
    database = Database(url)
    upgrade(database)
    with database.writing() as session:
        site_id = SiteRepository(session).add("hall", "golay", 0.014, None).site_id
    open_workbench(url, str(folder / "photographs"))
    return database, site_id


def peak_memory_mib() -> int:
    """The most memory that this process held until now."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss // KIB_PER_MIB


def each_in_a_folder(measure: Callable[[int, Path], None], usual: Sequence[int]) -> None:
    """Measure for each count that the command line names, or for the usual ones."""
    for count in [int(text) for text in sys.argv[1:]] or usual:
        with tempfile.TemporaryDirectory() as scratch:
            measure(count, Path(scratch))


def measure(count: int, folder: Path) -> None:
    """Import two walks and compare them, on SQLite."""
    database, site_id = hall(folder)
    print(f"{count} poses")
    ids = [imported(folder, site_id, walk(count, noise_m)) for noise_m in (0.0, NOISE_M)]
    timed("read", lambda: read(ids[0]))
    wish = EvaluationWish(ids[0], (ids[1],), EvaluationOptions())
    evaluation_id = timed("compare and keep", lambda: make_evaluation(wish, None).evaluation_id)
    timed("tell", lambda: tell_evaluation(evaluation_id).stored.title)
    print(f"  most memory until now        {peak_memory_mib():8d} MiB")
    database.close()


def imported(folder: Path, site_id: str, trajectory: Trajectory) -> str:
    """A trajectory sent as TUM."""
    file = folder / "walk.tum"
    with file.open("w") as out:
        out.writelines(tum_text([trajectory]))
    task = ImportTask(ImportWish(site_id), file, None, None)
    return timed("import as TUM", lambda: import_trajectory(task).trajectory_id)


def read(trajectory_id: str) -> str:
    """All poses, as an evaluation reads them."""
    with workbench().database.reading() as session:
        return str(len(all_poses(session, trajectory_id)))


if __name__ == "__main__":
    each_in_a_folder(measure, USUAL)
