"""The base of every table of a case: strict, frozen, and checked by its own rules."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Self

from pydantic import BaseModel, ConfigDict, Discriminator, Field, model_validator

from tyrefrf.case.faults import Fault, refusal, shown

Name = Annotated[str, Field(pattern=r"^[^\x00-\x1f\x7f]{1,100}$")]
"""A name that labels a curve: one line, stored in the results."""


class Table(BaseModel):
    """A table of the case file. Unknown keys, wrong types, infinities and NaN are refused."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, allow_inf_nan=False)

    def _faults(self) -> Iterator[Fault]:
        """Yield what is wrong between the keys of this table; each key is right by itself."""
        yield from ()

    @model_validator(mode="after")
    def _obey(self) -> Self:
        faults = tuple(self._faults())
        if faults:
            raise refusal(*faults)
        return self


def by_kind(default: str | None) -> Discriminator:
    """Choose among tables by their `kind`; `default` where it is left out, if it may be."""

    def kind(entry: object) -> str | None:
        value = (
            entry.get("kind", default)
            if isinstance(entry, dict)
            else getattr(entry, "kind", default)
        )
        return value if value is None or isinstance(value, str) else shown(value)

    return Discriminator(kind)
