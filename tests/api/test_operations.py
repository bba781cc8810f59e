from __future__ import annotations

import time

from tests.api.serving import PROBLEM_TYPE, START_S, Served, assert_problem


def test_the_service_says_that_it_lives_and_is_ready(served: Served) -> None:
    assert served.client.get("/healthz").json() == {"status": "ok"}
    deadline_s = time.monotonic() + START_S  # the worker comes up beside the service
    while (checks := served.client.get("/readyz").json()["checks"])["builds"] != "ok":
        assert time.monotonic() < deadline_s, checks
        time.sleep(0.1)
    assert served.client.get("/readyz").status_code == 200
    assert set(checks) == {"database", "migrations", "photographs", "locate_workers", "serving", "disk", "builds"}
    assert set(checks.values()) == {"ok"}


def test_the_clock_is_utc(served: Served) -> None:
    before_s = time.time()
    server_time_s = served.client.get("/time").json()["server_time_s"]
    assert before_s <= server_time_s <= time.time()


def test_wrong_addresses_and_methods_are_problems_too(served: Served) -> None:
    assert_problem(served.client.get("/nowhere"), 404, "not-found")
    for path, methods in (
        ("/sites", "GET, POST"),
        ("/sites/x", "DELETE, GET, PATCH"),
        ("/surveys/x/images/y", "GET, PUT"),
    ):
        refused = served.client.request("TRACE", path)
        assert "TRACE" in assert_problem(refused, 405, "method-not-allowed")["detail"]
        assert refused.headers["allow"] == methods


def test_the_document_describes_every_problem(served: Served) -> None:
    document = served.client.get("/openapi.json").json()
    assert document["openapi"].startswith("3.1")
    assert "Problem" in document["components"]["schemas"]
    for path, methods in document["paths"].items():
        for method, call in methods.items():
            described = {status for status in call["responses"] if status.startswith(("4", "5"))}
            for status in described - {"503"}:
                assert list(call["responses"][status]["content"]) == [PROBLEM_TYPE], (method, path, status)
            if "{" in path:
                assert "404" in described, (method, path)
            if method in ("post", "put", "patch") and not path.endswith(("activate", "cancel")):
                assert "422" in described, (method, path)
