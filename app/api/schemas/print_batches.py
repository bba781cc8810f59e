"""Print batches."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated

from pydantic import BaseModel, Field

from app.api.schemas.common import Body, Finite
from app.api.schemas.texts import Text
from app.geometry.print_batch import PrintBatch
from app.services.print_batches import BatchEntry, BatchLimits, text_of_codes
from app.targets.digits import CODE_COUNT

Millimetres = Annotated[Finite, Field(ge=BatchLimits.least_bar_mm, le=BatchLimits.greatest_bar_mm)]
Codes = Annotated[list[Annotated[int, Field(ge=1, lt=CODE_COUNT)]], Field(min_length=1, max_length=CODE_COUNT)]
CodesText = Annotated[str, Field(pattern=r"^[1-9][0-9]{0,5}(-[1-9][0-9]{0,5})?(,[1-9][0-9]{0,5}(-[1-9][0-9]{0,5})?)*$")]


class PrintBatchBody(Body):
    """Sheets printed in one go, and their check bars as measured."""

    name: Text
    codes: Annotated[
        Codes | CodesText,
        Field(description="A list, or a text such as 389,400-420: of a range those that the family holds."),
    ]
    bar_across_mm: Annotated[Millimetres, Field(description="Across the paper: the plates' x; should be 100.")]
    bar_along_mm: Annotated[Millimetres, Field(description="Along the paper: the plates' y; should be 100.")]
    sigma_mm: Annotated[Finite, Field(ge=BatchLimits.least_sigma_mm, le=BatchLimits.greatest_sigma_mm)] = 0.2

    def to_domain(self) -> BatchEntry:
        """The entry as services know it."""
        codes = self.codes if isinstance(self.codes, str) else text_of_codes(self.codes)
        return BatchEntry(self.name, codes, self.bar_across_mm, self.bar_along_mm, self.sigma_mm)


class PrintBatchesBody(Body):
    """All print batches of a site."""

    print_batches: Annotated[list[PrintBatchBody], Field(max_length=BatchLimits.most)]


class PrintBatchAnswer(BaseModel):
    """A print batch."""

    name: str
    codes: list[int]
    bar_across_mm: float
    bar_along_mm: float
    sigma_mm: float


class PrintBatchesAnswer(BaseModel):
    """All print batches of a site."""

    site_id: str
    print_batches: list[PrintBatchAnswer]

    @classmethod
    def of(cls, site_id: str, batches: Sequence[PrintBatch]) -> PrintBatchesAnswer:
        """The answer for a site's batches."""
        return cls(site_id=site_id, print_batches=[PrintBatchAnswer(**vars(batch)) for batch in batches])
