"""What all profiles share."""

from __future__ import annotations

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field


class Profile(BaseModel):
    """A frozen model in which an unknown key, NaN or infinity is an error."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)


Length = Annotated[float, Field(ge=0, le=10)]
"""Metres, from 0 to 10: a value in millimetres is an error."""
PositiveLength = Annotated[float, Field(gt=0, le=10)]
"""Metres, above 0."""
