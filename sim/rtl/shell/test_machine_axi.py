"""The bench of the machine's shell, for cocotb: a frame by the buses of a board, against the kernel.

Registers, memory and the kernel's frame are what `rtl -- frame` writes. The memory pauses at random on all channels,
and what is written reaches it late: whoever reads before the response gets what was there before.
"""

import json
import logging
import os
import random
from pathlib import Path

import cocotb
from cocotb.clock import Clock
from cocotb.triggers import ClockCycles
from cocotbext.axi import AxiBus, AxiLiteBus, AxiLiteMaster, AxiSlave

REGISTERS = json.loads(Path(__file__).with_name("machine.json").read_text())["registers"]
OFFSETS = {register["name"]: int(register["offset"], 16) for register in REGISTERS}
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


def pauses(seed, share):
    """True in `share` of 100 cycles: the bus waits."""
    numbers = random.Random(seed)
    while True:
        yield numbers.randrange(100) < share


class Board:
    """The buses around the circuit."""

    def __init__(self, dut, words):
        reset = {"reset": dut.aresetn, "reset_active_level": False}
        # A line for each of ten thousand words would be no log, nor for each that the memory has no place for.
        for bus in ("s_axil", "m_axi", *(f"m_axi_{channel}" for channel in ("aw", "w", "b", "ar", "r"))):
            logging.getLogger(f"cocotb.{dut._name}.{bus}").setLevel(logging.ERROR)
        self.dut = dut
        self.registers = AxiLiteMaster(AxiLiteBus.from_prefix(dut, "s_axil"), dut.aclk, **reset)
        self.memory = LateMemory(dut.aclk, words)
        slave = AxiSlave(AxiBus.from_prefix(dut, "m_axi"), dut.aclk, target=self.memory, **reset)
        writes, reads = slave.write_if, slave.read_if
        channels = (writes.aw_channel, writes.w_channel, writes.b_channel, reads.ar_channel, reads.r_channel)
        for seed, channel in enumerate(channels):
            channel.set_pause_generator(pauses(seed, 20))

    async def reset(self):
        self.dut.aresetn.value = 0
        await ClockCycles(self.dut.aclk, 8)
        self.dut.aresetn.value = 1
        await ClockCycles(self.dut.aclk, 4)

    async def write(self, name, value):
        await self.registers.write_dword(OFFSETS[name], value)

    async def read(self, name):
        return await self.registers.read_dword(OFFSETS[name])

    async def draw(self):
        """A frame from its begin to its end, and the state then."""
        await self.write("control", BEGIN)
        while (state := await self.read("control")) & (BEGIN | PHASE):
            await ClockCycles(self.dut.aclk, 50)
        return state


@cocotb.test(timeout_time=5, timeout_unit="ms")  # A frame takes a twentieth of it.
async def a_frame(dut):
    load = json.loads(Path(os.environ["SPLATLINE_FRAME"]).read_text())
    first, frame, entries = load["first"], load["frame"], load["entries"]
    cocotb.start_soon(Clock(dut.aclk, 10, unit="ns").start())
    board = Board(dut, load["memory"])
    await board.reset()
    shape = [await board.read("version"), await board.read("shape")]
    assert shape == [3, 32 | 1 << 8 | 2 << 16], [f"{word:#x}" for word in shape]
    for name, value in load["writes"]:
        await board.write(name, value)

    # Without room for the last entry there is no frame. Packets beyond the memory are answered with an error, which is told.
    # The next frame is drawn all the same.
    await board.write("most", entries - 1)
    await board.write("base_packets", len(load["memory"]))
    before = bytes(board.memory.bytes[WORD * first :])
    assert await board.draw() == FULL | FAILED
    assert board.memory.bytes[WORD * first :] == before, "a frame without lists"
    await board.write("most", entries)
    await board.write("base_packets", dict(load["writes"])["base_packets"])
    assert await board.draw() == 0
    got = bytes(board.memory.bytes)
    for place, word in enumerate(frame):
        found = got[WORD * (first + place) :][:WORD]
        assert found == pack(word), f"pixel {place} is {found.hex()}, not {pack(word).hex()}"
    assert got[WORD * (first + len(frame)) :] == before[WORD * len(frame) :], "words behind the frame"
    assert await board.read("entries") == entries
    seen, cycles = await board.read("visible"), await board.read("cycles")
    dut._log.info("cocotb bench: %d pixels of %d splats in %d cycles, 0 mismatches", len(frame), seen, cycles)
