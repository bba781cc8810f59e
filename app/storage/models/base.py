"""What all tables share: names of constraints, kinds of columns. Times are UTC seconds, arrays float64 blobs."""

from __future__ import annotations

from typing import Annotated, Any

from sqlalchemy import (
    JSON,
    BigInteger,
    Double,
    ForeignKey,
    LargeBinary,
    MetaData,
    String,
    Text,
)
from sqlalchemy.orm import DeclarativeBase, mapped_column

# Every constraint has a name, so that a migration can find it on any database.
NAMING = {
    "ix": "ix_%(table_name)s_%(column_0_N_name)s",
    "uq": "uq_%(table_name)s_%(column_0_N_name)s",
    "fk": "fk_%(table_name)s_%(column_0_N_name)s",
    "pk": "pk_%(table_name)s",
}

Id = Annotated[str, mapped_column(String(36), primary_key=True)]
Short = Annotated[str, mapped_column(String(200))]
Long = Annotated[str, mapped_column(Text())]
Digest = Annotated[str, mapped_column(String(64))]
Number = Annotated[float, mapped_column(Double())]
Blob = Annotated[bytes, mapped_column(LargeBinary())]
Size = Annotated[int, mapped_column(BigInteger())]
Json = Annotated[dict[str, Any], mapped_column(JSON())]
JsonList = Annotated[list[Any], mapped_column(JSON())]
OfSite = Annotated[str, mapped_column(String(36), ForeignKey("sites.id", ondelete="CASCADE"), index=True)]
OfSurvey = Annotated[str, mapped_column(String(36), ForeignKey("surveys.id", ondelete="CASCADE"), index=True)]
OfMap = Annotated[str, mapped_column(String(36), ForeignKey("target_maps.id", ondelete="CASCADE"))]


class Base(DeclarativeBase):
    """Common ground of all tables."""

    metadata = MetaData(naming_convention=NAMING)
