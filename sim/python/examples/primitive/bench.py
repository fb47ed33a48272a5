"""The bench: packets, spans and pixels of a scene, each compared in the cycle in which it is handed over.

The kernel is `splatline.Stages`; packets come and pixels go by the AXI models of cocotbext-axi, which hold both back at random. What crosses
from setup to the lanes is watched inside: the spans that the row generator hands to the lanes' queues.
"""

import logging
import random

import cocotb
import numpy as np
import splatline
from cocotb.clock import Clock
from cocotb.triggers import ClockCycles, ReadOnly, RisingEdge
from cocotbext.axi import AxiLiteBus, AxiLiteMaster, AxiStreamBus, AxiStreamFrame, AxiStreamMonitor, AxiStreamSink, AxiStreamSource

CONTROL, FIRST, LAST, ALPHA_MAX, STOP, LEAST, LEAST_HIGH, FLAGS = 0x00, 0x08, 0x0C, 0x10, 0x14, 0x18, 0x1C, 0x20
TABLE_INDEX, TABLE_LOW, TABLE_STEP = 0x24, 0x28, 0x2C
BEGIN, FINISH = 1, 2
#: Columns and rows of a tile.
TILE = 32


def pauses(seed, share):
    """True in `share` of 100 cycles: the bus waits."""
    numbers = random.Random(seed)
    while True:
        yield numbers.randrange(100) < share


class Board:
    """The buses around the circuit."""

    def __init__(self, dut):
        for bus in ("s_axil", "s_axis_packet", "m_axis_pixel"):
            logging.getLogger(f"cocotb.{dut._name}.{bus}").setLevel(logging.WARNING)
        reset = {"reset": dut.aresetn, "reset_active_level": False}
        self.dut = dut
        self.registers = AxiLiteMaster(AxiLiteBus.from_prefix(dut, "s_axil"), dut.aclk, **reset)
        self.packets = AxiStreamSource(AxiStreamBus.from_prefix(dut, "s_axis_packet"), dut.aclk, **reset)
        self.pixels = AxiStreamSink(AxiStreamBus.from_prefix(dut, "m_axis_pixel"), dut.aclk, **reset)
        self.packets.set_pause_generator(pauses(1, 10))
        self.pixels.set_pause_generator(pauses(2, 30))

    async def write(self, address, value):
        await self.registers.write_dword(address, int(value) & 0xFFFFFFFF)

    async def load(self, stages):
        """Rules and footprint table."""
        rules = stages.rules
        await self.write(ALPHA_MAX, rules["alpha_max"])
        await self.write(STOP, rules["minimum_transmittance"])
        await self.write(LEAST, rules["least"])
        await self.write(LEAST_HIGH, rules["least"] >> 32)
        await self.write(FLAGS, rules["omit_finishing"] | rules["wide_table"] << 1)
        entries = stages.table.raw.astype(np.int64)
        await self.write(TABLE_INDEX, 0)
        for low, step in zip(entries, entries - np.append(entries[1:], 0)):
            await self.write(TABLE_LOW, low)
            await self.write(TABLE_STEP, step)

    async def control(self, what):
        await self.write(CONTROL, what)
        while await self.registers.read_dword(CONTROL) & what:
            pass

    async def begin(self, window):
        x0, y0, x1, y1 = window
        await self.write(FIRST, x0 | y0 << 16)
        await self.write(LAST, x1 | y1 << 16)
        await self.control(BEGIN)


async def watch_spans(dut, expected, count):
    """Every span that is handed to the lanes, against the kernel's: row and column in the tile, pixels, radial index and its differences."""
    unit = dut.splats
    fields = [("row", 5), ("column", 5), ("length", 6), ("radial", 32), ("first", 32), ("second", 32)]
    paint = len(unit.run) - sum(bits for _, bits in fields)
    while True:
        await RisingEdge(dut.aclk)
        await ReadOnly()
        if not (int(unit.slot_valid.value) and int(unit.slot_ready.value) and int(unit.slot_has_run.value)):
            continue
        word, found = int(unit.run.value) >> paint, {}
        for name, bits in reversed(fields):
            found[name] = word & (1 << bits) - 1
            word >>= bits
        assert found == next(expected), f"span {count[0]}: {found}"
        count[0] += 1


def spans_of(stages, words, windows):
    """The kernel's spans of all tiles, in the order in which they must come."""
    low = 0xFFFFFFFF
    for window in windows:
        for packet in words:
            for row, column, length, radial, first, second in stages.spans(packet, window).raw.tolist():
                yield {
                    "row": row % TILE,
                    "column": column % TILE,
                    "length": length,
                    "radial": radial & low,
                    "first": first & low,
                    "second": second & low,
                }


@cocotb.test()
async def every_handshake_is_the_kernels(dut):
    scene = splatline.load("random:120")
    stages = splatline.Stages(scene, splatline.Camera.framing(scene, size=(64, 32)), "standard24")
    words = stages.setup().sorted().words
    windows = [(0, 0, 32, 32), (32, 0, 64, 32)]

    cocotb.start_soon(Clock(dut.aclk, 10, unit="ns").start())
    board = Board(dut)
    dut.aresetn.value = 0
    await ClockCycles(dut.aclk, 8)
    dut.aresetn.value = 1
    await board.load(stages)
    spans = [0]
    expected = spans_of(stages, words, windows)
    cocotb.start_soon(watch_spans(dut, expected, spans))
    taken = AxiStreamMonitor(AxiStreamBus.from_prefix(dut, "s_axis_packet"), dut.aclk, dut.aresetn, False)
    taken.log.setLevel(logging.WARNING)

    for window in windows:
        await board.begin(window)
        for packet in words:
            await board.packets.send(AxiStreamFrame(packet.astype("<u4").tobytes()))
        await board.packets.wait()
        await board.control(FINISH)

    pixels = 0
    for window in windows:
        x0, y0, x1, _ = window
        beats = np.frombuffer(bytes((await board.pixels.recv()).tdata), "<u4").reshape(-1, 4)
        kernel = stages.tile(words, window).reshape(-1, 4)
        assert beats.shape == kernel.shape, f"{len(beats)} pixels, and {len(kernel)} in the window {window}"
        wrong = np.flatnonzero((beats != kernel).any(axis=1))
        assert not len(wrong), f"{len(wrong)} pixels differ, the first at {wrong[0] % (x1 - x0) + x0}, {wrong[0] // (x1 - x0) + y0}"
        pixels += len(beats)
    assert next(expected, None) is None, "spans are missing"
    for window in windows:
        for packet in words:
            assert bytes((await taken.recv()).tdata) == packet.astype("<u4").tobytes()
    dut._log.info("%d packets, %d spans and %d pixels of %d tiles: 0 differences", len(words) * len(windows), spans[0], pixels, len(windows))
