"""Bombs, pictures that are two things, broken ones: each a refusal or a pose, none a fault, none kept by mistake."""

from __future__ import annotations

import pytest

from tests.api.serving import hurried
from tests.faults.hostile_pictures import LOCATED, REFUSED, endless_scans, truncated
from tests.faults.ledger import SNAPSHOT_BYTES, Ledger

CUTS = 12
SCANS = 2000
LIMIT_S = 1.0  # far less than so many scans take


@pytest.mark.parametrize("name", LOCATED)
def test_what_else_is_in_a_file_changes_nothing(ledger: Ledger, name: str) -> None:
    assert ledger.locate(LOCATED[name]).status_code == 200
    assert ledger.upload(f"{name}.jpg", LOCATED[name]).status_code == 201


def test_no_two_of_them_are_one_photograph(ledger: Ledger) -> None:
    digests = {ledger.upload(f"{name}.jpg", data).json()["sha256"] for name, data in LOCATED.items()}
    assert len(digests) == len(LOCATED)


@pytest.mark.parametrize("name", REFUSED)
def test_a_hostile_picture_is_refused(ledger: Ledger, name: str) -> None:
    data, statuses = REFUSED[name]
    located = ledger.locate(data)
    assert located.status_code in statuses, located.text
    taken = ledger.upload(f"{name}.jpg", data)
    assert taken.status_code in (201, 413, 415), taken.text
    # What a survey takes by its header a build may still leave out; what it refuses it does not keep.
    listed = ledger.served.client.get(f"/surveys/{ledger.survey_id}/images", params={"limit": "1000"}).json()["images"]
    assert (f"{name}.jpg" in {photo["name"] for photo in listed}) == (taken.status_code == 201)


def test_a_snapshot_cut_anywhere_is_no_snapshot(ledger: Ledger) -> None:
    for data in truncated(seed=4, count=CUTS):
        assert ledger.locate(data).status_code == 415


def test_a_body_that_is_packed_is_not_unpacked(ledger: Ledger) -> None:
    url = ledger.served.client.base_url.join("/locate")
    packed, _ = REFUSED["gzip of a picture"]
    headers = {"Content-Encoding": "gzip"}
    answer = ledger.served.client.post(url, params={"site_id": ledger.site_id}, content=packed, headers=headers)
    assert answer.status_code == 415


def test_a_picture_of_endless_work_costs_its_own_time_only(ledger: Ledger) -> None:
    assert len(endless_scans(SCANS)) < 20 * len(SNAPSHOT_BYTES)
    with hurried(ledger.served, LIMIT_S):
        assert ledger.locate(endless_scans(SCANS)).status_code == 504
    ledger.check()
