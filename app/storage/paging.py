"""Lists by cursor: a page and where the next one begins."""

from __future__ import annotations

import base64
import binascii
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Generic, TypeVar

from app.errors import InvalidInput

Item = TypeVar("Item")

GREATEST_PAGE = 1000
BAD_CURSOR = "no page gave this cursor; start again without one"


@dataclass(frozen=True)
class PageRequest:
    """Which part of a list is wanted; ``cursor`` is what the page before said."""

    limit: int = 100
    cursor: str | None = None

    @property
    def after(self) -> str | None:
        """The key after which the page begins.

        Raises
        ------
        InvalidInput
            For a cursor that no page gave.
        """
        if self.cursor is None:
            return None
        try:
            key = base64.urlsafe_b64decode(self.cursor.encode("ascii")).decode("utf-8")
        except (binascii.Error, UnicodeError) as error:
            raise InvalidInput(BAD_CURSOR, field="cursor") from error
        if not key.isprintable():
            raise InvalidInput(BAD_CURSOR, field="cursor")
        return key


@dataclass(frozen=True)
class Page(Generic[Item]):
    """Some items, and the cursor of the next page or None at the end."""

    items: tuple[Item, ...]
    next_cursor: str | None


def cursor_of(key: str) -> str:
    """The cursor of the page that begins after a key."""
    return base64.urlsafe_b64encode(key.encode("utf-8")).decode("ascii")


def page_of(items: list[tuple[str, Item]], limit: int) -> Page[Item]:
    """A page of keyed items that were read with one to spare."""
    more = len(items) > limit
    kept = items[:limit]
    return Page(tuple(item for _, item in kept), cursor_of(kept[-1][0]) if more else None)


def every(page: Callable[[PageRequest], Page[Item]]) -> Iterator[Item]:
    """All items of a list, page by page."""
    cursor: str | None = None
    while True:
        found = page(PageRequest(GREATEST_PAGE, cursor))
        yield from found.items
        cursor = found.next_cursor
        if cursor is None:
            return
