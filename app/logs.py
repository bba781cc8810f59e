"""Logs: one line per event, JSON for machines or columns for people, with the ids that belong to it.

Code logs through the standard library (``logging.getLogger(__name__)``, facts as ``extra``), as uvicorn and the job
engine do; structlog renders all of it. Nothing is set up on import: a program calls ``configure_logs`` once.
"""

from __future__ import annotations

import logging
import re
import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TextIO

import structlog
from asgi_correlation_id import correlation_id
from structlog.typing import EventDict, WrappedLogger

from app.errors import InvalidInput

if TYPE_CHECKING:
    from structlog.typing import Processor

FORMATS = ("json", "console")
LEVELS = ("debug", "info", "warning", "error")
# Whose events are wanted from the chosen level on; all others speak up for warnings.
SPOKEN_FOR = ("app", "uvicorn")
# They may have got handlers of their own before: what they say goes the way of everything else.
TAKEN_OVER = ("uvicorn", "uvicorn.error", "uvicorn.access")
# The engine gives its logger a handler of its own unless it finds one.
WITH_OWN_HANDLER = ("dbos",)
# It warns of each request id that a client made up; whoever can send requests could fill the log.
TALKATIVE = ("asgi_correlation_id",)
NOT_FOR_LINES = ("color_message",)  # uvicorn's second copy of its message, with colours
MASK = "***"
# Few strings need a closer look.
SUSPECT = re.compile(r"(?i)bearer|sm[ks]_|[:=]")
# What must not be read in a log, wherever it comes from: keys and sessions, passwords in URLs, query strings.
SECRETS = (
    (re.compile(r"(?i)\b(bearer\s+)[^\s\"']+"), rf"\g<1>{MASK}"),
    (re.compile(r"\b(sm[ks]_)[\w-]+"), rf"\g<1>{MASK}"),
    (re.compile(r"(://[^/\s:@]*:)[^/\s@]+@"), rf"\g<1>{MASK}@"),
    (re.compile(r"(?i)\b((?:api_?key|key|token|password|secret)=)[^\s&\"']+"), rf"\g<1>{MASK}"),
)


@dataclass(frozen=True)
class LogOptions:
    """How a process logs.

    Attributes
    ----------
    format : str
        ``json`` or ``console``; empty for columns on a terminal and JSON anywhere else.
    level : str
        ``debug``, ``info``, ``warning`` or ``error``.

    Raises
    ------
    InvalidInput
        For any other.
    """

    format: str = ""
    level: str = "info"

    def __post_init__(self) -> None:
        if self.format and self.format not in FORMATS:
            raise InvalidInput(f"SCATTERMARK_LOG_FORMAT={self.format!r}: choose one of {', '.join(FORMATS)}")
        if self.level not in LEVELS:
            raise InvalidInput(f"SCATTERMARK_LOG_LEVEL={self.level!r}: choose one of {', '.join(LEVELS)}")


class _Process:
    """How this process logs, for the processes that it starts."""

    options: LogOptions | None = None


def configure_logs(options: LogOptions, stream: TextIO | None = None) -> None:
    """Send everything that this process logs to one stream (standard error), in one form; the last call holds."""
    stream = stream or sys.stderr
    as_json = options.format == "json" or (not options.format and not stream.isatty())
    handler = logging.StreamHandler(stream)
    handler.setFormatter(_formatter(as_json, stream.isatty()))
    root = logging.getLogger()
    root.handlers = [handler]
    root.setLevel(logging.WARNING)
    for name in TAKEN_OVER:
        logging.getLogger(name).setLevel(logging.NOTSET)
    for name in SPOKEN_FOR:
        logging.getLogger(name).setLevel(options.level.upper())
    for name in TALKATIVE:
        logging.getLogger(name).setLevel(logging.ERROR)
    for name in (*TAKEN_OVER, *WITH_OWN_HANDLER):
        logger = logging.getLogger(name)
        logger.handlers = [logging.NullHandler()] if name in WITH_OWN_HANDLER else []
        logger.propagate = True
    logging.captureWarnings(True)
    _Process.options = options


def present_options() -> LogOptions | None:
    """How this process logs; None when nobody said so."""
    return _Process.options


def log_context() -> dict[str, Any]:
    """The ids bound to what happens now, for work that goes to another thread or process."""
    request_id = correlation_id.get()
    context = structlog.contextvars.get_contextvars()
    return context if request_id is None else {"request_id": request_id, **context}


@contextmanager
def logging_with(context: Mapping[str, Any]) -> Iterator[None]:
    """Bind ids to all that is logged within the block."""
    with structlog.contextvars.bound_contextvars(**context):
        yield


def _formatter(as_json: bool, in_colour: bool) -> logging.Formatter:
    before: list[Processor] = [
        _add_context,
        structlog.stdlib.add_logger_name,
        structlog.stdlib.add_log_level,
        structlog.stdlib.ExtraAdder(),
    ]
    text: list[Processor] = [
        structlog.processors.format_exc_info,
        _without_secrets,
        structlog.processors.TimeStamper(fmt="iso", utc=True, key="time"),
    ]
    rendering: list[Processor] = [*text, structlog.processors.JSONRenderer() if as_json else _columns(in_colour)]
    return structlog.stdlib.ProcessorFormatter(
        foreign_pre_chain=before, processors=[structlog.stdlib.ProcessorFormatter.remove_processors_meta, *rendering]
    )


def _columns(in_colour: bool) -> structlog.dev.ConsoleRenderer:
    return structlog.dev.ConsoleRenderer(
        colors=in_colour, timestamp_key="time", exception_formatter=structlog.dev.plain_traceback
    )


def _add_context(_logger: WrappedLogger, _method: str, event: EventDict) -> EventDict:
    return {**event, **log_context()}


def _without_secrets(_logger: WrappedLogger, _method: str, event: EventDict) -> EventDict:
    return {name: _masked(value) for name, value in event.items() if name not in NOT_FOR_LINES}


def _masked(value: Any) -> Any:
    if isinstance(value, str) and SUSPECT.search(value):
        for pattern, replacement in SECRETS:
            value = pattern.sub(replacement, value)
    return value
