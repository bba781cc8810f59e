from __future__ import annotations

import numpy as np

from app.services.reporting.drawing import Label
from app.services.reporting.figures.labels import legible


def test_no_label_covers_another() -> None:
    places = [(0.0, 0.0), (10.0, 2.0), (40.0, 0.0), (0.0, 9.0)]
    labels = [Label(np.array(place), "12345", size=8.0) for place in places]
    assert legible(labels) == [labels[0], labels[2], labels[3]]
