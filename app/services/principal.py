"""Who asks: the holder of a key, or whoever sits at this machine when no keys are asked for."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from typing import Literal, get_args

from app.errors import InvalidInput, NotFound

Scope = Literal["locate", "survey", "analyse", "admin"]
SCOPES: tuple[Scope, ...] = get_args(Scope)


def checked_scopes(names: Collection[str]) -> tuple[Scope, ...]:
    """Scopes by their names, in the order of the list above, each once.

    Raises
    ------
    InvalidInput
        For none, and for one that does not exist.
    """
    unknown = sorted(set(names).difference(SCOPES))
    if unknown or not names:
        raise InvalidInput(
            f"a key has one or more of the scopes {', '.join(SCOPES)}, not {', '.join(unknown) or 'none'}",
            field="scopes",
        )
    return tuple(scope for scope in SCOPES if scope in names)


@dataclass(frozen=True)
class Principal:
    """Who asks and what they may do.

    Attributes
    ----------
    key_id : str or None
        None for those who need no key.
    name : str
        For people: the key's name.
    scopes : frozenset of Scope
        ``admin`` includes all others.
    site_ids : frozenset of str or None
        The only sites that there are for this principal; None for all.
    """

    key_id: str | None
    name: str
    scopes: frozenset[Scope]
    site_ids: frozenset[str] | None = None

    def __post_init__(self) -> None:
        if not self.scopes:
            raise ValueError("whoever may do nothing is nobody")

    def may(self, *scopes: str) -> bool:
        """Whether one of these scopes is held."""
        return "admin" in self.scopes or not self.scopes.isdisjoint(scopes)

    def sees(self, site_id: str) -> bool:
        """Whether a site is one of this principal's, whether or not it exists."""
        return self.site_ids is None or site_id in self.site_ids

    def site(self, site_id: str) -> str:
        """The id of a site that the principal names, unchanged.

        Raises
        ------
        NotFound
            When it is none of theirs: exactly as if it did not exist, so that a key learns nothing of other sites.
        """
        if not self.sees(site_id):
            raise NotFound(f"there is no site {site_id}; GET /sites lists them", site_id=site_id)
        return site_id


ANYONE = Principal(None, "without a key", frozenset(SCOPES))
