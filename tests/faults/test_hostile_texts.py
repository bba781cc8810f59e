"""Names that are paths, JSON that is none, forms of a hundred thousand parts, headers that carry other headers."""

from __future__ import annotations

import json
from pathlib import Path
from urllib.parse import quote

import httpx
import pytest

from tests.api.serving import PROBLEM_TYPE, room_photos
from tests.faults.ledger import SNAPSHOT_BYTES, Ledger
from tests.faults.wire import connected, exchange, first_status, head

PHOTO = room_photos("survey")["IMG_0006.jpg"]

PATHS = [
    "../escaped.jpg",
    "../../../../etc/cron.d/escaped",
    "/etc/escaped.jpg",
    "..\\..\\escaped.jpg",
    "%2e%2e%2fescaped.jpg",
    "a/../../escaped.jpg",
    "a/b.jpg",
    ".",
    "..",
    ".hidden.jpg",
    "-rf.jpg",
    "a\0.jpg",
    "a\nb.jpg",
    "a\r\nX-Evil: 1.jpg",
    "\u202egpj.exe",
    "a\u2028b.jpg",
    "a\uff0fb.jpg",
    "\ud83d\ude00.jpg".encode("utf-16", "surrogatepass").decode("utf-16"),
    "x" * 151,
    " ",
    "",
    "<script>alert(1)</script>.jpg",
    "'; DROP TABLE photographs; --",
    "$(reboot).jpg",
    "a\u0000",
]
# Odd to some file systems; here a name is a label and the bytes lie under their digest.
LABELS = [
    "CON",
    "nul.jpg",
    "a" * 150,
    "Straße 12 (Süd).jpg",
    "写真.jpg",
    "__init__.py",
    "a.jpg.exe",
    "~a"[1:] + "~1.jpg",
]


@pytest.mark.parametrize("name", PATHS, ids=ascii)
def test_a_name_that_is_a_path_is_no_name(ledger: Ledger, name: str) -> None:
    before = every_file(ledger)
    client = ledger.served.client
    raw = client.put(f"/surveys/{ledger.survey_id}/images/{quote(name, safe='')}", content=PHOTO)
    form = client.post(f"/surveys/{ledger.survey_id}/images", files=[("images", (name, PHOTO))])
    for answer in (raw, form):
        assert answer.status_code in (400, 404, 405, 422), answer.text
        assert answer.headers["content-type"] == PROBLEM_TYPE
        assert "x-evil" not in answer.headers
    assert every_file(ledger) == before


def every_file(ledger: Ledger) -> set[Path]:
    """What lies in the service's folder and beside it, but for the database's own."""
    folder = ledger.served.settings.data_dir
    return {path for path in folder.parent.rglob("*") if path.is_file() and ".db" not in path.name}


@pytest.mark.parametrize("name", LABELS, ids=ascii)
def test_a_name_is_a_label_on_every_system(ledger: Ledger, name: str) -> None:
    assert ledger.upload(quote(name), PHOTO).status_code in (200, 201)
    stored = [path.name for path in every_file(ledger)]
    assert name not in stored


def test_the_two_ways_to_write_an_umlaut_are_one_name(ledger: Ledger) -> None:
    composed, decomposed = "Tür.jpg", "Tu\u0308r.jpg"
    assert ledger.upload(quote(composed), PHOTO).status_code == 201
    assert ledger.upload(quote(decomposed), PHOTO).status_code == 200


# JSON

DEEP = 200_000
JSONS = {
    "deep lists": b"[" * DEEP + b"]" * DEEP,
    "deep objects": b'{"name":' * DEEP + b"1" + b"}" * DEEP,
    "a huge integer": b'{"name": "x", "plate_u_m": 1' + b"0" * 100_000 + b"}",
    "a huge exponent": b'{"name": "x", "plate_u_m": 1e999999}',
    "no number": b'{"name": "x", "plate_u_m": NaN}',
    "no end": b'{"name": "x", "plate_u_m": Infinity}',
    "a lone surrogate": b'{"name": "\\ud800"}',
    "a NUL": b'{"name": "a\\u0000b"}',
    "not UTF-8": b'{"name": "\xff\xfe"}',
    "names that classes have": b'{"name": "x", "__proto__": {}, "__class__": "y"}',
    "many fields": json.dumps({f"field{number}": number for number in range(50_000)}).encode(),
    "a long name": json.dumps({"name": "x" * 1_000_000}).encode(),
    "another kind": b'{"name": ["x"]}',
}


@pytest.mark.parametrize("name", JSONS)
def test_json_that_is_none_is_refused_wherever_it_comes(ledger: Ledger, name: str) -> None:
    client, headers = ledger.served.client, {"Content-Type": "application/json"}
    sites = len(client.get("/sites", params={"limit": "1000"}).json()["sites"])
    answers = [
        client.post("/sites", content=JSONS[name], headers=headers),
        client.put(f"/sites/{ledger.site_id}/control-points", content=JSONS[name], headers=headers),
        client.post(f"/surveys/{ledger.survey_id}/build", content=JSONS[name], headers=headers),
        client.post(
            "/locate", data={"site_id": ledger.site_id, "camera": JSONS[name]}, files={"image": SNAPSHOT_BYTES}
        ),
    ]
    for answer in answers:
        assert answer.status_code in (400, 413, 422), answer.text
        assert answer.headers["content-type"] == PROBLEM_TYPE
        json.loads(answer.content, parse_constant=_no_constant)
    assert len(client.get("/sites", params={"limit": "1000"}).json()["sites"]) == sites


def _no_constant(text: str) -> None:
    raise AssertionError(f"{text} is no JSON")


def test_of_a_field_given_twice_the_last_counts_and_nothing_else_happens(ledger: Ledger) -> None:
    answer = ledger.served.client.post(
        "/sites", content=b'{"name": "one", "name": "two"}', headers={"Content-Type": "application/json"}
    )
    assert answer.json()["name"] == "two"


# Forms


def form(*parts: bytes) -> bytes:
    return b"".join(b"--x\r\n" + part + b"\r\n" for part in parts) + b"--x--\r\n"


def field(name: str, value: bytes = b"v", more: bytes = b"") -> bytes:
    return f'Content-Disposition: form-data; name="{name}"'.encode() + more + b"\r\n\r\n" + value


FORMS = {
    "many fields": form(*[field(f"f{number}") for number in range(100_000)]),
    "many files": form(*[field("image", more=b'; filename="a.jpg"') for _ in range(100_000)]),
    "a long header": form(field("a", more=b"\r\nX-Long: " + b"y" * 5_000_000)),
    "many headers": form(field("a", more=b"\r\nX: y" * 100_000)),
    "a long field": form(field("site_id", b"z" * 5_000_000)),
    "a long name": form(field("n" * 1_000_000)),
    "no name": form(b"Content-Disposition: form-data\r\n\r\nv"),
    "no header": form(b"\r\nv"),
    "no end": form(field("site_id"))[:-6],
    "nothing": b"",
    "only its end": b"--x--\r\n",
    "another boundary": form(field("site_id")).replace(b"--x", b"--y"),
}


@pytest.mark.parametrize("target", ["/locate", "/surveys/{survey_id}/images"])
@pytest.mark.parametrize("name", FORMS)
def test_a_form_that_is_none_is_refused(ledger: Ledger, name: str, target: str) -> None:
    headers = {"Content-Type": "multipart/form-data; boundary=x"}
    url = target.format(survey_id=ledger.survey_id)
    answer = ledger.served.client.post(url, content=FORMS[name], headers=headers)
    assert answer.status_code in (400, 413, 415, 422), answer.text
    assert answer.headers["content-type"] == PROBLEM_TYPE


@pytest.mark.parametrize("boundary", [";", "boundary=", "boundary=" + "x" * 5000, 'boundary="\\"', "charset=utf-7"])
def test_a_form_without_a_boundary_is_refused(ledger: Ledger, boundary: str) -> None:
    headers = {"Content-Type": f"multipart/form-data; {boundary}"}
    answer = ledger.served.client.post("/locate", content=form(field("site_id")), headers=headers)
    assert answer.status_code in (400, 422), answer.text


# Headers and addresses


@pytest.mark.parametrize(
    "request_bytes",
    [
        b"GET /healthz HTTP/1.1\r\nHost: localhost\r\nX: " + b"y" * 200_000 + b"\r\n\r\n",
        b"GET /healthz HTTP/1.1\r\nHost: localhost\r\n" + b"X: y\r\n" * 200_000 + b"\r\n",
        b"GET /" + b"a" * 200_000 + b" HTTP/1.1\r\nHost: localhost\r\n\r\n",
        b"GET /healthz HTTP/1.1\r\nHost: localhost\r\nX\0: y\r\n\r\n",
        b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03" + bytes(500),
        b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n",
        bytes(range(256)) * 100,
    ],
    ids=["a long header", "many", "a long address", "a NUL", "TLS", "HTTP/2", "noise"],
)
def test_what_is_no_http_is_sent_away(ledger: Ledger, request_bytes: bytes) -> None:
    status, _ = exchange(ledger.served, request_bytes)
    assert status == 0 or 400 <= status < 500


@pytest.mark.parametrize("target", ["/sites/%0d%0aX-Evil:%201", "/sites?cursor=%0d%0aX-Evil:%201", "/%00", "/%ff%fe"])
def test_no_header_is_carried_in_by_an_address(ledger: Ledger, target: str) -> None:
    with connected(ledger.served) as connection:
        connection.sendall(head("GET", target, Connection="close"))
        received = b""
        while part := connection.recv(65536):
            received += part
    lines = received.partition(b"\r\n\r\n")[0].lower()
    assert b"\r\nx-evil" not in lines
    assert b"application/problem+json" in lines


def test_headers_that_we_read_are_read_with_care(ledger: Ledger) -> None:
    client = ledger.served.client
    for headers in (
        {"X-Request-ID": "a" * 10_000},
        {"X-Request-ID": "<script>"},
        {"Accept": "text/html," * 5_000},
        {"Last-Event-ID": "9" * 10_000},
        {"Range": "bytes=0-1,1-2,2-3"},
        {"X-HTTP-Method-Override": "DELETE"},
        {"X-Forwarded-Prefix": "/evil", "X-Forwarded-Host": "evil.example"},
    ):
        answer = client.get(f"/sites/{ledger.site_id}", headers=headers)
        assert answer.status_code == 200
        assert "evil" not in answer.text
        assert "<" not in answer.headers.get("X-Request-ID", "")


def test_a_query_of_a_hundred_thousand_parameters_is_read_like_any_other(ledger: Ledger) -> None:
    query = "&".join(f"p{number}=1" for number in range(5_000))
    with connected(ledger.served) as connection:
        connection.sendall(head("GET", f"/sites?limit=1&{query}", Connection="close"))
        assert first_status(connection) == 200


@pytest.mark.parametrize("method", ["TRACE", "CONNECT", "PROPFIND", "get", "X" * 1000])
def test_a_method_that_nothing_takes_is_refused(ledger: Ledger, method: str) -> None:
    with connected(ledger.served) as connection:
        connection.sendall(head(method, "/sites", Connection="close"))
        assert first_status(connection) in (400, 404, 405)


def test_a_client_that_waits_for_leave_is_told_no_before_it_sends(ledger: Ledger) -> None:
    with connected(ledger.served) as connection:
        request = head(
            "PUT", "/surveys/nowhere/images/a.jpg", Content_Length=10**7, Expect="100-continue", Connection="close"
        )
        connection.sendall(request)
        assert first_status(connection) == 404


def test_html_in_a_name_is_never_answered_as_a_page(ledger: Ledger) -> None:
    client: httpx.Client = ledger.served.client
    site = client.post("/sites", json={"name": "<script>alert(1)</script>"}).json()
    for path in (f"/sites/{site['site_id']}", "/sites/<script>alert(1)</script>", "/<script>"):
        answer = client.get(path, headers={"Accept": "text/html"})
        assert answer.headers["content-type"].startswith("application/")
