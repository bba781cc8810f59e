"""``serve --lan``: a phone reads the code, checks the certificate, and locates in one site and nothing else."""

from __future__ import annotations

import hashlib
import json
import os
import socket
import ssl
import stat
import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from http.client import HTTPSConnection
from pathlib import Path
from typing import Any
from urllib.parse import parse_qs, urlsplit

import cv2
import numpy as np
import pytest
import segno

from app.cli import main
from app.cli.certificate import Certificate
from app.cli.demo_service import without_settings
from app.cli.lan import Invitation, names_of, welcome
from app.cli.migrate import migrate
from app.settings import Settings
from app.storage.database import Database
from app.storage.sites import SiteRepository

START_S = 120.0
HALF_BLOCKS = {" ": (0, 0), "▀": (1, 0), "▄": (0, 1), "█": (1, 1)}  # upper and lower, lit or not
MODULE_PX = 6


def make_sites(data_dir: Path, count: int) -> list[str]:
    settings = Settings(data_dir=data_dir)
    migrate(settings)
    database = Database(settings.sqlalchemy_url)
    with database.writing() as session:
        sites = [SiteRepository(session).add(f"hall {number}", "golay", 0.014, None) for number in range(count)]
    database.close()
    return [site.site_id for site in sites]


def picture_of(lines: list[str]) -> np.ndarray:
    """What a terminal shows of a code, as a picture."""
    rows = [[HALF_BLOCKS[character] for character in line] for line in lines]
    lit = np.array([[pair[half] for pair in row] for row in rows for half in (0, 1)], dtype=np.uint8)
    return np.kron(lit * 255, np.ones((MODULE_PX, MODULE_PX), dtype=np.uint8))


def read_code(picture: np.ndarray) -> str:
    text, _, _ = cv2.QRCodeDetectorAruco().detectAndDecode(picture)  # the other one misses some codes
    return str(text)


@dataclass(frozen=True)
class Welcome:
    """What the service printed."""

    url: str
    code: list[str]
    link: str
    fingerprint: str


@contextmanager
def serving_lan(data_dir: Path) -> Iterator[Welcome]:
    command = [sys.executable, "-m", "app.cli", "serve", "--lan", "--host", "127.0.0.1", "--port", "0", "--no-worker"]
    environment = {**without_settings(os.environ), "PYTHONIOENCODING": "utf-8", "SCATTERMARK_LOCATE_WORKERS": "1"}
    with subprocess.Popen(
        [*command, "--data-dir", str(data_dir)], stdout=subprocess.PIPE, encoding="utf-8", env=environment
    ) as service:
        impatience = threading.Timer(START_S, service.kill)
        impatience.start()
        assert service.stdout is not None
        lines: list[str] = []
        for line in service.stdout:
            lines.append(line.rstrip("\n"))
            if line.count(":") == 31:  # the fingerprint is the last
                break
        impatience.cancel()
        try:
            code = [line for line in lines if line and set(line) <= set(HALF_BLOCKS)]
            yield Welcome(lines[0].split()[-1], code, lines[-3], lines[-1])
        finally:
            service.terminate()


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, str]:
    folder = tmp_path_factory.mktemp("lan")
    (site_id,) = make_sites(folder, 1)
    return folder, site_id


@pytest.fixture(scope="module")
def welcomed(place: tuple[Path, str]) -> Iterator[Welcome]:
    with serving_lan(place[0]) as said:
        yield said


def ask(url: str, path: str, certificate: Path, key: str | None = None) -> tuple[int, dict[str, Any], dict[str, str]]:
    """A client that takes this certificate and no other."""
    context = ssl.create_default_context(cafile=str(certificate))
    context.verify_flags |= ssl.VERIFY_X509_STRICT
    parts = urlsplit(url)
    connection = HTTPSConnection(str(parts.hostname), parts.port, context=context, timeout=60)
    try:
        connection.request("GET", path, headers={} if key is None else {"Authorization": f"Bearer {key}"})
        answer = connection.getresponse()
        return answer.status, json.loads(answer.read()), {name.lower(): text for name, text in answer.getheaders()}
    finally:
        connection.close()


def test_a_phone_reads_what_is_printed(welcomed: Welcome, place: tuple[Path, str]) -> None:
    link = read_code(picture_of(welcomed.code))
    assert link == welcomed.link
    assert link.startswith(f"{welcomed.url}/#")
    assert welcomed.url.startswith("https://127.0.0.1:")
    assert parse_qs(urlsplit(link).fragment)["site_id"] == [place[1]]


def test_the_key_in_the_code_locates_there_and_opens_nothing_else(welcomed: Welcome, place: tuple[Path, str]) -> None:
    data_dir, site_id = place
    certificate = data_dir / "tls" / "certificate.pem"
    (key,) = parse_qs(urlsplit(welcomed.link).fragment)["key"]
    status, who, headers = ask(welcomed.url, "/session", certificate, key)
    assert (status, who["scopes"], who["site_ids"]) == (200, ["locate"], [site_id])
    assert headers["strict-transport-security"]
    assert ask(welcomed.url, f"/sites/{site_id}", certificate, key)[0] == 200
    assert ask(welcomed.url, "/trajectories", certificate, key)[0] == 403
    assert ask(welcomed.url, "/sites", certificate)[0] == 401


def test_the_printed_fingerprint_is_of_the_certificate_that_is_shown(welcomed: Welcome) -> None:
    parts = urlsplit(welcomed.url)
    shown = ssl.get_server_certificate((str(parts.hostname), int(parts.port or 0)))
    digest = hashlib.sha256(ssl.PEM_cert_to_DER_cert(shown)).digest()
    assert digest.hex(":").upper() == welcomed.fingerprint


def test_its_private_key_is_the_owner_s_alone(welcomed: Welcome, place: tuple[Path, str]) -> None:
    assert welcomed.url
    for name, mode in (("key.pem", 0o600), ("", 0o700)):
        assert stat.S_IMODE((place[0] / "tls" / name).stat().st_mode) == mode


def test_a_rendered_code_is_read_too(tmp_path: Path) -> None:
    link = Invitation("01a20000-0000-7000-8000-000000000000", "hall", "smk_" + "a-_Z" * 10).link(
        "https://[fe80::1]:8000"
    )
    path = tmp_path / "code.png"
    segno.make_qr(link).save(str(path), scale=MODULE_PX)
    assert read_code(cv2.imread(str(path))) == link


def test_the_welcome_tells_all_that_a_phone_needs(tmp_path: Path) -> None:
    text = welcome("https://10.0.0.5", Invitation("s", "hall", "k"), Certificate(tmp_path, tmp_path, "AB:CD"))
    for words in ("hall", "https://10.0.0.5/#site_id=s&key=k", "AB:CD", "24 hours"):
        assert words in text


def test_this_machine_is_called_by_its_address_and_its_name() -> None:
    address, *names = names_of("10.0.0.5")
    assert address == "10.0.0.5"
    assert all(name.startswith(socket.gethostname().split(".")[0]) for name in names)


@pytest.mark.parametrize(
    ("sites", "arguments", "words"),
    [
        (0, [], "there is no site yet"),
        (2, [], "name one with --site"),
        (1, ["--site", "nowhere"], "there is no site nowhere"),
        (1, ["--insecure"], "leave one of them out"),
    ],
)
def test_what_is_missing_is_one_line(
    tmp_path: Path, sites: int, arguments: list[str], words: str, capsys: pytest.CaptureFixture[str]
) -> None:
    make_sites(tmp_path, sites)
    place = ["--host", "127.0.0.1", "--port", "0", "--data-dir", str(tmp_path)]
    assert main(["serve", "--lan", *place, *arguments]) == 1
    (line,) = capsys.readouterr().err.splitlines()
    assert words in line


def test_a_site_without_lan_is_a_mistake(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["serve", "--site", "x"]) == 1
    assert "say --lan" in capsys.readouterr().err
