"""What all profiles share."""

from __future__ import annotations

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field


class Profile(BaseModel):
    """A frozen model in which an unknown key, NaN or infinity is an error."""

    # built when first used: a command uses a few of the models, and of most only as parts of others
    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False, defer_build=True)


Length = Annotated[float, Field(ge=0, le=10)]
"""Metres, from 0 to 10: a value in millimetres is an error."""
PositiveLength = Annotated[float, Field(gt=0, le=10)]
"""Metres, above 0."""
Step = Annotated[float, Field(ge=1e-4, le=10)]
"""Metres; a tenth of a millimetre at least, for many short steps would take for ever."""
