from __future__ import annotations

import uuid

from app.storage.ids import new_id


def test_ids_are_uuids_of_version_7_in_the_order_of_time() -> None:
    ids = [new_id() for _ in range(100)]
    assert len(set(ids)) == len(ids)
    assert all(uuid.UUID(made).version == 7 and uuid.UUID(made).variant == uuid.RFC_4122 for made in ids)
    milliseconds = [uuid.UUID(made).int >> 80 for made in ids]
    assert milliseconds == sorted(milliseconds)
