"""docker-compose.yml: what it names exists, what it needs is asked for, what must not be reached is not."""

from __future__ import annotations

import re
import shutil
import subprocess
from dataclasses import fields
from pathlib import Path
from typing import Any

import pytest
import yaml

from app.cli import COMMANDS, parser
from app.settings import PREFIX, Settings
from tests.containers.dockerfile import read_stages

CHECKOUT = Path(__file__).parents[2]
COMPOSE = CHECKOUT / "docker-compose.yml"
OBJECT_STORE = CHECKOUT / "deploy" / "object-store.yml"
OURS = {"migrate", "api", "worker"}
STOP_S = 10.0  # what a server or a worker takes at most
STORED = {"api", "worker"}  # who reads and writes photographs
VARIABLE = re.compile(r"\$\{(?P<name>\w+)(?P<rest>[^}]*)\}")


def compose_works() -> bool:
    docker = shutil.which("docker")
    if docker is None:
        return False
    return subprocess.run([docker, "compose", "version"], capture_output=True, check=False).returncode == 0


@pytest.fixture(scope="module")
def compose() -> dict[str, Any]:
    return yaml.safe_load(COMPOSE.read_text())


@pytest.fixture(scope="module")
def services(compose: dict[str, Any]) -> dict[str, dict[str, Any]]:
    return compose["services"]


@pytest.fixture(scope="module")
def example() -> dict[str, str]:
    """The variables of the example of an environment."""
    lines = (CHECKOUT / ".env.example").read_text().splitlines()
    return dict(line.split("=", 1) for line in lines if line and not line.startswith("#"))


def of_object_store() -> list[str]:
    """Variables of an environment that the object store asks for."""
    return [match["name"] for match in VARIABLE.finditer(OBJECT_STORE.read_text())]


@pytest.mark.skipif(not compose_works(), reason="there is no docker compose; the other tests read the file themselves")
def test_docker_compose_takes_it(tmp_path: Path) -> None:
    filled = tmp_path / "env"
    needed = [f"{name}=abc" for name in ("POSTGRES_PASSWORD", "SCATTERMARK_BOOTSTRAP_KEY", *of_object_store())]
    filled.write_text("\n".join([(CHECKOUT / ".env.example").read_text(), *needed, ""]))
    files = ["--file", str(COMPOSE), "--file", str(OBJECT_STORE)]
    command = ["docker", "compose", *files, "--env-file", str(filled), "config", "--quiet"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def test_our_services_are_commands_of_the_image(services: dict[str, dict[str, Any]]) -> None:
    assert {name for name, service in services.items() if "build" in service} == OURS
    for name in OURS:
        command = services[name]["command"]
        assert command[0] in COMMANDS
        parser().parse_args(command)  # ends the test on an option that does not exist
        assert services[name]["build"] == "."


def test_each_waits_for_what_it_needs(services: dict[str, dict[str, Any]]) -> None:
    image_is_checked = bool(read_stages(CHECKOUT / "Dockerfile")[-1].all("HEALTHCHECK"))
    for name, service in services.items():
        for needed, how in service.get("depends_on", {}).items():
            other = services[needed]
            if how["condition"] == "service_completed_successfully":
                assert other["restart"] == "no", f"{name} waits for the end of {needed}, which never ends"
            else:
                assert how["condition"] == "service_healthy"
                assert "test" in other.get("healthcheck", {}) or ("build" in other and image_is_checked)
    for name in ("api", "worker"):
        assert set(services[name]["depends_on"]) == {"database", "migrate"}
    assert set(services["migrate"]["depends_on"]) == {"database"}
    assert set(services["proxy"]["depends_on"]) == {"api"}


def test_services_that_stay_come_back(services: dict[str, dict[str, Any]]) -> None:
    assert {name for name, service in services.items() if service["restart"] == "unless-stopped"} == set(services) - {
        "migrate"
    }


def test_volumes_and_networks_are_declared_and_used(compose: dict[str, Any]) -> None:
    mounts = [mount.split(":") for service in compose["services"].values() for mount in service["volumes"]]
    named = {source for source, *_ in mounts if not source.startswith(".")}
    assert named == set(compose["volumes"])
    for source, _, *mode in (mount for mount in mounts if mount[0].startswith(".")):
        assert (CHECKOUT / source).is_file() and mode == ["ro"]
    networks = {network for service in compose["services"].values() for network in service["networks"]}
    assert networks == set(compose["networks"])
    volume = read_stages(CHECKOUT / "Dockerfile")[-1].last("VOLUME").text
    assert all(compose["services"][name]["volumes"] == [f"photographs:{volume}"] for name in OURS)


def test_nobody_is_reached_but_through_the_proxy(compose: dict[str, Any]) -> None:
    services = compose["services"]
    assert {name for name, service in services.items() if "ports" in service} == {"proxy"}
    assert {name for name, service in services.items() if service["networks"] != ["inside"]} == {"proxy"}
    assert compose["networks"]["inside"]["internal"] is True
    for port in services["proxy"]["ports"]:
        assert port.startswith("${SCATTERMARK_PUBLISH:-127.0.0.1}:")
    caddyfile = (CHECKOUT / "deploy" / "Caddyfile").read_text()
    assert re.search(r"dynamic a \{\s+name api\s+port 8000\s", caddyfile)
    assert re.search(r"@inside path /metrics\s+respond @inside 404", caddyfile)


def test_who_can_be_reached_asks_for_keys(services: dict[str, dict[str, Any]]) -> None:
    assert not {"--insecure", "--lan"} & set(services["api"]["command"])
    assert services["api"]["environment"]["SCATTERMARK_BOOTSTRAP_KEY"].startswith("${SCATTERMARK_BOOTSTRAP_KEY:?")
    assert "SCATTERMARK_INSECURE" not in services["api"]["environment"]


def test_servers_and_workers_may_be_many(services: dict[str, dict[str, Any]]) -> None:
    assert "--no-worker" in services["api"]["command"]
    for name in ("api", "worker"):
        assert not {"container_name", "ports"} & set(services[name])
        assert re.fullmatch(r"\$\{SCATTERMARK_\w+_MEMORY:-\d+g\}", services[name]["mem_limit"])


def test_nobody_is_killed_at_work(services: dict[str, dict[str, Any]]) -> None:
    for name in ("api", "worker"):
        drain_s = float(services[name]["environment"].get("SCATTERMARK_DRAIN_S", 0.0))
        assert float(services[name]["stop_grace_period"].removesuffix("s")) > drain_s + STOP_S


def test_a_worker_is_healthy_while_it_tells_its_figures(services: dict[str, dict[str, Any]]) -> None:
    worker = services["worker"]
    port = worker["environment"]["SCATTERMARK_WORKER_METRICS_PORT"]
    assert f"http://127.0.0.1:{port}/metrics" in worker["healthcheck"]["test"][-1]


def test_an_object_store_is_a_file_more(compose: dict[str, Any]) -> None:
    more = yaml.safe_load(OBJECT_STORE.read_text())
    assert set(more["services"]) == STORED
    for name, service in more["services"].items():
        assert set(service["networks"]) == {*compose["services"][name]["networks"], *more["networks"]}
        assert set(service["environment"]) == set(of_object_store())
        assert all(value.startswith("${") and ":?" in value for value in service["environment"].values())
    assert f"{PREFIX}PHOTOGRAPHS_URL" in of_object_store()


def test_variables_are_explained_and_secrets_are_asked_for(example: dict[str, str]) -> None:
    used = {match["name"]: match["rest"] for match in VARIABLE.finditer(COMPOSE.read_text())}
    assert {*used, *of_object_store()} == set(example)
    for secret in ("POSTGRES_PASSWORD", "SCATTERMARK_BOOTSTRAP_KEY"):
        assert used[secret].startswith(":?") and example[secret] == ""
    for name, rest in used.items():
        assert rest.startswith(":?") or rest == f":-{example[name]}", f"{name} has two defaults"
    ignored = (CHECKOUT / ".gitignore").read_text().splitlines()
    assert ".env" in ignored


def test_settings_of_the_service_exist(services: dict[str, dict[str, Any]]) -> None:
    known = {PREFIX + entry.name.upper() for entry in fields(Settings)}
    image = read_stages(CHECKOUT / "Dockerfile")[-1].environment
    given = {name for service in OURS for name in services[service]["environment"]} | set(image)
    assert {name for name in given if name.startswith(PREFIX)} <= known
    database = services["database"]["environment"]
    for name in OURS:
        url = services[name]["environment"][f"{PREFIX}DATABASE_URL"]
        assert url.startswith("postgresql+psycopg://" + database["POSTGRES_USER"] + ":")
        assert url.endswith("@database:5432/" + database["POSTGRES_DB"])


def test_the_proxy_gets_what_its_file_asks_for(services: dict[str, dict[str, Any]]) -> None:
    caddyfile = (CHECKOUT / "deploy" / "Caddyfile").read_text()
    asked = set(re.findall(r"\{\$(\w+)", caddyfile))
    assert asked == set(services["proxy"]["environment"])
    assert caddyfile.count("{") == caddyfile.count("}")
