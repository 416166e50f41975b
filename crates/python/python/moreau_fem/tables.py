"""Tables as data frames of pandas where that is installed, else as dictionaries of arrays."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from ._core import Column, Values

Array = NDArray[Any]


def numbers(data: bytearray | bytes, *shape: int) -> NDArray[np.float64]:
    """An array of its own of numbers that came as bytes."""
    return np.frombuffer(data, dtype=np.float64).reshape(*shape)


def _values(values: Values) -> Array:
    match values:
        case ("texts", list(data)):
            return np.array(data, dtype=object)
        case ("counts", bytearray(data)):
            return np.frombuffer(data, dtype=np.int64)
        case (_, data):
            return numbers(bytearray(data), -1)


def frame(columns: Mapping[str, Any], units: Mapping[str, str] | None = None) -> Any:
    """Columns of equal length: a ``pandas.DataFrame`` with the units in ``.attrs["units"]``, or without pandas a
    dictionary of arrays."""
    try:
        import pandas
    except ImportError:
        return {name: np.asarray(values) for name, values in columns.items()}
    table = pandas.DataFrame(dict(columns))
    if units is not None:
        table.attrs["units"] = {name: unit for name, unit in units.items() if unit}
    return table


def of_core(columns: list[Column]) -> Any:
    """A table as it comes from the core."""
    values = {name: _values(values) for name, _, values in columns}
    return frame(values, {name: unit for name, unit, _ in columns})


def last(columns: list[Column]) -> dict[str, Any]:
    """The last row of a table as it comes from the core, by column."""
    return {name: _values(values)[-1].item() for name, _, values in columns}
