"""Alerts, the dashboard and the page about them speak of metrics that there are, and the page of all of them."""

from __future__ import annotations

import ast
import json
import re
from collections.abc import Iterator
from itertools import chain
from pathlib import Path
from typing import Any

import pytest
import yaml
from prometheus_client import CollectorRegistry, generate_latest
from prometheus_client.parser import text_string_to_metric_families

import app
from app.api.http_metrics import HttpMetrics
from app.jobs.pool import WorkerPool
from app.services.metrics import ServiceMetrics
from app.services.metrics_of_pools import ConnectionMetrics, PoolMetrics
from app.services.metrics_of_process import process_registry
from app.services.metrics_of_stored import StoredMetrics
from app.storage.database import Database
from app.storage.photo_store import open_photo_store
from tests.databases import SqliteDatabases

CHECKOUT = Path(__file__).parents[2]
MONITORING = CHECKOUT / "deploy" / "monitoring"
PAGE = CHECKOUT / "docs" / "operations" / "monitoring.md"
NAME = re.compile(r"\b(?:scattermark|process|python)_[a-z0-9_]+\b")
ENDINGS = {"counter": ("_total",), "histogram": ("_bucket", "_sum", "_count"), "gauge": ("",)}


@pytest.fixture(scope="module")
def kinds(sqlite: SqliteDatabases, tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    """Every metric of servers and workers, and its kind."""
    database = Database(sqlite.migrated())
    photos = open_photo_store(str(tmp_path_factory.mktemp("photographs")))
    service, registry = ServiceMetrics(), process_registry()
    for collector in (PoolMetrics({"locate": WorkerPool(1, 1)}), ConnectionMetrics(database)):
        service.include(collector)
    service.include(StoredMetrics(database, photos))
    HttpMetrics(registry)
    registry.register(service)
    found = kinds_of(registry)
    database.close()
    return found


def kinds_of(registry: CollectorRegistry) -> dict[str, str]:
    families = text_string_to_metric_families(generate_latest(registry).decode())
    return {family.name: family.type for family in families if not family.name.endswith("_created")}


def samples(kinds: dict[str, str]) -> set[str]:
    """Names as queries use them."""
    return {name + ending for name, kind in kinds.items() for ending in ENDINGS[kind]}


def alerts() -> list[dict[str, Any]]:
    groups = yaml.safe_load((MONITORING / "alerts.yml").read_text())["groups"]
    return list(chain.from_iterable(group["rules"] for group in groups))


def queries() -> Iterator[str]:
    yield from (rule["expr"] for rule in alerts())
    dashboard = json.loads((MONITORING / "grafana-dashboard.json").read_text())
    for panel in dashboard["panels"]:
        yield from (target["expr"] for target in panel["targets"])


def test_queries_ask_for_metrics_that_there_are(kinds: dict[str, str]) -> None:
    asked = {name for query in queries() for name in NAME.findall(query)}
    assert asked and asked <= samples(kinds)


def test_queries_use_counters_by_their_rates(kinds: dict[str, str]) -> None:
    gauges = {name for name, kind in kinds.items() if kind == "gauge"}
    for query in queries():
        for function, name in re.findall(r"(\w+)\((\w+)[^()]*\[", query):
            assert (function == "delta") == (name in gauges), query


def test_the_page_names_every_metric_of_ours_and_no_other(kinds: dict[str, str]) -> None:
    ours = {name for name in samples(kinds) if name.startswith("scattermark_")}
    named = {name for name in NAME.findall(PAGE.read_text()) if name.startswith("scattermark_")}
    histograms = {name for name, kind in kinds.items() if kind == "histogram"}
    parts = {name + ending for name in histograms for ending in ENDINGS["histogram"]}
    assert named == ours - parts | {name for name in histograms if name.startswith("scattermark_")}


def test_the_page_and_the_rules_know_the_same_alerts() -> None:
    names = {rule["alert"] for rule in alerts()}
    assert set(re.findall(r"`(Scattermark[A-Z]\w+)`", PAGE.read_text())) == names


def test_tasks_and_routes_in_queries_and_on_the_page_exist() -> None:
    source = [ast.parse(path.read_text()) for path in Path(app.__file__).parent.rglob("*.py")]
    functions = {node.name for tree in source for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)}
    tasks = set(re.findall(r'task="(\w+)"', " ".join(queries())))
    tasks |= set(re.findall(r"`([a-z]+_[a-z_]+)`", PAGE.read_text().split("### Worker processes")[1].split("|")[0]))
    assert {"locate_photo", "detect_photo"} <= tasks <= functions
    assert set(re.findall(r'route="([^"]+)"', " ".join(queries()))) == {"/locate"}


def test_prometheus_asks_what_compose_runs() -> None:
    services = yaml.safe_load((CHECKOUT / "docker-compose.yml").read_text())["services"]
    scraped = yaml.safe_load((MONITORING / "prometheus.yml").read_text())
    ports = {
        "api": services["api"]["command"][services["api"]["command"].index("--port") + 1],
        "worker": services["worker"]["environment"]["SCATTERMARK_WORKER_METRICS_PORT"],
    }
    for job in scraped["scrape_configs"]:
        (found,) = job["dns_sd_configs"]
        (name,) = found["names"]
        assert job["job_name"] == f"scattermark-{name}" and str(found["port"]) == ports.pop(name)
    assert not ports
    assert all((MONITORING / file).is_file() for file in scraped["rule_files"])
