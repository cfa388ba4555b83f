"""The cells of a column, whatever type a file gives them: numbers, or text without blanks around it."""

from typing import Any, Final

import numpy as np
from astropy.table import Column, MaskedColumn

from uvshear.errors import InputError
from uvshear.typing import Array

_NUMBERS: Final = "iuf"


def cells_of(column: Any) -> np.ma.MaskedArray:
    """Return the cells of a column as one dimension of numbers, or of text; those without a value are masked.

    Raises
    ------
    InputError
        The column holds something else; the message continues "column 'NAME' ...".
    """
    if not isinstance(column, Column):
        raise InputError(f"holds objects of the type {type(column).__name__}")
    values: Array = np.asarray(column)
    mask = (
        np.ma.getmaskarray(column)
        if isinstance(column, MaskedColumn)
        else np.zeros(values.shape, bool)
    )
    if values.ndim != 1:
        raise InputError("holds arrays; one value for each row is needed")
    kind = values.dtype.kind
    if kind in _NUMBERS:
        return np.ma.MaskedArray(values, mask=mask)
    if kind == "U":
        return _texts(values.tolist(), mask)
    if kind in "SO":
        return _objects(values.tolist(), mask)
    raise InputError(f"holds values of the type {values.dtype.name}; numbers or text are needed")


def _objects(values: list[Any], mask: Array) -> np.ma.MaskedArray:
    """Cells of mixed type, as a VOTable with text of any length has them: all numbers, or else text."""
    mask = mask | np.array([value is None or np.ma.is_masked(value) for value in values], bool)
    there = [value for value, is_masked in zip(values, mask, strict=True) if not is_masked]
    if there and all(
        isinstance(value, int | float | np.number)
        and not isinstance(value, bool | np.complexfloating)
        for value in there
    ):
        numbers = [np.nan if off else float(value) for value, off in zip(values, mask, strict=True)]
        return np.ma.MaskedArray(np.array(numbers), mask=mask)
    texts = []
    for row, (value, is_masked) in enumerate(zip(values, mask, strict=True), 1):
        if is_masked:
            texts.append("")
        elif isinstance(value, bytes):
            texts.append(_decoded(value, row))
        elif isinstance(value, str):
            texts.append(value)
        elif np.ndim(value):
            raise InputError("holds arrays; one value for each row is needed")
        else:
            raise InputError(f"holds objects of the type {type(value).__name__} (row {row})")
    return _texts(texts, mask)


def _decoded(value: bytes, row: int) -> str:
    try:
        return value.rstrip(b"\x00").decode("utf-8")
    except UnicodeDecodeError as error:
        byte = value[error.start]
        raise InputError(
            f"has the byte 0x{byte:02x} in row {row}, which is neither ASCII nor UTF-8; text is needed"
        ) from error


def _texts(values: list[str], mask: Array) -> np.ma.MaskedArray:
    stripped = np.array([value.strip() for value in values], dtype=np.str_)
    return np.ma.MaskedArray(stripped, mask=mask | (stripped == ""))
