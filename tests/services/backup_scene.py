"""An installation with something in every table, and what two installations must have in common after a restore."""

from __future__ import annotations

import hashlib
import io
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image
from sqlalchemy import select, update

from app.geometry.control import ControlPoint
from app.geometry.marks import Mark
from app.geometry.print_batch import PrintBatch
from app.storage.archive_schema import current_revision, kept_tables, tables_at
from app.storage.database import Database, Session
from app.storage.evaluation_records import EvaluatedSystem, NewEvaluation
from app.storage.evaluations import EvaluationRepository
from app.storage.imported_trajectories import ImportedTrajectories, NewImport
from app.storage.jobs import JobRepository
from app.storage.live_evaluations import LiveEvaluationRepository
from app.storage.live_records import LiveOptions, Sample
from app.storage.marks import MarkRepository
from app.storage.models import JobRow
from app.storage.photo_store import PhotoStore, open_photo_store
from app.storage.print_batches import PrintBatchRepository
from app.storage.records import GeoAnchor
from app.storage.sites import SiteRepository
from app.storage.surveys import DetectionKey, DetectionRepository, SurveyRepository
from app.storage.target_maps import TargetMapRepository
from app.storage.trajectories import TrajectoryRepository
from app.storage.trajectory_parts import FileSource
from app.trajectories.evaluation import EvaluationOptions, evaluate
from app.trajectories.evaluation_options_record import record_of_options
from app.trajectories.evaluation_record import record_of_evaluation
from tests.storage.examples import REFUSED, detection, located, photo, publication, snapshot
from tests.trajectories.walks import START_S, noisy, walk

CODES = (389, 694, 889)  # of the site's family


def jpeg(seed: int) -> bytes:
    """A photograph of nothing, other for each seed."""
    pixels = np.random.default_rng(seed).integers(0, 255, (12, 16, 3), dtype=np.uint8)
    out = io.BytesIO()
    Image.fromarray(pixels).save(out, "JPEG")
    return out.getvalue()


PHOTOS = {f"IMG_{seed}.jpg": jpeg(seed) for seed in range(3)}


@dataclass(frozen=True)
class Scene:
    """An installation and what is in it."""

    database: Database
    photos: PhotoStore
    site_id: str
    survey_id: str
    job_id: str


def sha256_of(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()


def fill(database: Database, folder: Path) -> Scene:
    """A site with all that a site can have, and a build that is under way."""
    photos = open_photo_store(str(folder))
    for data in PHOTOS.values():
        photos.put(sha256_of(data), data)
    with database.writing() as session:
        site = SiteRepository(session).add("room", "golay", 0.0137, GeoAnchor(48.1, 11.5, 520.0, 12.5))
        survey_id = SurveyRepository(session).add(site.site_id, "first", "phone-1").survey_id
        for name, data in PHOTOS.items():
            SurveyRepository(session).add_photo(survey_id, photo(name, sha256_of(data)))
            DetectionRepository(session).put(DetectionKey(sha256_of(data), "default-1", "0" * 64), detection())
            MarkRepository(session).replace(survey_id, name, [Mark(CODES[0], 5, np.array([4.0, 5.5]))])
        jobs = JobRepository(session)
        done, under_way = (jobs.add("build", site.site_id, survey_id, {"strictness": "normal"}).job_id for _ in "12")
        ended = {"state": "succeeded", "stage": "done", "done": 3, "total": 3, "result": {"map_version": 1}}
        running = {"state": "running", "stage": "detect", "done": 2, "total": 3, "owner": "host-1", "started_s": 1.7e9}
        session.execute(update(JobRow).where(JobRow.id == done).values(**ended))
        session.execute(update(JobRow).where(JobRow.id == under_way).values(**running))
        TargetMapRepository(session).publish(site.site_id, publication(done, survey_id, CODES))
        TargetMapRepository(session).activate(site.site_id, 1)
        points = [ControlPoint(f"P{dot}", CODES[0], dot, np.array([1.0, 2.0, 3.0]), 0.001, "control") for dot in "ABC"]
        SiteRepository(session).replace_control_points(site.site_id, points)
        PrintBatchRepository(session).replace(site.site_id, (PrintBatch("floor 1", (389,), 99.0, 98.5, 0.2),))
        trajectories = TrajectoryRepository(session)
        default = trajectories.default(site.site_id, "phone-1").trajectory_id
        for outcome in (located(), REFUSED, located()):
            trajectories.record(default, snapshot(site, outcome))
        _compare(session, site.site_id, default)
    return Scene(database, photos, site.site_id, survey_id, under_way)


def _compare(session: Session, site_id: str, reference_id: str) -> None:
    """A trajectory that came as a file, an evaluation of it, and a live one with a sample."""
    source = FileSource("tum", "s", "the stamps count s since 1970", True, False, False)
    poses = walk(5.0)
    imported = ImportedTrajectories(session).add(NewImport(site_id, "uwb", "walk", source, poses))
    options = EvaluationOptions()
    evaluation = evaluate(poses, noisy(poses, 0.1), options)
    system = EvaluatedSystem(imported.trajectory_id, "walk", record_of_evaluation(evaluation))
    new = NewEvaluation(
        site_id, reference_id, "truth", "walk", record_of_options(options), [], (system,), (evaluation.pairs,)
    )
    EvaluationRepository(session).add(new)
    live = LiveEvaluationRepository(session).add(site_id, reference_id, "uwb", LiveOptions())
    LiveEvaluationRepository(session).add_samples(live.live_id, [Sample(START_S, 1.0, 2.0)])


def rows_of(database: Database) -> dict[str, list[tuple[Any, ...]]]:
    """All rows that a backup keeps, by table, in the order of their keys."""
    with database.reading() as session:
        tables = kept_tables(tables_at(current_revision(session.connection())))
        return {
            table.name: [tuple(row) for row in session.execute(select(table).order_by(*table.primary_key.columns))]
            for table in tables
        }
