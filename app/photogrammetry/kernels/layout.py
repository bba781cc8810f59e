"""Columns of a target's equations."""

from __future__ import annotations

OWN, INTRINSICS = 6, 9
COLUMNS = OWN + INTRINSICS + 1  # a target's own movement (later the pose), the camera, and last the residual
