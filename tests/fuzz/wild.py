"""Wild values and damaged bytes, which several kinds of inputs share."""

from pathlib import Path
from typing import Any

import numpy as np

WILD = (
    *(np.nan, np.inf, -np.inf, 0.0, -1.0, 1.0, 1e-300, 1e-30, -1e-3, 1e3, -1e3, 1e7, 1e10),
    *(-1e10, 1e20, 1e30, -1e30, 1e300),
)
WILD_WHOLE = (-1, 0, 1, 2, 7, 99, -(2**31), 2**31 - 1)
WORDS = (
    *("", " ", "x", "nan", "inf", "-", "--", "1e400", "12:34:56", "½", "Größe", "a b", "0x10"),
    *("null", "None", "True", "'", '"', "1_000", "١٢", "\x00", "J2000", "a" * 300),
)


def wild_number(rng: np.random.Generator, value: float) -> float:
    """Return a number that hardly can be, or one near the given one."""
    choice = rng.integers(6)
    if choice == 0:
        return -value
    if choice == 1:
        return value * float(rng.choice([2, 0.5, 10, 1e-3, 1e3, 1e6, 1e-6]))
    if choice == 2:
        return with_flipped_bit(rng, np.float64(value)).item()
    return float(rng.choice(WILD))


def with_flipped_bit(rng: np.random.Generator, value: np.generic) -> np.generic:
    """Return a number with one bit inverted."""
    data = bytearray(value.tobytes())
    place = int(rng.integers(8 * len(data)))
    data[place // 8] ^= 1 << (place % 8)
    return np.frombuffer(bytes(data), value.dtype)[0]


def word(rng: np.random.Generator) -> str:
    """Draw a word."""
    return WORDS[rng.integers(len(WORDS))]


def damage(rng: np.random.Generator, file: Path) -> str:
    """Damage the bytes of a file, and return how in words."""
    data = bytearray(file.read_bytes())
    size = len(data)
    if size == 0:
        file.write_bytes(bytes(rng.integers(0, 256, 100, dtype=np.uint8)))
        return "100 random bytes in an empty file"
    place = int(rng.integers(size))
    length = int(min(size - place, rng.choice([1, 2, 8, 64, 512, 4096])))
    choice = rng.integers(8)
    if choice <= 2:
        places = [place, *rng.integers(0, size, int(rng.choice([0, 0, 3, 30]))).tolist()]
        for one in places:
            data[one] ^= 1 << int(rng.integers(8))
        words = f"{len(places)} bits flipped, the first in byte {place}"
    elif choice == 3:
        data[place : place + length] = bytes(length)
        words = f"{length} zero bytes at {place}"
    elif choice == 4:
        del data[place : place + length]
        words = f"{length} bytes removed at {place}"
    elif choice == 5:
        data[place:place] = bytes(rng.integers(0, 256, length, dtype=np.uint8))
        words = f"{length} bytes inserted at {place}"
    elif choice == 6:
        del data[place:]
        words = f"cut at byte {place} of {size}"
    else:
        other = int(rng.integers(size))
        data[place : place + length] = data[other : other + length]
        words = f"{length} bytes of {other} copied to {place}"
    file.write_bytes(bytes(data))
    return words


def numbers_differ(new: Any, old: Any) -> Any:
    """Tell where numbers differ; NaN does not differ from NaN."""
    return (new != old) & ~((new != new) & (old != old))  # noqa: PLR0124
