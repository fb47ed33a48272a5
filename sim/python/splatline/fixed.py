"""Numbers of the kernel's formats: integers that know their Q-format."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray


def _range(bits: int, signed: bool) -> tuple[int, int]:
    """The smallest integer of a format, and the largest."""
    return (-(1 << bits - 1), (1 << bits - 1) - 1) if signed else (0, (1 << bits) - 1)


class FixedArray:
    """Integers of one fixed-point format: value = raw * 2^-fraction.

    `raw` are the integers, `to_numpy()` the numbers (exact up to 53 bits), `q` the format's name: UQ4.28 has 4 bits before the point and 28
    behind it, Q27.12 has a sign as well. Indexing gives a FixedArray; equality compares integers. Rounding and saturation happen in the
    kernel alone: this holds what came of them.
    """

    __slots__ = ("bits", "fraction", "raw", "signed")

    def __init__(self, raw: ArrayLike, bits: int, fraction: int = 0, signed: bool = False):
        self.raw = np.asarray(raw)
        self.bits, self.fraction, self.signed = bits, fraction, signed
        low, high = _range(bits, signed)
        if self.raw.dtype.kind not in "iu":
            raise TypeError(f"raw must hold integers, not {self.raw.dtype}: FixedArray.from_numpy rounds numbers")
        if self.raw.size and (int(self.raw.min()) < low or int(self.raw.max()) > high):
            raise ValueError(f"{self.raw.min()} to {self.raw.max()} is beyond {self.q}: allowed are {low} to {high}")

    @classmethod
    def from_numpy(cls, values: ArrayLike, bits: int, fraction: int = 0, signed: bool = False) -> FixedArray:
        """Numbers rounded to the nearest of the format, ties to even; out of range is an error."""
        rounded = np.rint(np.asarray(values, np.float64) * 2.0**fraction)
        low, high = _range(min(bits, 64), signed)
        if not ((rounded >= low) & (rounded < high + 1)).all():
            raise ValueError(f"a number is none, or beyond {bits} bits: allowed are {low} to {high} times 2^-{fraction}")
        return cls(rounded.astype(np.int64 if high < 1 << 63 else np.uint64), bits, fraction, signed)

    @property
    def q(self) -> str:
        """Name of the format."""
        whole = self.bits - self.fraction - self.signed
        return f"{'Q' if self.signed else 'UQ'}{whole}.{self.fraction}"

    def to_numpy(self) -> NDArray[np.float64]:
        """The numbers, float64 of the shape of `raw`."""
        return self.raw * 2.0**-self.fraction

    def to_apytypes(self) -> Any:
        """The same as an APyTypes array, whose numbers are signed: unsigned ones get a bit more."""
        import apytypes

        whole = self.bits - self.fraction + (not self.signed)
        return apytypes.APyFixedArray(self.raw.tolist(), int_bits=whole, frac_bits=self.fraction)

    def __array__(self, dtype: DTypeLike | None = None, copy: bool | None = None) -> NDArray[Any]:
        return self.to_numpy().astype(dtype or np.float64, copy=False)

    def __getitem__(self, index: Any) -> FixedArray:
        return FixedArray(self.raw[index], self.bits, self.fraction, self.signed)

    def __len__(self) -> int:
        return len(self.raw)

    @property
    def shape(self) -> tuple[int, ...]:
        return self.raw.shape

    def __eq__(self, other: object) -> NDArray[np.bool_]:  # type: ignore[override]
        if not isinstance(other, FixedArray):
            return NotImplemented
        if self.fraction != other.fraction:
            raise ValueError(f"{self.q} and {other.q} have different units: compare to_numpy()")
        return self.raw == other.raw

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        return f"FixedArray({self.q}, {np.array2string(self.to_numpy(), threshold=8)})"
