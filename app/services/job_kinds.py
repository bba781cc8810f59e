"""The kinds of background work, and which photographs with which settings each kind reads."""

from __future__ import annotations

from app.services.build_options import BuildOptions
from app.storage.jobs import Job

BUILD = "build"  # photographs of a survey to a target map
CALIBRATE = "calibrate"  # photographs of a mapped site to a camera


def reading_options(job: Job) -> BuildOptions:
    """How a job reads its photographs: as a build was asked to, or as any."""
    return BuildOptions.from_json(job.options) if job.kind == BUILD else BuildOptions()
