"""Uploads that are sent twice at once, break off, or lie about their length."""

from __future__ import annotations

import hashlib
import socket
import time
from collections import Counter
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

import httpx
import numpy as np
import pytest

from app.storage.models import PhotographRow, SnapshotRow
from tests.api.bad_photos import encoded
from tests.api.serving import room_photos
from tests.faults.ledger import SNAPSHOT_BYTES, Ledger, rows_of, wait_until
from tests.faults.wire import answer_of, connected, exchange, first_status, head

CROWD = 12
AGAIN_S = 0.05  # not the second that a refusal tells: the crowd shall stay one
PHOTOS = list(room_photos("survey").values())


def at_once(send: Callable[[int], httpx.Response]) -> list[httpx.Response]:
    with ThreadPoolExecutor(CROWD) as crowd:
        return list(crowd.map(send, range(CROWD)))


def statuses(answers: list[httpx.Response]) -> Counter[int]:
    return Counter(answer.status_code for answer in answers)


def names(ledger: Ledger) -> list[str]:
    images = ledger.served.client.get(f"/surveys/{ledger.survey_id}/images", params={"limit": "1000"}).json()["images"]
    return [image["name"] for image in images]


# The same at once


def test_the_same_photograph_from_many_is_one(ledger: Ledger) -> None:
    answers = at_once(lambda _: ledger.upload("same.jpg", PHOTOS[0]))
    assert statuses(answers) == {201: 1, 200: CROWD - 1}
    assert names(ledger).count("same.jpg") == 1


def test_one_name_for_many_photographs_is_the_first_ones(ledger: Ledger) -> None:
    answers = at_once(lambda number: ledger.upload("contested.jpg", PHOTOS[number]))
    assert statuses(answers) == {201: 1, 409: CROWD - 1}
    assert names(ledger).count("contested.jpg") == 1


def test_one_photograph_under_many_names_is_stored_once(ledger: Ledger) -> None:
    data = encoded(np.random.default_rng(7).integers(0, 255, (48, 64, 3), np.uint8), "JPEG")
    answers = at_once(lambda number: ledger.upload(f"copy {number}.jpg", data))
    assert statuses(answers) == {201: CROWD}
    assert len({answer.json()["sha256"] for answer in answers}) == 1


def test_a_snapshot_sent_by_many_at_once_is_one_pose(ledger: Ledger) -> None:
    before = rows_of(ledger, SnapshotRow)
    snapshot_id = "6f1c1f6e-0000-4000-8000-00000000000a"

    def send(_number: int) -> httpx.Response:
        while (answer := ledger.locate(snapshot_id=snapshot_id)).status_code == 503:
            time.sleep(AGAIN_S)  # one worker, and a crowd before it
        return answer

    answers = at_once(send)
    assert statuses(answers) == {200: CROWD}
    assert len({answer.json()["pose_id"] for answer in answers}) == 1
    assert rows_of(ledger, SnapshotRow) == before + 1


# Broken off


def put_head(ledger: Ledger, name: str, **headers: object) -> bytes:
    return head("PUT", f"/surveys/{ledger.survey_id}/images/{name}", **headers)


def multipart(name: str, data: bytes) -> bytes:
    disposition = f'Content-Disposition: form-data; name="images"; filename="{name}"'
    return b"\r\n".join([b"--frontier", disposition.encode(), b"", data])


FORM = {"Content_Type": "multipart/form-data; boundary=frontier"}


@pytest.mark.parametrize("share", [0.0, 0.001, 0.5, 0.999])
def test_a_raw_upload_that_breaks_off_leaves_nothing(ledger: Ledger, share: float) -> None:
    data = PHOTOS[1]
    request = put_head(ledger, "broken.jpg", Content_Length=len(data)) + data[: int(share * len(data))]
    status, _ = exchange(ledger.served, request)
    assert status in (0, 400, 415)
    assert "broken.jpg" not in names(ledger)


def test_a_form_that_breaks_off_leaves_nothing_of_its_whole_photographs_either(ledger: Ledger) -> None:
    whole, half = multipart("whole.jpg", PHOTOS[2]), multipart("half.jpg", PHOTOS[3][:1000])
    request = head("POST", f"/surveys/{ledger.survey_id}/images", Content_Length=10**6, **FORM)
    status, _ = exchange(ledger.served, request + whole + b"\r\n" + half)
    assert status in (0, 400, 415)
    assert not {"whole.jpg", "half.jpg"} & set(names(ledger))


# The form's parser forgets to close the file, which closes itself when it is collected, and warns.
@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
def test_a_form_without_its_last_line_leaves_nothing(ledger: Ledger) -> None:
    body = multipart("open.jpg", PHOTOS[2])
    request = head("POST", f"/surveys/{ledger.survey_id}/images", Content_Length=len(body), Connection="close", **FORM)
    status, _ = exchange(ledger.served, request + body)
    assert status in (400, 415, 422)
    assert "open.jpg" not in names(ledger)


def test_a_client_that_resets_its_connection_leaves_nothing(ledger: Ledger) -> None:
    before = rows_of(ledger, PhotographRow)
    for number in range(CROWD):
        with connected(ledger.served) as connection:
            connection.sendall(put_head(ledger, f"reset-{number}.jpg", Content_Length=10**6))
            connection.sendall(PHOTOS[0][:5000])
            # No farewell: the kernel answers with a reset instead of the end of a stream.
            connection.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, b"\x01\x00\x00\x00\x00\x00\x00\x00")
    assert rows_of(ledger, PhotographRow) == before


def test_a_client_that_leaves_before_its_answer_has_uploaded_all_or_nothing(ledger: Ledger) -> None:
    data = PHOTOS[4]
    with connected(ledger.served) as connection:
        connection.sendall(put_head(ledger, "unheard.jpg", Content_Length=len(data)) + data)
    # Whether the photograph was taken nobody heard; sending it again says.
    answer = ledger.upload("unheard.jpg", data)
    assert answer.status_code in (200, 201)
    assert answer.json()["bytes"] > 0


# Lengths that lie


def test_what_follows_a_body_of_the_promised_length_is_no_part_of_it(ledger: Ledger) -> None:
    data = PHOTOS[5]
    request = put_head(ledger, "longer.jpg", Content_Length=len(data))
    with connected(ledger.served) as connection:
        connection.sendall(request + data + b"and some more\r\n\r\n")
        assert first_status(connection) == 201
    assert ledger.upload("longer.jpg", data).status_code == 200


@pytest.mark.parametrize(
    "headers",
    [
        {"Content_Length": "-1"},
        {"Content_Length": "many"},
        {"Content_Length": "1e3"},
        {"Content_Length": "9" * 30},
        {"Transfer_Encoding": "gzip, chunked"},
        {"Transfer_Encoding": "identity"},
    ],
    ids=str,
)
def test_a_length_that_is_none_is_refused(ledger: Ledger, headers: dict[str, str]) -> None:
    status, _ = exchange(ledger.served, put_head(ledger, "odd.jpg", **headers) + PHOTOS[0][:100])
    assert status in (0, 400, 413, 415, 501)
    assert "odd.jpg" not in names(ledger)


@pytest.mark.parametrize(
    "body",
    [
        b"zz\r\nno number of bytes\r\n0\r\n\r\n",
        b"-5\r\nabcde\r\n0\r\n\r\n",
        b"fffffffffffffffff\r\nabc\r\n0\r\n\r\n",
        b"5\r\nabcdefgh\r\n0\r\n\r\n",
        b"5\r\nabc",
        b"a" * 100_000,
    ],
    ids=["no number", "negative", "enormous", "longer than said", "cut", "endless length"],
)
def test_broken_chunks_are_refused(ledger: Ledger, body: bytes) -> None:
    status, _ = exchange(ledger.served, put_head(ledger, "chunks.jpg", Transfer_Encoding="chunked") + body)
    assert status in (0, 400, 415)
    assert "chunks.jpg" not in names(ledger)


def test_two_lengths_are_no_way_to_smuggle_a_second_request(ledger: Ledger) -> None:
    inner = b"DELETE /sites/" + ledger.site_id.encode() + b" HTTP/1.1\r\nHost: localhost\r\n\r\n"
    both = put_head(ledger, "two.jpg", Content_Length=5, Transfer_Encoding="chunked") + b"0\r\n\r\n" + inner
    twice = head("POST", "/sites", Content_Length=4).replace(b"\r\n\r\n", b"\r\nContent-Length: 100\r\n\r\n") + inner
    for request in (both, twice):
        with connected(ledger.served) as connection:
            connection.sendall(request)
            connection.shutdown(socket.SHUT_WR)
            answer_of(connection)
    wait_until(lambda: ledger.served.client.get(f"/sites/{ledger.site_id}").status_code == 200, "the site is gone")


def test_a_photograph_that_was_interrupted_goes_on_by_being_sent_again(ledger: Ledger) -> None:
    data = SNAPSHOT_BYTES
    exchange(ledger.served, put_head(ledger, "resumed.jpg", Content_Length=len(data)) + data[:50_000])
    first, second = ledger.upload("resumed.jpg", data), ledger.upload("resumed.jpg", data)
    assert (first.status_code, second.status_code) == (201, 200)
    assert len(hashlib.sha256(data).hexdigest()) == len(first.json()["sha256"])
