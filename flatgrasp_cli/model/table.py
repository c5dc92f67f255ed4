"""Tables: columns with a row for each of many alike things."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Self

import numpy as np

from flatgrasp_cli.geometry.arrays import BoolArray, IntArray


class Table:
    """The base of dataclasses whose fields are columns, arrays of as many rows each, or of none while not filled yet.

    A table that is made of others is put together from its columns: a constructor takes several times as long.
    """

    def __len__(self) -> int:
        """Number of rows."""
        raise NotImplementedError

    @classmethod
    def _of(cls, columns: dict[str, Any]) -> Self:
        """The table with these columns, which are all that it has."""
        table = object.__new__(cls)
        vars(table).update(columns)
        return table

    @classmethod
    def joined(cls, parts: Sequence[Self]) -> Self:
        """The rows of one or more tables, one after another."""
        if len(parts) == 1:
            return parts[0]
        return cls._of({name: np.concatenate([vars(part)[name] for part in parts]) for name in vars(parts[0])})

    def select(self, keep: BoolArray | IntArray) -> Self:
        """The rows that `keep`, a mask or an index array, names."""
        rows = keep.nonzero()[0] if keep.dtype == np.bool_ else keep
        if len(rows) == len(self) and bool((rows == np.arange(len(rows))).all()):
            return self
        columns = vars(self).items()
        return self._of({name: values.take(rows, axis=0) if len(values) else values for name, values in columns})

    def having(self, **columns: Any) -> Self:
        """The same rows with these columns filled in."""
        assert columns.keys() <= vars(self).keys()  # noqa: S101
        return self._of(vars(self) | columns)
