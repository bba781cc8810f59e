from __future__ import annotations

import base64

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.errors import InvalidInput
from app.storage.paging import PageRequest, cursor_of, page_of

printable = st.text(min_size=1).filter(str.isprintable)


@given(printable)
def test_a_cursor_says_where_the_next_page_begins(key: str) -> None:
    assert PageRequest(cursor=cursor_of(key)).after == key


@given(st.lists(st.integers(0, 9), max_size=8), st.integers(1, 8))
def test_pages_hold_no_more_than_asked(items: list[int], limit: int) -> None:
    page = page_of([(str(index), item) for index, item in enumerate(items)], limit)
    assert list(page.items) == items[:limit]
    assert (page.next_cursor is None) == (len(items) <= limit)


@pytest.mark.parametrize("cursor", ["ä", "a", base64.urlsafe_b64encode(b"\xff\xfe").decode(), cursor_of("\0")])
def test_a_made_up_cursor_is_refused(cursor: str) -> None:
    with pytest.raises(InvalidInput, match="cursor"):
        _ = PageRequest(cursor=cursor).after
