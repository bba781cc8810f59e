"""Who may come in: no service that others can reach is without keys by accident."""

from __future__ import annotations

import argparse
from pathlib import Path

import pytest

from app.cli import main
from app.cli.door import add_door, guarded, host_of, is_loopback, open_door, refuse_open_door
from app.cli.migrate import migrate
from app.errors import InvalidInput
from app.settings import Settings, settings_from_environment
from app.storage.database import Database
from app.storage.keys import KeyRepository
from app.storage.paging import PageRequest

STRONG = "f3a91c07b2de458899aa10c4d7e6b5f2"


def arguments(*words: str) -> argparse.Namespace:
    parser = argparse.ArgumentParser()
    add_door(parser)
    return parser.parse_args(words)


@pytest.mark.parametrize(
    ("words", "required"),
    [
        ((), False),
        (("--host", "localhost"), False),
        (("--host", "::1"), False),
        (("--require-keys",), True),
        (("--host", "0.0.0.0"), True),
        (("--host", "::"), True),
        (("--host", "192.0.2.1"), True),
        (("--host", "0.0.0.0", "--insecure"), False),
        (("--host", "127.0.0.1", "--insecure"), False),
        (("--host", "0.0.0.0", "--insecure", "--require-keys"), True),
        (("--lan", "--host", "127.0.0.1"), True),
    ],
)
def test_keys_are_asked_for_wherever_others_come(words: tuple[str, ...], required: bool) -> None:
    given = arguments(*words)
    settings = guarded(Settings(), given, host_of(given))
    assert settings.require_keys is required
    assert settings.insecure is ("--insecure" in words and not required)


def test_the_environment_says_it_as_well() -> None:
    asked = settings_from_environment({"SCATTERMARK_REQUIRE_KEYS": "true"})
    assert guarded(asked, arguments(), "127.0.0.1").require_keys
    trusting = settings_from_environment({"SCATTERMARK_INSECURE": "1"})
    assert not guarded(trusting, arguments(), "0.0.0.0").require_keys
    with pytest.raises(InvalidInput, match="true or false"):
        settings_from_environment({"SCATTERMARK_INSECURE": "perhaps"})


def test_a_setting_with_a_secret_is_not_shown() -> None:
    assert STRONG not in repr(settings_from_environment({"SCATTERMARK_BOOTSTRAP_KEY": STRONG}))


def test_without_a_key_it_does_not_start_and_leaves_nothing(tmp_path: Path) -> None:
    settings = Settings(data_dir=tmp_path / "data", require_keys=True)
    with pytest.raises(InvalidInput, match="--insecure"):
        refuse_open_door(settings, arguments(), "0.0.0.0")
    assert not settings.data_dir.exists()


def test_one_valid_key_is_enough(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    settings = Settings(data_dir=tmp_path, require_keys=True)
    migrate(settings)
    refuse_open_door(settings, arguments(), "0.0.0.0")
    with pytest.raises(InvalidInput, match="no valid key"):
        open_door(settings, arguments(), "0.0.0.0")
    assert main(["keys", "create", "x", "--scope", "locate", "--data-dir", str(tmp_path)]) == 0
    assert open_door(settings, arguments(), "0.0.0.0").scheme == "http"
    capsys.readouterr()


def test_the_first_key_comes_from_the_environment(tmp_path: Path) -> None:
    settings = Settings(data_dir=tmp_path, require_keys=True, bootstrap_key=STRONG)
    refuse_open_door(settings, arguments(), "0.0.0.0")
    migrate(settings)
    open_door(settings, arguments(), "0.0.0.0")
    database = Database(settings.sqlalchemy_url)
    with database.reading() as session:
        assert [key.grant.scopes for key in KeyRepository(session).page(PageRequest()).items] == [("admin",)]
    database.close()
    with pytest.raises(InvalidInput, match="too weak"):
        open_door(Settings(data_dir=tmp_path, require_keys=True, bootstrap_key="admin"), arguments(), "0.0.0.0")


@pytest.mark.parametrize("words", [["--host", "0.0.0.0"], ["--require-keys"]])
def test_the_command_says_it_in_one_line(words: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["serve", *words, "--port", "0", "--data-dir", str(tmp_path / "data")]) == 1
    (line,) = capsys.readouterr().err.splitlines()
    assert "scattermark keys create" in line


def test_addresses_of_this_machine() -> None:
    assert is_loopback("127.0.0.1") and is_loopback("localhost") and is_loopback("::1")
    assert not is_loopback("0.0.0.0") and not is_loopback("example.org")
