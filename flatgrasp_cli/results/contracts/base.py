"""What all parts of a document share. Numbers are finite or null; lengths are metres, in the document's `frame_id`.

Parts are typed dictionaries: plain ones when a document is written, checked by mypy; pydantic makes their JSON Schema.
"""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field
from typing_extensions import TypedDict  # typing's own tells pydantic too little before Python 3.12

Number = Annotated[float, Field(allow_inf_nan=False)]
Vector2 = tuple[Number, Number]
Vector3 = tuple[Number, Number, Number]
Vector4 = tuple[Number, Number, Number, Number]
JointAngles = Annotated[list[Number], Field(min_length=6, max_length=7)]
Status = Literal["ok", "no_grasp"]


class Part(TypedDict):
    """A part of a document: all of its keys are there, and no others."""
