"""Keys: made, with their secret told once; revoked; the first one from the environment."""

from __future__ import annotations

import hashlib
import secrets
import time
from dataclasses import dataclass, replace

from sqlalchemy.orm import Session

from app.errors import InvalidInput
from app.services.principal import Principal, checked_scopes
from app.services.rates import Rate
from app.storage.database import Database
from app.storage.keys import ApiKey, Fingerprint, KeyRepository, NewKey
from app.storage.sites import SiteRepository

KEY_PREFIX = "smk_"  # by which scanners of published code know a key
SECRET_BYTES = 32  # 256 random bits: nobody guesses them, so a plain digest at rest is enough
HINT_CHARACTERS = 4
LEAST_BOOTSTRAP_CHARACTERS = 32  # 128 bits as hexadecimal digits
LEAST_DIFFERENT_CHARACTERS = 8  # random hexadecimal digits of that length have fewer once in a million
GREATEST_SECRET_CHARACTERS = 200  # what is longer is no key and not worth a digest
BOOTSTRAP_NAME = "bootstrap"


@dataclass(frozen=True)
class IssuedKey:
    """A key and its secret, which nobody can look up again."""

    key: ApiKey
    secret: str


def fingerprint_of(secret: str) -> Fingerprint:
    """What is kept of a secret."""
    return Fingerprint(digest_of(secret), secret[: len(KEY_PREFIX) + HINT_CHARACTERS])


def digest_of(secret: str) -> str:
    """SHA-256, hexadecimal: a password's slow digest would guard 256 random bits no better, and cost every request."""
    return hashlib.sha256(secret.encode("utf-8", "surrogateescape")).hexdigest()


def new_secret(prefix: str) -> str:
    """A secret that nobody guesses."""
    return prefix + secrets.token_urlsafe(SECRET_BYTES)


def principal_of_key(key: ApiKey) -> Principal:
    """Who the holder of a key is."""
    grant = key.grant
    site_ids = None if grant.site_ids is None else frozenset(grant.site_ids)
    return Principal(key.key_id, grant.name, frozenset(checked_scopes(grant.scopes)), site_ids)


def rate_of_key(key: ApiKey, default: Rate) -> Rate:
    """How often a key may ask."""
    per_s = default.per_s if key.grant.rate_per_s is None else key.grant.rate_per_s
    return Rate(per_s, default.burst if key.grant.burst is None else key.grant.burst)


def create_key(session: Session, wanted: NewKey) -> IssuedKey:
    """A new key.

    Raises
    ------
    InvalidInput
        For scopes that do not exist, a rate that lets nobody in, or an end that is over.
    NotFound
        When it is bound to a site that does not exist.
    """
    scopes = checked_scopes(wanted.scopes)
    Rate(1.0 if wanted.rate_per_s is None else wanted.rate_per_s, 1 if wanted.burst is None else wanted.burst)
    if wanted.expires_s is not None and wanted.expires_s <= time.time():
        raise InvalidInput("the key would have expired already; give a time to come", field="expires_at")
    if wanted.site_ids is not None and not wanted.site_ids:
        raise InvalidInput("a key that is bound to no site opens nothing; name sites, or leave them out for all")
    for site_id in wanted.site_ids or ():
        SiteRepository(session).get(site_id)
    secret = new_secret(KEY_PREFIX)
    return IssuedKey(KeyRepository(session).add(replace(wanted, scopes=scopes), fingerprint_of(secret)), secret)


def ensure_bootstrap_key(database: Database, secret: str) -> bool:
    """Make the first key with the scope ``admin``, with a secret that the operator chose.

    Returns
    -------
    bool
        False when there was such a key before, even one that was revoked: it does not come back at a restart.

    Raises
    ------
    InvalidInput
        For a secret that could be guessed.
    """
    check_bootstrap_secret(secret)
    with database.writing() as session:
        keys = KeyRepository(session)
        if keys.any_administrator():
            return False
        return keys.add_once(NewKey(BOOTSTRAP_NAME, ("admin",)), Fingerprint(digest_of(secret), BOOTSTRAP_NAME))


def check_bootstrap_secret(secret: str) -> None:
    """See that a secret is worth the name; the message never repeats it.

    Raises
    ------
    InvalidInput
    """
    plain = secret.isascii() and secret.isprintable() and " " not in secret
    if (
        not plain
        or not LEAST_BOOTSTRAP_CHARACTERS <= len(secret) <= GREATEST_SECRET_CHARACTERS
        or len(set(secret)) < LEAST_DIFFERENT_CHARACTERS
    ):
        raise InvalidInput(
            f"SCATTERMARK_BOOTSTRAP_KEY is too weak: it takes {LEAST_BOOTSTRAP_CHARACTERS} random characters without "
            "spaces at least, such as `openssl rand -hex 32` prints"
        )


def any_valid_key(database: Database) -> bool:
    """Whether there is a key that opens anything."""
    with database.reading() as session:
        return KeyRepository(session).any_valid(time.time())
