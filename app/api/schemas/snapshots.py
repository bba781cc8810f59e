"""Snapshots that are removed."""

from __future__ import annotations

from pydantic import BaseModel


class SnapshotsRemoved(BaseModel):
    """How many snapshots were removed."""

    removed: int
