"""The tables: every module of them is imported here, so that migrations and backups see them all."""

from __future__ import annotations

from app.storage.models.access import AuditRow, BrowserSessionRow, KeyRow
from app.storage.models.alerts import AlertRow, EvidenceRow
from app.storage.models.base import Base
from app.storage.models.evaluations import (
    EvaluatedPosesRow,
    EvaluatedSystemRow,
    EvaluationRow,
    ImportedPosesRow,
    LiveEvaluationRow,
    LiveSampleRow,
)
from app.storage.models.jobs import JobRow, WorkerRow
from app.storage.models.kept_snapshots import KeptSnapshotRow
from app.storage.models.sites import ControlPointRow, PrintBatchRow, SiteRow
from app.storage.models.surveys import DetectionRow, PhotographRow, PhotoMarkRow, SurveyRow
from app.storage.models.target_maps import CameraRow, MappedTargetRow, MapPhotoRow, TargetMapRow
from app.storage.models.trajectories import SnapshotRow, TrajectoryRow

__all__ = [
    "AlertRow",
    "AuditRow",
    "Base",
    "BrowserSessionRow",
    "CameraRow",
    "ControlPointRow",
    "DetectionRow",
    "EvaluatedPosesRow",
    "EvaluatedSystemRow",
    "EvaluationRow",
    "EvidenceRow",
    "ImportedPosesRow",
    "JobRow",
    "KeptSnapshotRow",
    "KeyRow",
    "LiveEvaluationRow",
    "LiveSampleRow",
    "MapPhotoRow",
    "MappedTargetRow",
    "PhotoMarkRow",
    "PhotographRow",
    "PrintBatchRow",
    "SiteRow",
    "SnapshotRow",
    "SurveyRow",
    "TargetMapRow",
    "TrajectoryRow",
    "WorkerRow",
]
