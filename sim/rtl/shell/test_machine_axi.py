"""The bench of the machine's shell, for cocotb: a frame by the buses of a board, against the kernel.

Registers, memory and the kernel's frame are what `rtl -- frame` writes. The memory pauses at random on all channels,
and what is written reaches it late: whoever reads before the response gets what was there before.
"""

import json
import os
import random
from pathlib import Path

import cocotb
from buses import RegisterBoard, offsets, pauses, reset_values
from cocotb.clock import Clock
from cocotb.triggers import ClockCycles
from cocotbext.axi import AxiBus, AxiSlave

MAP = "machine.json"
OFFSETS = offsets(MAP)
BEGIN, PHASE, FULL, FAILED = 1, 3 << 1, 1 << 3, 1 << 4
WORD = 16


class LateMemory:
    """Bytes that are written some cycles after they came, and no others than there are."""

    def __init__(self, clock, words):
        self.clock = clock
        self.bytes = bytearray(b"".join(pack(word) for word in words))
        self.random = random.Random(1)

    async def read(self, address, length):
        return bytes(self.bytes[self.place(address, length)])

    async def write(self, address, data):
        if self.random.randrange(8) == 0:
            await ClockCycles(self.clock, self.random.randrange(1, 40))
        self.bytes[self.place(address, len(data))] = data

    def place(self, address, length):
        if address + length > len(self.bytes):
            raise IndexError(f"{length} bytes at {address:#x}")
        return slice(address, address + length)


def pack(word):
    return b"".join(part.to_bytes(4, "little") for part in word)


class Board(RegisterBoard):
    """The buses around the circuit; registers by their names."""

    def __init__(self, dut, words):
        buses = ("m_axi", *(f"m_axi_{channel}" for channel in ("aw", "w", "b", "ar", "r")))
        super().__init__(dut, reset_values(MAP, but="shape"), buses)
        self.memory = LateMemory(dut.aclk, words)
        slave = AxiSlave(AxiBus.from_prefix(dut, "m_axi"), dut.aclk, target=self.memory, **self.reset_port)
        writes, reads = slave.write_if, slave.read_if
        channels = (writes.aw_channel, writes.w_channel, writes.b_channel, reads.ar_channel, reads.r_channel)
        for seed, channel in enumerate(channels):
            channel.set_pause_generator(pauses(seed, 20))

    async def write_all(self, writes):
        for name, value in writes:
            await self.write(OFFSETS[name], value)

    async def draw(self):
        """A frame from its begin to its end, and the state then."""
        await self.write(OFFSETS["control"], BEGIN)
        while (state := await self.read(OFFSETS["control"])) & (BEGIN | PHASE):
            await ClockCycles(self.dut.aclk, 50)
        return state


@cocotb.test(timeout_time=5, timeout_unit="ms")  # A frame takes a twentieth of it.
async def a_frame(dut):
    load = json.loads(Path(os.environ["SPLATLINE_FRAME"]).read_text())
    first, frame, entries = load["first"], load["frame"], load["entries"]
    cocotb.start_soon(Clock(dut.aclk, 10, unit="ns").start())
    board = Board(dut, load["memory"])
    await board.reset()
    shape = await board.read(OFFSETS["shape"])
    assert shape == 32 | 1 << 8 | 2 << 16, f"{shape:#x}"
    await board.write_all(load["writes"])

    # Without room for the last entry there is no frame. Packets beyond the memory are answered with an error, which is
    # told. The next frame is drawn all the same.
    await board.write_all([("most", entries - 1), ("base_packets", len(load["memory"]))])
    before = bytes(board.memory.bytes[WORD * first :])
    assert await board.draw() == FULL | FAILED
    assert board.memory.bytes[WORD * first :] == before, "a frame without lists"
    await board.write_all([("most", entries), ("base_packets", dict(load["writes"])["base_packets"])])
    assert await board.draw() == 0
    got = bytes(board.memory.bytes)
    for place, word in enumerate(frame):
        found = got[WORD * (first + place) :][:WORD]
        assert found == pack(word), f"pixel {place} is {found.hex()}, not {pack(word).hex()}"
    assert got[WORD * (first + len(frame)) :] == before[WORD * len(frame) :], "words behind the frame"
    counts = [await board.read(OFFSETS[name]) for name in ("entries", "visible", "cycles")]
    assert counts[0] == entries, counts
    dut._log.info("cocotb bench: %d pixels of %d splats in %d cycles, 0 mismatches", len(frame), *counts[1:])
