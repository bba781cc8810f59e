"""One tree of exceptions. Each says what happened and what to do; statuses stand in one table in ``app/api``."""

from __future__ import annotations

from typing import Any


class ScattermarkError(Exception):
    """Base of all errors raised on purpose.

    Attributes
    ----------
    slug : str
        Stable name of the kind of problem; clients may branch on it.
    detail : str
        What happened and what to do about it, for a person.
    fields : dict
        Machine-readable facts that belong to the problem (JSON-ready).
    """

    slug = "error"

    def __init__(self, detail: str, **fields: Any) -> None:
        super().__init__(detail)
        self.detail = detail
        self.fields = fields

    def __reduce__(self) -> tuple[Any, ...]:
        # Errors cross process borders (worker pool); the default would lose the fields.
        return _rebuild, (type(self), self.detail, self.fields)


def _rebuild(kind: type[ScattermarkError], detail: str, fields: dict[str, Any]) -> ScattermarkError:
    return kind(detail, **fields)


class InvalidInput(ScattermarkError):
    """The caller sent something that cannot be right."""

    slug = "invalid-input"


class InvalidControlPoints(InvalidInput):
    """Control points that cannot be used: too few, in one line, duplicated, malformed, or contradicting each other."""

    slug = "invalid-control-points"


class BadPhoto(InvalidInput):
    """Bytes that are no readable photograph: not an image, truncated, empty."""

    slug = "bad-photo"


class UnsupportedPhoto(InvalidInput):
    """An image of a format or pixel type that is not measured."""

    slug = "unsupported-photo"


class PhotoTooLarge(InvalidInput):
    """An image with more bytes or pixels than the limits allow."""

    slug = "photo-too-large"


class NotAuthenticated(ScattermarkError):
    """A request without a key that is valid."""

    slug = "not-authenticated"


class NotAllowed(ScattermarkError):
    """A key that is valid and may not do this."""

    slug = "not-allowed"


class TooManyRequests(ScattermarkError):
    """A key that asks more often than its rate; ``fields['retry_after_s']`` says when to come back."""

    slug = "too-many-requests"


class NotFound(ScattermarkError):
    """A thing that was asked for does not exist."""

    slug = "not-found"


class Conflict(ScattermarkError):
    """The request contradicts what is stored."""

    slug = "conflict"


class DegenerateGeometry(ScattermarkError):
    """Observations that do not fix what was asked of them."""

    slug = "degenerate-geometry"


class SurveyFailed(ScattermarkError):
    """A survey that cannot be adjusted into a target map; ``fields['reason']`` is a stable slug."""

    slug = "survey-failed"


class CalibrationFailed(ScattermarkError):
    """Photographs that do not calibrate their camera; ``fields['reason']`` is a stable slug."""

    slug = "calibration-failed"


class NotLocated(ScattermarkError):
    """A snapshot without a trustworthy pose.

    ``fields['reason']`` is one of ``no-targets``, ``unknown-targets``, ``too-few-dots``, ``ambiguous``,
    ``unknown-camera``, ``inconsistent``, ``outside-site``; ``fields['advice']`` says what the user can do.
    """

    slug = "not-located"


class Cancelled(ScattermarkError):
    """Work that was stopped on request."""

    slug = "cancelled"


class ServerFull(ScattermarkError):
    """All workers are busy and the queue is full; ``fields['retry_after_s']`` says when to come back."""

    slug = "server-full"


class FrameDropped(ScattermarkError):
    """A frame of a stream that was not looked at: a newer one came first."""

    slug = "frame-dropped"


class TimedOut(ScattermarkError):
    """Work that outlasted its time limit."""

    slug = "timed-out"


class SheetUnreadable(ScattermarkError):
    """A sheet of targets that did not read back as what it should show; it is not delivered."""

    slug = "sheet-unreadable"


class WorkerCrashed(ScattermarkError):
    """A worker process died while it did this piece of work."""

    slug = "worker-crashed"


class OutOfMemory(ScattermarkError):
    """A worker process had no memory left for this piece of work."""

    slug = "out-of-memory"


class StorageUnavailable(ScattermarkError):
    """The database or the store of photographs gives no answer."""

    slug = "storage-unavailable"


class OutOfSpace(ScattermarkError):
    """There is no room left for what should be written: the disk is full, or the quota is reached."""

    slug = "insufficient-storage"
