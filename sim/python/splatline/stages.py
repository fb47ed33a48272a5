"""The kernel stage by stage, in its own integers: what a bench holds a circuit against.

    stages = splatline.stages.Stages(splatline.plan(scene, camera, "standard24"))
    packets = stages.setup()                   # words of 32 bits, and the fields in them
    packets["centre_u"]                        # a FixedArray, its Q-format in the repr
    spans = stages.spans(packets.words[0])
    pixels = stages.tile(packets.sorted().words)
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _native
from ._calls import SceneLike
from ._calls import plan as _plan
from ._native import Camera, Design
from ._scene import in_rows
from .fixed import FixedArray

#: First column and row inside, and first beyond.
Window: TypeAlias = tuple[int, int, int, int]


@dataclass(frozen=True)
class Field:
    """Where a field lies in a packet or a record."""

    name: str
    offset: int
    bits: int
    signed: bool
    fraction: int


def _mask(bits: int) -> int:
    return (1 << bits) - 1


@dataclass(frozen=True, eq=False)
class Packets:
    """Footprint packets: `words`, uint32 of shape (n, words), least significant first, and what is in them.

    Those of culled splats are 0; `culled[i]` says why splat i has none, or None. `depth` are the keys by which they are sorted, which no packet holds.
    """

    words: NDArray[np.uint32]
    depth: NDArray[np.int64]
    fields: dict[str, Field]
    culled: list[str | None]
    splats: NDArray[np.int64]

    def __len__(self) -> int:
        return len(self.words)

    def __getitem__(self, name: str) -> FixedArray:
        field = self.fields[name]
        # 64 bits from the word that the field begins in hold it but for its last few, which are in the third.
        first, shift = divmod(field.offset, 32)
        padded = np.pad(self.words, ((0, 0), (0, 3))).astype(np.uint64)
        raw = (padded[:, first] | padded[:, first + 1] << np.uint64(32)) >> np.uint64(shift)
        if shift:
            raw |= padded[:, first + 2] << np.uint64(64 - shift)
        values = (raw & np.uint64(_mask(field.bits))).astype(np.int64)
        if field.signed:
            values = (values ^ 1 << field.bits - 1) - (1 << field.bits - 1)
        return FixedArray(values, field.bits, field.fraction, field.signed)

    def to_bytes(self) -> bytes:
        """All packets, words little-endian."""
        return self.words.astype("<u4").tobytes()

    def to_int(self, index: int) -> int:
        """A packet as one number, for a port as wide as it."""
        return int.from_bytes(self.words[index].astype("<u4").tobytes(), "little")

    def sorted(self) -> Packets:
        """Those that are drawn, nearest first, ties by the splat's number: the order in which they are composited."""
        drawn = np.array([reason is None for reason in self.culled], bool)
        order = np.argsort(self.depth, kind="stable")
        order = order[drawn[order]]
        return Packets(self.words[order], self.depth[order], self.fields, [None] * len(order), self.splats[order])


@dataclass(frozen=True)
class Records:
    """One stage's records: `raw`, int64 of shape (n, fields), and each field as a FixedArray."""

    name: str
    about: str
    fields: dict[str, Field]
    raw: NDArray[np.int64]

    def __len__(self) -> int:
        return len(self.raw)

    def __getitem__(self, name: str) -> FixedArray:
        field = self.fields[name]
        return FixedArray(self.raw[:, list(self.fields).index(name)], field.bits, field.fraction, field.signed)


class Stages:
    """The stages of a plan of splats that are composited one by one: setup, spans, radial index, weight, opacity, blend, tile.

    Takes what `splatline.plan` takes. A window is (x0, y0, x1, y1) in pixels, first inside and first beyond; the whole picture if left out.
    """

    def __init__(self, scene: SceneLike, camera: Camera | None = None, design: Design | str = "standard24", **options: Any):
        self.plan = _plan(scene, camera, design, **options)
        self._kernel = _native.Kernel(self.plan)
        self.fields = {field[0]: Field(*field) for field in self._kernel.layout()}
        self.widths = self.plan.design.widths
        #: Words of 32 bits of a packet.
        self.packet_words: int = self._kernel.packet_words
        #: Colours are in units of 2^colour_log2.
        self.colour_log2: int = self._kernel.colour_log2
        #: What a circuit is told of the rules: alpha_max, least, minimum_transmittance, omit_finishing, wide_table.
        self.rules: dict[str, int] = self._kernel.rules()

    def setup(self, splats: ArrayLike | None = None) -> Packets:
        """Packets of these splats (their numbers in the scene), or of all."""
        numbers = None if splats is None else np.atleast_1d(splats)
        if numbers is not None and numbers.size and numbers.dtype.kind not in "iu":
            raise _native.Error(f"splats must hold their numbers, not {numbers.dtype}")
        numbers = numbers if numbers is None else in_rows("splats", numbers, np.int64, 1)
        words, depth, culled = self._kernel.setup(None if numbers is None else numbers.tolist())
        return Packets(words, depth, self.fields, culled, np.arange(len(words)) if numbers is None else numbers)

    def packets(self, words: ArrayLike | bytes | bytearray | memoryview) -> Packets:
        """Packets from words of 32 bits, (n, words), or from their bytes, little-endian."""
        if isinstance(words, (bytes, bytearray, memoryview)):
            words = np.frombuffer(words, "<u4").reshape(-1, self.packet_words)
        rows = in_rows("words", words, np.uint32, 2)
        return Packets(rows, np.zeros(len(rows), np.int64), self.fields, [None] * len(rows), np.arange(len(rows)))

    def spans(self, packet: NDArray[np.uint32], window: Window | None = None) -> Records:
        """Spans of adjacent pixels: row, column, length, radial index at the first pixel, its difference, the difference's difference.

        The last three are signed, with the fraction bits that `fields` says, in squared deviations of the footprint.
        """
        raw, fraction = self._kernel.spans_of(in_rows("packet", packet, np.uint32, 1), window)
        fields = [Field(name, 0, 16, False, 0) for name in ("row", "column", "length")]
        fields += [Field(name, 0, 64, True, fraction) for name in ("radial", "first", "second")]
        return Records("spans", "spans of adjacent pixels", {field.name: field for field in fields}, raw)

    def radial(self, packet: NDArray[np.uint32], window: Window | None = None) -> Records:
        """Pixels inside the footprint: row, column, and radial index UQ4.radial in squared deviations, in the order of the spans."""
        raw = self._kernel.radial_indices(in_rows("packet", packet, np.uint32, 1), window)
        bits = self.widths["radial"]
        fields = [Field("row", 0, 16, False, 0), Field("column", 0, 16, False, 0), Field("radial", 0, bits + 4, False, bits)]
        return Records("radial", "pixels inside a footprint", {field.name: field for field in fields}, raw)

    @property
    def table(self) -> FixedArray:
        """Entries of the footprint table, UQ1.weight."""
        bits = self.widths["weight"]
        return FixedArray(self._kernel.table, bits + 1, bits)

    def weight(self, radial: FixedArray) -> FixedArray:
        """The reconstruction kernel at these radial indices UQ4.radial, by the table and its interpolation: UQ1.weight, 0 to 1."""
        bits = self.widths["weight"]
        return FixedArray(self._kernel.weights(in_rows("radial", radial.raw, np.int64, 1)), bits + 1, bits)

    def opacity(self, peak: int, weight: FixedArray) -> FixedArray:
        """Opacities UQ1.alpha of a packet's `peak` (its integer) at these weights UQ1.weight; 0 where the rules skip the pixel."""
        bits = self.widths["alpha"]
        return FixedArray(self._kernel.opacities(int(peak), in_rows("weight", weight.raw, np.uint32, 1)), bits + 1, bits)

    def clear(self, *shape: int) -> NDArray[np.uint32]:
        """Transparent pixels, uint32 of shape (..., 4)."""
        return np.tile(np.array(self._kernel.clear, np.uint32), (*shape, 1))

    def blend(self, pixels: ArrayLike, opacity: FixedArray, colour: ArrayLike) -> NDArray[np.uint32]:
        """Pixels with an opacity each of a colour (three integers of a packet) composited into them; a new array.

        pixels  (n, 4)  uint32: red, green, blue UQ4.accumulator in units of 2^colour_log2, and transmittance UQ1.transmittance, whose bit 31
                        marks a pixel that takes no more splats
        """
        rows = in_rows("pixels", pixels, np.uint32, 2)
        return self._kernel.blend(rows, in_rows("opacity", opacity.raw, np.uint32, 1), np.asarray(colour, np.int64).tolist())

    def tile(self, packets: ArrayLike, window: Window | None = None) -> NDArray[np.uint32]:
        """Packets (n, words) drawn in their order into a window: uint32 of shape (rows, columns, 4), pixels as `blend` has them."""
        return self._kernel.tile(in_rows("packets", packets, np.uint32, 2), window)

    def rgba(self, pixels: NDArray[np.uint32]) -> NDArray[np.float64]:
        """Pixels' integers as a picture has them: float64 of the same shape, exactly, in units of 1.0."""
        # The highest bit marks a pixel that takes no more splats.
        transmittance = pixels[..., 3] & 0x7FFFFFFF
        colour = pixels[..., :3] * 2.0 ** (self.colour_log2 - self.widths["accumulator"])
        alpha = 1.0 - transmittance * 2.0 ** -self.widths["transmittance"]
        return np.concatenate([colour, alpha[..., None]], axis=-1)

    def vectors(self, splats: int = 64) -> dict[str, Records]:
        """Every stage boundary of the first `splats` splats, as `splatline vectors export` writes it, by the stage's name."""
        found = {}
        for name, about, fields, raw in self._kernel.vectors(splats):
            places = [Field(f["name"], f["offset"], f["bits"], f["signed"], f["fraction"]) for f in fields]
            found[name] = Records(name, about, {place.name: place for place in places}, raw)
        return found
