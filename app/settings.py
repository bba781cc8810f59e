"""Deployment values, read once from the environment; tuning constants of algorithms live beside the algorithms."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Any

from app.errors import InvalidInput

PREFIX = "SCATTERMARK_"
MEBIBYTE = 2**20
MAY_BE_ZERO = ("address_rate_per_s", "queue_depth", "quota_bytes", "min_free_bytes", "drain_s", "worker_metrics_port")


def _cores() -> int:
    return max(1, os.cpu_count() or 1)


@dataclass(frozen=True)
class Settings:
    """What differs from one installation to the next. Each field is set by ``SCATTERMARK_<FIELD>``.

    Attributes
    ----------
    data_dir : Path
        Folder of photographs and, by default, of the SQLite database.
    database_url : str
        SQLAlchemy URL; empty for ``scattermark.db`` in ``data_dir``.
    photographs_url : str
        Where photographs lie: empty for ``photographs`` in ``data_dir``, a folder, or an object store such as
        ``s3://bucket/prefix?region=...`` with its credentials in the environment.
    quota_bytes : int
        All photographs together; 0 for no limit.
    min_free_bytes : int
        Room on the disk that uploads leave to the database and to everybody else.
    locate_workers, build_workers : int
        Worker processes for snapshots and for builds; one per core each, as builds are rare.
    queue_depth : int
        Snapshots that may wait while all workers are busy; the next one is told to come back.
    locate_timeout_s, detect_timeout_s, adjust_timeout_s, report_timeout_s : float
        Time limits of one snapshot, one survey photograph, one adjustment and one report.
    evaluate_timeout_s : float
        Time limit of one import of a trajectory, one evaluation and one smoothing.
    max_photo_bytes, max_photo_pixels : int
        Largest photograph.
    max_upload_bytes : int
        Largest request that carries many photographs.
    max_import_bytes : int
        Largest archive of a site.
    max_trajectory_bytes : int
        Largest file of a trajectory.
    max_text_bytes : int
        Largest request of any other kind (JSON, CSV).
    upload_grace_s : float
        Time that a request's body may take however slowly it comes; each byte that has come extends it.
    max_slow_uploads : int
        Bodies that may be slow at a time.
    drain_s : float
        How long a server that was told to stop says so at ``/readyz`` and still takes requests: time for a load
        balancer to notice.
    finish_s : int
        How long it then waits for requests in flight: they take tens of milliseconds, an upload some seconds.
    worker_metrics_port : int
        Where a worker tells Prometheus about its builds; 0 for nowhere.
    log_format, log_level : str
        ``json`` or ``console``, empty for whichever suits standard error; ``debug`` to ``error``.
    require_keys, insecure : bool
        Ask for a key also on this machine's own address; ask for none on any other.
    bootstrap_key : str
        Secret of the first key with the scope ``admin``; without effect once there was one.
    allowed_hosts, cors_origins : str
        Names that the service is called by beside this machine's, and origins whose pages may use it; by commas.
    session_hours : float
        How long a browser's session lasts.
    key_rate_per_s, key_burst : float, int
        Requests a second of a key that names no rate of its own, and how many may come at once.
    address_rate_per_s : int
        Requests a second of each address that asks without a key; 0 for no limit.
    audit_days : float
        How long the audit is kept.
    """

    data_dir: Path = Path("scattermark-data")
    database_url: str = ""
    photographs_url: str = ""
    quota_bytes: int = 0
    min_free_bytes: int = 256 * MEBIBYTE
    locate_workers: int = field(default_factory=_cores)
    build_workers: int = field(default_factory=_cores)
    queue_depth: int = 8
    locate_timeout_s: float = 10.0
    detect_timeout_s: float = 60.0
    adjust_timeout_s: float = 3600.0
    report_timeout_s: float = 120.0
    evaluate_timeout_s: float = 300.0
    max_photo_bytes: int = 64 * MEBIBYTE
    max_photo_pixels: int = 64_000_000
    max_upload_bytes: int = 1024 * MEBIBYTE
    max_import_bytes: int = 4096 * MEBIBYTE
    max_trajectory_bytes: int = 512 * MEBIBYTE
    max_text_bytes: int = 8 * MEBIBYTE
    upload_grace_s: float = 20.0
    max_slow_uploads: int = 128
    drain_s: float = 0.0
    finish_s: int = 7
    worker_metrics_port: int = 0
    log_format: str = ""
    log_level: str = "info"
    require_keys: bool = False
    insecure: bool = False
    bootstrap_key: str = field(default="", repr=False)
    allowed_hosts: str = ""
    cors_origins: str = ""
    session_hours: float = 12.0
    key_rate_per_s: float = 100.0
    key_burst: int = 200
    address_rate_per_s: int = 0
    audit_days: float = 365.0

    def __post_init__(self) -> None:
        for entry in fields(self):
            value = getattr(self, entry.name)
            least = 0 if entry.name in MAY_BE_ZERO else 1
            if isinstance(value, int) and not isinstance(value, bool) and value < least:
                raise InvalidInput(f"{PREFIX}{entry.name.upper()} must be at least {least}, got {value}")
            if isinstance(value, float) and not (value > 0 or value == least):
                raise InvalidInput(f"{PREFIX}{entry.name.upper()} must be positive, got {value}")

    @property
    def host_names(self) -> tuple[str, ...]:
        """What the service is called beside this machine's names."""
        return _words(self.allowed_hosts.lower())

    @property
    def page_origins(self) -> tuple[str, ...]:
        """Origins whose pages may use the service."""
        return _words(self.cors_origins)

    @property
    def sqlalchemy_url(self) -> str:
        """Where the database is."""
        return self.database_url or f"sqlite:///{self.data_dir.resolve() / 'scattermark.db'}"

    @property
    def engine_url(self) -> str:
        """Where the job engine keeps its tables: beside an SQLite database in a file of its own, else in the same one.

        The engine writes at each step of a build, and a file has one writer at a time.
        """
        if not self.embedded:
            return self.sqlalchemy_url
        return self.sqlalchemy_url.removesuffix(".db") + "-jobs.db"

    @property
    def embedded(self) -> bool:
        """Whether the database is the file that this process looks after by itself, migrations included."""
        return self.sqlalchemy_url.startswith("sqlite")

    @property
    def photographs_dir(self) -> Path:
        """Folder of the photographs, unless a URL says otherwise."""
        return self.data_dir / "photographs"

    @property
    def photographs_location(self) -> str:
        """Where the photographs lie, for ``open_photo_store``; the same whatever process asks."""
        return self.photographs_url or str(self.photographs_dir.resolve())


def settings_from_environment(environment: Mapping[str, str] | None = None) -> Settings:
    """Settings of ``SCATTERMARK_...`` variables; what is not set keeps its default.

    Raises
    ------
    InvalidInput
        For a value that is no number where one is needed, or out of range.
    """
    environment = os.environ if environment is None else environment
    given: dict[str, Any] = {}
    for entry in fields(Settings):
        text = environment.get(PREFIX + entry.name.upper(), "")
        if text:
            given[entry.name] = _parsed(entry.name, str(entry.type), text)
    return Settings(**given)


def _words(text: str) -> tuple[str, ...]:
    return tuple(word.strip() for word in text.split(",") if word.strip())


KINDS = {"int": "whole number", "float": "number", "bool": "true or false", "Path": "path", "str": "text"}


def _truth_of(text: str) -> bool:
    truths = {"1": True, "true": True, "yes": True, "on": True, "0": False, "false": False, "no": False, "off": False}
    if text.lower() not in truths:
        raise ValueError(text)
    return truths[text.lower()]


def _parsed(name: str, kind: str, text: str) -> Any:
    parsers: dict[str, Callable[[str], Any]] = {
        "Path": Path, "int": int, "float": float, "str": str, "bool": _truth_of,
    }  # fmt: skip
    try:
        return parsers[kind](text)
    except ValueError as error:
        raise InvalidInput(f"{PREFIX}{name.upper()}={text!r} is no {KINDS[kind]}; correct or unset it") from error
