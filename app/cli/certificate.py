"""A certificate that this machine issues to itself: phones use their camera on secure pages alone."""

from __future__ import annotations

import ipaddress
import os
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from pathlib import Path

from cryptography import x509
from cryptography.hazmat.primitives import hashes, serialization
from cryptography.hazmat.primitives.asymmetric import ec
from cryptography.x509.oid import ExtendedKeyUsageOID, NameOID

VALID_DAYS = 397  # the most that browsers take
RENEWED_DAYS_BEFORE = 30
CLOCKS_DIFFER = timedelta(days=1)  # a phone whose clock is behind takes it, too
OWNER_ALONE = 0o600
FOLDER_OF_OWNER = 0o700


@dataclass(frozen=True)
class Certificate:
    """Where a certificate and its key lie, and the SHA-256 by which people compare it with what a phone shows."""

    certificate_path: Path
    key_path: Path
    fingerprint: str


def certificate_for(names: tuple[str, ...], folder: Path) -> Certificate:
    """The certificate of a folder, made anew when it is not for these names or at its end.

    Parameters
    ----------
    names : tuple of str
        Addresses and host names that the service is called by; the first is its common name.
    folder : Path
    """
    certificate_path, key_path = folder / "certificate.pem", folder / "key.pem"
    present = _read(certificate_path) if key_path.is_file() else None
    if present is None or not _is_good_for(present, names):
        folder.mkdir(mode=FOLDER_OF_OWNER, parents=True, exist_ok=True)
        present = _issue(names, key_path)
        certificate_path.write_bytes(present.public_bytes(serialization.Encoding.PEM))
    return Certificate(certificate_path, key_path, present.fingerprint(hashes.SHA256()).hex(":").upper())


def _read(path: Path) -> x509.Certificate | None:
    """The certificate that is there; one that cannot be read is replaced like one that is not there."""
    try:
        return x509.load_pem_x509_certificate(path.read_bytes())
    except (FileNotFoundError, ValueError):
        return None


def _is_good_for(certificate: x509.Certificate, names: tuple[str, ...]) -> bool:
    alternatives = certificate.extensions.get_extension_for_class(x509.SubjectAlternativeName).value
    good_until = certificate.not_valid_after_utc - timedelta(days=RENEWED_DAYS_BEFORE)
    return set(alternatives) >= set(_alternatives(names)) and datetime.now(UTC) < good_until


def _issue(names: tuple[str, ...], key_path: Path) -> x509.Certificate:
    key = ec.generate_private_key(ec.SECP256R1())
    _write_key(key, key_path)
    public = key.public_key()
    name = x509.Name([x509.NameAttribute(NameOID.COMMON_NAME, names[0])])
    identifier = x509.SubjectKeyIdentifier.from_public_key(public)
    now = datetime.now(UTC)
    extensions: list[tuple[x509.ExtensionType, bool]] = [
        (x509.SubjectAlternativeName(_alternatives(names)), False),
        (x509.BasicConstraints(ca=False, path_length=None), True),  # it vouches for nobody but itself
        (x509.ExtendedKeyUsage([ExtendedKeyUsageOID.SERVER_AUTH]), False),
        (identifier, False),
        (x509.AuthorityKeyIdentifier.from_issuer_subject_key_identifier(identifier), False),
    ]
    builder = (
        x509.CertificateBuilder(name, name, public, x509.random_serial_number())
        .not_valid_before(now - CLOCKS_DIFFER)
        .not_valid_after(now + timedelta(days=VALID_DAYS) - CLOCKS_DIFFER)
    )
    for extension, critical in extensions:
        builder = builder.add_extension(extension, critical)
    return builder.sign(key, hashes.SHA256())


def _write_key(key: ec.EllipticCurvePrivateKey, path: Path) -> None:
    """Write it so that nobody else could read it at any moment."""
    path.unlink(missing_ok=True)
    descriptor = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, OWNER_ALONE)
    with os.fdopen(descriptor, "wb") as file:
        file.write(
            key.private_bytes(
                serialization.Encoding.PEM, serialization.PrivateFormat.PKCS8, serialization.NoEncryption()
            )
        )


def _alternatives(names: tuple[str, ...]) -> list[x509.GeneralName]:
    return [_alternative(name) for name in names]


def _alternative(name: str) -> x509.GeneralName:
    try:
        return x509.IPAddress(ipaddress.ip_address(name))
    except ValueError:
        return x509.DNSName(name)
