"""One line per event, with its ids and without secrets, whoever logs."""

from __future__ import annotations

import io
import json
import logging
import warnings
from collections.abc import Iterator
from typing import Any

import pytest
from asgi_correlation_id import correlation_id

from app.errors import InvalidInput
from app.logs import (
    SPOKEN_FOR,
    TAKEN_OVER,
    TALKATIVE,
    WITH_OWN_HANDLER,
    LogOptions,
    configure_logs,
    log_context,
    logging_with,
)

log = logging.getLogger("app.tests")


@pytest.fixture(autouse=True)
def _as_before() -> Iterator[None]:
    """Leave logging as it was found: it belongs to the whole process."""
    loggers = [logging.getLogger(name) for name in ("", *SPOKEN_FOR, *TAKEN_OVER, *WITH_OWN_HANDLER, *TALKATIVE)]
    before = [(logger, logger.handlers, logger.level, logger.propagate) for logger in loggers]
    yield
    for logger, logger.handlers, level, logger.propagate in before:
        logger.setLevel(level)
    logging.captureWarnings(False)


@pytest.fixture
def written() -> io.StringIO:
    stream = io.StringIO()
    configure_logs(LogOptions("json"), stream)
    return stream


def lines(written: io.StringIO) -> list[dict[str, Any]]:
    return [json.loads(line) for line in written.getvalue().splitlines()]


def test_an_event_is_a_line_with_its_facts(written: io.StringIO) -> None:
    log.info("map %s is published", 3, extra={"site_id": "s", "targets": 54})
    (line,) = lines(written)
    assert line.pop("time").endswith("Z")
    assert line == {
        "event": "map 3 is published", "level": "info", "logger": "app.tests", "site_id": "s", "targets": 54,
    }  # fmt: skip


def test_an_error_is_one_line_with_its_traceback(written: io.StringIO) -> None:
    try:
        raise ValueError("seven")
    except ValueError:
        log.exception("it failed")
    (line,) = lines(written)
    assert line["level"] == "error" and "ValueError: seven" in line["exception"]


@pytest.mark.parametrize("name", ["uvicorn.error", "dbos", "sqlalchemy.pool", "app.jobs.keeper"])
def test_others_speak_through_the_same_line(written: io.StringIO, name: str) -> None:
    logging.getLogger("uvicorn.error").setLevel("ERROR")  # as whoever configured uvicorn before may have left it
    configure_logs(LogOptions("json"), written)
    logging.getLogger(name).warning("something is odd", extra={"color_message": "\x1b[31msomething is odd"})
    (line,) = lines(written)
    assert (line["event"], line["logger"]) == ("something is odd", name)
    assert "\x1b" not in written.getvalue()


def test_libraries_are_heard_from_warnings_on(written: io.StringIO) -> None:
    logging.getLogger("sqlalchemy.engine").info("SELECT 1")
    with warnings.catch_warnings():
        warnings.simplefilter("always")
        warnings.warn("this will go", DeprecationWarning, stacklevel=1)
    (line,) = lines(written)
    assert line["logger"] == "py.warnings"


def test_ids_of_the_request_and_the_job_are_in_every_line(written: io.StringIO) -> None:
    token = correlation_id.set("request-1")
    try:
        with logging_with({"job_id": "job-1"}):
            assert log_context() == {"request_id": "request-1", "job_id": "job-1"}
            logging.getLogger("uvicorn.error").warning("odd")
    finally:
        correlation_id.reset(token)
    log.warning("later")
    within, later = lines(written)
    assert (within["request_id"], within["job_id"]) == ("request-1", "job-1")
    assert not {"request_id", "job_id"} & set(later)


@pytest.mark.parametrize(
    ("text", "secret"),
    [
        ("GET /jobs with Authorization: Bearer smk_0123456789", "smk_0123456789"),
        ("the key smk_0123456789-_ab was refused", "0123456789-_ab"),
        ("cannot reach postgresql+psycopg://scattermark:hunter2@database:5432/x", "hunter2"),
        ("GET /locate?site_id=a&key=0123456789", "0123456789"),
    ],
)
def test_secrets_are_masked_wherever_they_come_from(written: io.StringIO, text: str, secret: str) -> None:
    log.warning("%s", text, extra={"fact": text})
    try:
        raise ValueError(text)
    except ValueError:
        log.exception("it failed")
    assert secret not in written.getvalue()
    assert "***" in lines(written)[0]["event"]


def test_people_get_columns_and_no_colours_in_a_file() -> None:
    written = io.StringIO()
    configure_logs(LogOptions("console"), written)
    log.info("published", extra={"site_id": "s"})
    (line,) = written.getvalue().splitlines()
    assert "published" in line and "site_id=s" in line and "\x1b" not in line


def test_without_a_format_a_file_gets_json() -> None:
    written = io.StringIO()
    configure_logs(LogOptions(level="warning"), written)
    log.info("not wanted")
    log.warning("wanted")
    assert [line["event"] for line in lines(written)] == ["wanted"]


@pytest.mark.parametrize("wrong", [{"format": "xml"}, {"level": "loud"}])
def test_a_wrong_choice_names_the_right_ones(wrong: dict[str, str]) -> None:
    with pytest.raises(InvalidInput, match="choose one of"):
        LogOptions(**wrong)
