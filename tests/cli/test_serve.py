"""The service in a process of its own: it says where it is, answers, and stops without leaving anything."""

from __future__ import annotations

import socket
from contextlib import closing
from pathlib import Path

import pytest

from app.cli import main
from app.cli.demo_service import ServiceFailed, running_service, without_settings
from app.cli.serve import _listen
from app.cli.service_client import ServiceClient, ServiceProblem


def test_it_answers_where_it_says_and_stops(tmp_path: Path) -> None:
    with running_service(tmp_path) as url, closing(ServiceClient(url)) as client:
        assert url.startswith("http://127.0.0.1:")
        client.get("healthz")
        client.get("readyz")
    with closing(ServiceClient(url)) as client, pytest.raises(ServiceProblem, match="gave no answer"):
        client.get("healthz")


def test_an_answer_does_not_wait_for_an_acknowledgement() -> None:
    with _listen("127.0.0.1", 0) as listener, socket.create_connection(listener.getsockname()):
        connection, _ = listener.accept()
        with connection:
            assert connection.getsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY)


def test_settings_of_the_shell_stay_out_of_the_demo() -> None:
    shell = {"PATH": "/bin", "SCATTERMARK_DATABASE_URL": "postgresql://elsewhere/production"}
    assert without_settings(shell) == {"PATH": "/bin"}


def test_a_service_that_cannot_start_shows_its_log(tmp_path: Path) -> None:
    (tmp_path / "photographs").write_text("a file where a folder is needed")
    with pytest.raises(ServiceFailed, match="did not start"), running_service(tmp_path):
        pass


def test_a_taken_port_is_one_line(capsys: pytest.CaptureFixture[str]) -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        assert main(["serve", "--port", str(port)]) == 1
    (line,) = capsys.readouterr().err.splitlines()
    assert f"cannot listen on 127.0.0.1 port {port}" in line


def test_a_bad_setting_is_one_line(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SCATTERMARK_LOCATE_WORKERS", "many")
    assert main(["serve", "--port", "0"]) == 1
    (line,) = capsys.readouterr().err.splitlines()
    assert "SCATTERMARK_LOCATE_WORKERS='many'" in line
