from __future__ import annotations

import hashlib
import time

import pytest

from app.errors import InvalidInput, NotFound
from app.services.keys import (
    KEY_PREFIX,
    any_valid_key,
    create_key,
    digest_of,
    ensure_bootstrap_key,
    new_secret,
    principal_of_key,
    rate_of_key,
)
from app.services.rates import Rate
from app.storage.database import Database
from app.storage.keys import KeyRepository, NewKey
from app.storage.models import KeyRow
from tests.storage.examples import site_with_survey

STRONG = "f3a91c07b2de458899aa10c4d7e6b5f2"


def test_a_key_is_what_was_asked_for_and_its_digest_is_at_rest(database: Database) -> None:
    site, _ = site_with_survey(database)
    wanted = NewKey("phone", ("survey", "locate", "survey"), (site.site_id,), 2.5, 7, time.time() + 60.0)
    with database.writing() as session:
        issued = create_key(session, wanted)
    with database.reading() as session:
        found = KeyRepository(session).find(hashlib.sha256(issued.secret.encode()).hexdigest())
        row = session.query(KeyRow).one()
        assert issued.secret not in repr(vars(row))
    assert found == issued.key
    assert issued.key.grant.scopes == ("locate", "survey")
    principal = principal_of_key(issued.key)
    assert principal.site_ids == {site.site_id}
    assert principal.may("survey") and not principal.may("analyse", "admin")
    assert rate_of_key(issued.key, Rate(1.0, 1)) == Rate(2.5, 7)


def test_secrets_are_long_and_differ() -> None:
    secrets = {new_secret(KEY_PREFIX) for _ in range(100)}
    assert len(secrets) == 100
    assert {len(secret) for secret in secrets} == {47}
    assert len(digest_of("any")) == 64


@pytest.mark.parametrize(
    "wanted",
    [
        NewKey("x", ()),
        NewKey("x", ("fly",)),
        NewKey("x", ("locate",), site_ids=()),
        NewKey("x", ("locate",), rate_per_s=0.0),
        NewKey("x", ("locate",), burst=0),
        NewKey("x", ("locate",), expires_s=1.0),
    ],
)
def test_what_opens_nothing_is_not_made(database: Database, wanted: NewKey) -> None:
    with pytest.raises(InvalidInput), database.writing() as session:
        create_key(session, wanted)
    assert not any_valid_key(database)


def test_a_site_that_is_not_there_binds_no_key(database: Database) -> None:
    with pytest.raises(NotFound), database.writing() as session:
        create_key(session, NewKey("x", ("locate",), ("nowhere",)))


def test_the_first_key_comes_from_the_operator_and_never_again(database: Database) -> None:
    assert ensure_bootstrap_key(database, STRONG)
    assert not ensure_bootstrap_key(database, STRONG)
    assert not ensure_bootstrap_key(database, STRONG[::-1])
    with database.writing() as session:
        key = KeyRepository(session).find(digest_of(STRONG))
        assert key is not None
        assert key.grant.scopes == ("admin",)
        assert STRONG[:6] not in key.hint
        KeyRepository(session).revoke(key.key_id)
    assert not ensure_bootstrap_key(database, STRONG), "a revoked key came back"
    assert not any_valid_key(database)


@pytest.mark.parametrize("secret", ["", "short", "a" * 64, "correct horse battery staple again and again", "ü" * 40])
def test_a_secret_that_could_be_guessed_is_refused_and_never_repeated(database: Database, secret: str) -> None:
    with pytest.raises(InvalidInput, match="too weak") as refused:
        ensure_bootstrap_key(database, secret)
    assert not secret or secret not in refused.value.detail
