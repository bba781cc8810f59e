"""Targets to print over HTTP: sheets for a site and without one, single pictures."""

import cv2
import numpy as np
import pypdfium2

from app.targets.family import family_by_name
from app.vision.detectors import choose_detector
from tests.api.serving import PROBLEM_TYPE, ROOM, Served

GOLAY = family_by_name("golay")


def pages(pdf: bytes) -> list[str]:
    document = pypdfium2.PdfDocument(pdf)
    texts = [document[number].get_textpage().get_text_bounded() for number in range(len(document))]
    document.close()
    return texts


def test_sheets_come_as_a_pdf(served: Served) -> None:
    answer = served.client.get("/targets/sheets.pdf", params={"codes": "389,889", "size": "A5", "title": "Hall"})
    assert answer.status_code == 200, answer.text
    assert answer.headers["content-type"] == "application/pdf"
    texts = pages(answer.content)
    assert len(texts) == 2 and "389" in texts[0] and "u = 9 mm" in texts[0] and "Hall" in texts[0]


def test_sheets_for_a_site_are_its_own(served: Served) -> None:
    site_id = served.new_site(name="Lecture hall", plate_u_m=0.010)
    control = "name,code,dot,x_m,y_m,z_m,sigma_m,role\n" + "".join(
        f"p{index},{code},A,{index},{index * index},0.5,0.001,control\n" for index, code in enumerate((889, 1661, 2667))
    )
    assert served.put_control_points(site_id, control).status_code == 200
    answer = served.client.get("/targets/sheets.pdf", params={"count": 3, "site_id": site_id})
    assert answer.status_code == 200, answer.text
    text = "".join(pages(answer.content))
    assert "Lecture hall" in text and "u = 10 mm" in text
    assert not {"889", "1661", "2667"} & set(text.split())
    document = pypdfium2.PdfDocument(answer.content)
    rgb = document[0].render(scale=4, rev_byteorder=True).to_numpy()
    document.close()
    read, _, _ = cv2.QRCodeDetector().detectAndDecode(np.ascontiguousarray(rgb[len(rgb) // 2 :]))
    assert read.startswith(f"{served.client.base_url}".rstrip("/") + f"/#site_id={site_id}&code=")


def test_wishes_that_cannot_be_printed_are_problems(served: Served) -> None:
    site_id = served.new_site()
    cases: list[tuple[dict[str, str | int], int, str]] = [
        ({}, 422, "how many"),
        ({"codes": "388"}, 422, "no codes of the family"),
        ({"count": 1, "u_mm": 30}, 422, "too large"),
        ({"count": 1, "size": "B4"}, 422, "size"),
        ({"count": 1, "site_id": site_id, "u_mm": 9}, 422, "have u = 14 mm"),
        ({"count": 1, "site_id": "nowhere"}, 404, "nowhere"),
    ]
    for params, status, word in cases:
        answer = served.client.get("/targets/sheets.pdf", params=params)
        assert (answer.status_code, answer.headers["content-type"]) == (status, PROBLEM_TYPE), answer.text
        assert word in answer.json()["detail"]


def test_a_single_target_is_a_picture(served: Served) -> None:
    svg = served.client.get("/targets/389.svg", params={"u_mm": 9, "margin_u": 0})
    assert svg.headers["content-type"].startswith("image/svg+xml") and 'width="117.0000mm"' in svg.text
    png = served.client.get("/targets/389.png", params={"margin_u": 2, "px_per_u": 8})
    assert png.headers["content-type"] == "image/png"
    bgr = cv2.imdecode(np.frombuffer(png.content, dtype=np.uint8), cv2.IMREAD_COLOR)
    assert bgr is not None
    (target,) = choose_detector("default", "strict").detect(bgr.astype(np.uint8), GOLAY).targets
    assert target.code == 389
    assert served.client.get("/targets/388.svg").status_code == 404
    assert served.client.get("/targets/0.png").status_code == 422


def test_printed_control_points_of_the_example_stay_out_of_its_sheets(served: Served) -> None:
    site_id = served.new_site()
    text = (ROOM / "control_points.csv").read_text()
    assert served.put_control_points(site_id, text).status_code == 200
    controlled = {row.split(",")[1] for row in text.splitlines()[1:]}
    answer = served.client.get("/targets/sheets.pdf", params={"count": 20, "site_id": site_id})
    printed = {word for page in pages(answer.content) for word in page.split()}
    assert not controlled & printed
