"""What all profiles share."""

from __future__ import annotations

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field


class Profile(BaseModel):
    """A frozen model in which an unknown key, NaN, infinity, or anything but a number for a number is an error."""

    # built when first used: a command uses a few of the models, and of most only as parts of others
    model_config = ConfigDict(frozen=True, extra="forbid", strict=True, allow_inf_nan=False, defer_build=True)


Length = Annotated[float, Field(ge=0, le=10)]
"""Metres, from 0 to 10: a value in millimetres is an error."""
Derived = Annotated[float, Field(ge=0, le=10, json_schema_extra={"type": ["number", "null"]})]
"""The same of a length that may be null in a profile: then it follows from others (`profiles/derived.py`)."""
Size = Annotated[float, Field(ge=1e-4, le=10)]
"""Metres; a tenth of a millimetre at least, below which no part of a hand or an arm can be made."""
Step = Annotated[float, Field(ge=1e-4, le=10)]
"""Metres; a tenth of a millimetre at least, for many short steps would take for ever."""
Place = Annotated[float, Field(ge=-10, le=10)]
"""Metres from an origin nearby, to either side of it."""
FarPlace = Annotated[float, Field(ge=-1e4, le=1e4)]
"""Metres; no farther than points are believed to have been measured."""
Turn = Annotated[float, Field(ge=-720, le=720)]
"""Degrees, two turns to either side at most."""
Angle = Annotated[float, Field(ge=0.01, le=180)]
"""Degrees, half a turn at most, and more than nothing."""
Share = Annotated[float, Field(ge=1e-4, lt=1)]
"""Of a whole, and less than all of it."""
