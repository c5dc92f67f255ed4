"""What all parts of a document share. Numbers are finite or null; lengths are metres, in the document's `frame_id`."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field

Number = Annotated[float, Field(allow_inf_nan=False)]
Vector2 = tuple[Number, Number]
Vector3 = tuple[Number, Number, Number]
Vector4 = tuple[Number, Number, Number, Number]
Vector6 = tuple[Number, Number, Number, Number, Number, Number]
Status = Literal["ok", "no_grasp"]


class Part(BaseModel):
    """A frozen part of a document."""

    model_config = ConfigDict(extra="forbid", frozen=True, defer_build=True)
