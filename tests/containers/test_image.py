"""The Dockerfile's own commands, run in a clean environment: wheel, migrations, service, health check."""

from __future__ import annotations

import secrets
import socket
import subprocess
import time
from pathlib import Path

import pytest
import yaml

from tests.containers.dockerfile import Stage, read_stages
from tests.containers.image import Image

CHECKOUT = Path(__file__).parents[2]
ANSWER_S = 300.0  # of a loaded machine; a few seconds of one that is not
PORT = "8000"


@pytest.fixture(scope="module")
def stages() -> tuple[Stage, Stage]:
    build, final = read_stages(CHECKOUT / "Dockerfile")
    return build, final


@pytest.fixture(scope="module")
def image(stages: tuple[Stage, Stage], tmp_path_factory: pytest.TempPathFactory) -> Image:
    image = Image(tmp_path_factory.mktemp("image"), CHECKOUT)
    for stage in stages:
        image.build(stage)
    image.lend_dependencies()
    image.lend_compiled()
    return image


@pytest.fixture
def free_port() -> str:
    with socket.create_server(("127.0.0.1", 0)) as listener:
        return str(listener.getsockname()[1])


def command_of(image: Image, final: Stage, words: list[str]) -> list[str]:
    """What the container would start: the entry point and these words."""
    entry, *rest = final.last("ENTRYPOINT").words
    return [str(image.root / "opt/scattermark/bin" / entry), *rest, *words]


def test_the_service_runs_without_privileges_and_its_stages_are_apart(stages: tuple[Stage, Stage]) -> None:
    build, final = stages
    assert build.base == final.base and final.base.endswith("-slim")
    user, group = final.last("USER").text.split(":")
    assert int(user) > 0 and int(group) > 0  # a number, so that an orchestrator can see that it is not root
    assert final.last("EXPOSE").text == PORT
    assert final.last("VOLUME").text == final.environment["SCATTERMARK_DATA_DIR"] == final.last("WORKDIR").text
    (copy,) = final.all("COPY")
    source, target = copy.words[1:]
    assert copy.words[0] == f"--from={build.name}" and source == target


def test_the_wheel_is_what_runs_and_brings_its_migrations(image: Image, stages: tuple[Stage, Stage]) -> None:
    environment = image.environment(stages[1])
    code = "import app; from app.storage.migrate import migrations_folder; print(app.__file__, migrations_folder())"
    found = subprocess.run(
        ["python", "-c", code],
        cwd=image.root / "data", env=environment, capture_output=True, text=True, check=True,
    )  # fmt: skip
    for place in found.stdout.split():
        assert Path(place).is_relative_to(image.root / "opt/scattermark")
        assert not Path(place).is_relative_to(CHECKOUT)


def test_the_service_is_no_open_door_by_itself(image: Image, stages: tuple[Stage, Stage]) -> None:
    refused = subprocess.run(
        command_of(image, stages[1], stages[1].last("CMD").words),
        cwd=image.root / "data", env=image.environment(stages[1]), capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert refused.returncode == 1
    assert "SCATTERMARK_BOOTSTRAP_KEY" in refused.stderr


def test_it_migrates_serves_and_is_healthy(image: Image, stages: tuple[Stage, Stage], free_port: str) -> None:
    final, data = stages[1], image.root / "data"
    services = yaml.safe_load((CHECKOUT / "docker-compose.yml").read_text())["services"]
    environment = image.environment(final) | {"SCATTERMARK_BOOTSTRAP_KEY": secrets.token_hex(32)}
    image.run(command_of(image, final, services["migrate"]["command"]), data, environment)
    words = [free_port if word == PORT else word for word in services["api"]["command"]]
    health = [word.replace(PORT, free_port) for word in final.health_command]
    assert free_port in words and any(free_port in word for word in health)
    check = {"args": health, "cwd": data, "env": environment, "capture_output": True, "check": False}
    assert subprocess.run(**check).returncode != 0
    with subprocess.Popen(command_of(image, final, words), cwd=data, env=environment, stdout=subprocess.PIPE) as server:
        try:
            deadline_s = time.monotonic() + ANSWER_S
            while subprocess.run(**check).returncode != 0:
                assert server.poll() is None and time.monotonic() < deadline_s, "the service never became healthy"
        finally:
            server.terminate()
            server.wait(ANSWER_S)
    assert server.returncode == 0
    assert {path.name for path in data.iterdir()} == {"photographs", "scattermark.db"}  # no WAL: closed in good order
