from __future__ import annotations

import pytest

from tests.api.serving import Served, assert_problem, room_control_points


def test_a_site_is_made_shown_changed_and_removed(served: Served) -> None:
    body = {"name": " Halle 3 ", "code_family": "golay", "plate_u_m": 0.02}
    made = served.client.post("/sites", json=body)
    assert made.status_code == 201
    site = made.json()
    assert (site["name"], site["code_family"], site["plate_u_m"]) == ("Halle 3", "golay", 0.02)
    assert (site["geo_anchor"], site["map_version"]) == (None, None)
    url = f"/sites/{site['site_id']}"
    assert served.client.get(url).json() == site
    anchor = {"latitude_deg": 48.15, "longitude_deg": 11.57, "height_m": 515.0, "azimuth_deg": 30.0}
    changed = served.client.patch(url, json={"name": "hall", "geo_anchor": anchor}).json()
    assert (changed["name"], changed["geo_anchor"]) == ("hall", anchor)
    assert served.client.patch(url, json={"geo_anchor": None}).json()["geo_anchor"] is None
    assert served.client.delete(url).status_code == 204
    assert_problem(served.client.get(url), 404, "not-found")
    assert_problem(served.client.delete(url), 404, "not-found")


def test_lists_come_in_pages(served: Served) -> None:
    made = {served.new_site(name=f"page {index}") for index in range(3)}
    found: set[str] = set()
    cursor: str | None = None
    while True:
        query = {"limit": "2", **({"cursor": cursor} if cursor else {})}
        page = served.client.get("/sites", params=query).json()
        assert len(page["sites"]) <= 2
        found |= {site["site_id"] for site in page["sites"]}
        cursor = page["next_cursor"]
        if cursor is None:
            break
    assert made <= found


@pytest.mark.parametrize(
    ("body", "field"),
    [
        ({}, "name"),
        ({"name": ""}, "name"),
        ({"name": "a\u0000b"}, "name"),
        ({"name": "x" * 201}, "name"),
        ({"name": "room", "code_family": "colay"}, "code_family"),
        ({"name": "room", "plate_u_m": 0}, "plate_u_m"),
        ({"name": "room", "plate_u_m": 14}, "plate_u_m"),  # millimetres for metres
        ({"name": "room", "plate_u_m": "wide"}, "plate_u_m"),
        ({"name": "room", "plate_u_m": True}, "plate_u_m"),
        ({"name": "room", "plate_u_m": "0.02"}, "plate_u_m"),
        ({"name": "\u202emoor"}, "name"),
        ({"name": "room", "plate_size": 0.1}, "plate_size"),
        ({"name": "room", "geo_anchor": {"latitude_deg": 91, "longitude_deg": 0}}, "latitude_deg"),
    ],
)
def test_a_site_that_cannot_be_is_refused(served: Served, body: dict[str, object], field: str) -> None:
    problem = assert_problem(served.client.post("/sites", json=body), 422, "invalid-input")
    assert any(field in error["field"] for error in problem["errors"])
    assert field in problem["detail"]


def test_what_is_fixed_for_a_site_cannot_be_changed(served: Served) -> None:
    site_id = served.new_site()
    for body in ({"plate_u_m": 0.02}, {"code_family": "full"}, {}):
        assert_problem(served.client.patch(f"/sites/{site_id}", json=body), 422, "invalid-input")


def test_control_points_come_as_csv_or_json_and_go_as_a_whole(served: Served) -> None:
    site_id = served.new_site()
    url = f"/sites/{site_id}/control-points"
    assert served.client.get(url).json() == {"site_id": site_id, "control_points": []}
    from_csv = served.put_control_points(site_id, room_control_points())
    assert from_csv.status_code == 200
    points = from_csv.json()["control_points"]
    assert len(points) == 12
    assert points[0] == {
        "name": "CP1",
        "code": 16925,
        "dot": "A",
        "x_m": 2.4788,
        "y_m": 0.0106,
        "z_m": 1.6041,
        "sigma_m": 0.001,
        "role": "control",
    }
    assert served.client.put(url, json=points).json() == from_csv.json()
    assert served.client.get(url).json() == from_csv.json()
    assert served.client.put(url, json=[]).json()["control_points"] == []
