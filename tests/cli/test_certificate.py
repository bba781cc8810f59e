from __future__ import annotations

import stat
from datetime import UTC, datetime, timedelta
from ipaddress import ip_address
from pathlib import Path

import pytest
from cryptography import x509

from app.cli import certificate
from app.cli.certificate import certificate_for

NAMES = ("10.0.0.5", "hall", "hall.local")


def read(folder: Path, names: tuple[str, ...] = NAMES) -> x509.Certificate:
    return x509.load_pem_x509_certificate(certificate_for(names, folder).certificate_path.read_bytes())


def test_it_is_for_these_names_and_vouches_for_nobody_else(tmp_path: Path) -> None:
    made = read(tmp_path / "tls")
    alternatives = made.extensions.get_extension_for_class(x509.SubjectAlternativeName).value
    assert alternatives.get_values_for_type(x509.IPAddress) == [ip_address("10.0.0.5")]
    assert alternatives.get_values_for_type(x509.DNSName) == ["hall", "hall.local"]
    assert not made.extensions.get_extension_for_class(x509.BasicConstraints).value.ca
    assert made.not_valid_before_utc < datetime.now(UTC) < made.not_valid_after_utc
    assert made.not_valid_after_utc - made.not_valid_before_utc <= timedelta(days=397)


def test_it_stays_while_it_is_good(tmp_path: Path) -> None:
    first = certificate_for(NAMES, tmp_path)
    assert certificate_for(NAMES, tmp_path) == first
    assert certificate_for(NAMES[:1], tmp_path) == first


def test_another_address_takes_another_one(tmp_path: Path) -> None:
    first = certificate_for(NAMES, tmp_path)
    assert certificate_for(("10.0.0.6", *NAMES[1:]), tmp_path).fingerprint != first.fingerprint


def test_it_is_renewed_before_its_end(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with monkeypatch.context() as short:
        short.setattr(certificate, "VALID_DAYS", certificate.RENEWED_DAYS_BEFORE)
        first = certificate_for(NAMES, tmp_path)
    assert certificate_for(NAMES, tmp_path).fingerprint != first.fingerprint


@pytest.mark.parametrize("name", ["certificate.pem", "key.pem"])
def test_what_is_lost_or_broken_is_made_anew(tmp_path: Path, name: str) -> None:
    first = certificate_for(NAMES, tmp_path)
    (tmp_path / name).unlink()
    second = certificate_for(NAMES, tmp_path)
    assert second.fingerprint != first.fingerprint
    (tmp_path / "certificate.pem").write_text("no certificate")
    assert certificate_for(NAMES, tmp_path).fingerprint != second.fingerprint


def test_only_the_owner_reads_the_key_even_where_a_loose_file_was(tmp_path: Path) -> None:
    (tmp_path / "key.pem").write_text("old")
    (tmp_path / "key.pem").chmod(0o666)
    made = certificate_for(NAMES, tmp_path)
    assert stat.S_IMODE(made.key_path.stat().st_mode) == 0o600
