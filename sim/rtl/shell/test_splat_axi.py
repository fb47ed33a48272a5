"""The shell's bench, for cocotb: tiles of the C interface's example picture, by the buses of a board, against the kernel.

The kernel is the shared library that `run.py` builds from `sim/capi`: it gives rules, table, packets and, pixel by pixel, the verdict. Packets and
pixels are held back at random, and the next tile is sent while the one before is read out.
"""

import ctypes
import itertools
import os

import cocotb
from buses import RegisterBoard, offsets, pauses, reset_values
from cocotb.clock import Clock
from cocotb.triggers import ClockCycles, RisingEdge
from cocotbext.axi import AxiStreamBus, AxiStreamFrame, AxiStreamSink, AxiStreamSource

MAP = "registers.json"
(CONTROL, VERSION, FIRST, LAST, ALPHA_MAX, STOP, LEAST, LEAST_HIGH, FLAGS, TABLE_INDEX, TABLE_LOW, TABLE_STEP, PACKETS, FOREIGN, BROKEN, PIXELS,
 CYCLES) = offsets(MAP).values()
BEGIN, FINISH = 1, 2


class Kernel:
    """The functions of sim/capi/cosim/dpi_model.c."""

    def __init__(self, path):
        self.library = ctypes.CDLL(path)
        self.library.model_rules.restype = None
        self.library.model_table.restype = None
        self.packets = self.library.model_begin()
        assert self.packets > 0, "the example picture cannot be set up"
        self.words, self.entries = self.integers(self.library.model_sizes, count=2)[1]

    def integers(self, function, *arguments, count):
        """What a function writes through `count` pointers to int, as 32-bit words; its result first."""
        values = [ctypes.c_int() for _ in range(count)]
        result = function(*arguments, *map(ctypes.byref, values))
        return result, [value.value & 0xFFFFFFFF for value in values]

    def rules(self):
        values = [ctypes.c_int(), ctypes.c_longlong(), ctypes.c_int(), ctypes.c_int(), ctypes.c_int()]
        self.library.model_rules(*map(ctypes.byref, values))
        return [value.value for value in values]

    def table(self, index):
        return self.integers(self.library.model_table, index, count=2)[1]

    def tile(self, index):
        return self.integers(self.library.model_tile, index, count=4)[1]

    def packet(self, index):
        packet = (ctypes.c_uint32 * 64)()
        assert self.library.model_packet(index, packet) >= 0
        return list(packet)[: self.words]

    def is_pixel(self, x, y, word):
        red, green, blue, last = [(word >> (32 * i)) & 0xFFFFFFFF for i in range(4)]
        signed = [ctypes.c_int(value) for value in (last & 0x7FFFFFFF, red, green, blue)]
        return self.library.model_pixel_is(x, y, last >> 31, *signed) == 1


class Board(RegisterBoard):
    """The buses around the circuit."""

    def __init__(self, dut):
        super().__init__(dut, reset_values(MAP, but="cycles"), ("s_axis_packet", "m_axis_pixel"))
        self.packets = AxiStreamSource(AxiStreamBus.from_prefix(dut, "s_axis_packet"), dut.aclk, **self.reset_port)
        self.pixels = AxiStreamSink(AxiStreamBus.from_prefix(dut, "m_axis_pixel"), dut.aclk, **self.reset_port)

    async def load(self, kernel):
        alpha_max, least, minimum_transmittance, omit_finishing, wide_table = kernel.rules()
        await self.write(ALPHA_MAX, alpha_max)
        await self.write(STOP, minimum_transmittance & 0xFFFFFFFF)
        await self.write(LEAST, least & 0xFFFFFFFF)
        await self.write(LEAST_HIGH, (least >> 32) & 0xFFFFFFFF)
        await self.write(FLAGS, omit_finishing | wide_table << 1)
        await self.write(TABLE_INDEX, 0)
        for index in range(kernel.entries):
            low, step = kernel.table(index)
            await self.write(TABLE_LOW, low)
            await self.write(TABLE_STEP, step)

    async def begin(self, tile):
        first_column, first_row, end_column, end_row = tile
        await self.write(FIRST, first_column | first_row << 16)
        await self.write(LAST, end_column | end_row << 16)
        await self.write(CONTROL, BEGIN)
        while await self.read(CONTROL) & BEGIN:
            pass

    async def send(self, words):
        data = b"".join(word.to_bytes(4, "little") for word in words)
        await self.packets.send(AxiStreamFrame(data))


def chosen_tiles():
    return [int(tile) for tile in os.environ.get("SPLATLINE_TILES", "0,2").split(",")]


@cocotb.test()
async def tiles_of_the_example_picture(dut):
    kernel = Kernel(os.environ["SPLATLINE_KERNEL"])
    words = kernel.words
    beat = len(dut.s_axis_packet_tdata) // 32
    tiles = chosen_tiles()
    cocotb.start_soon(Clock(dut.aclk, 10, unit="ns").start())
    board = Board(dut)
    await board.reset()
    await board.load(kernel)
    board.packets.set_pause_generator(pauses(1, 10))
    board.pixels.set_pause_generator(pauses(2, 30))

    # A reset in a tile, and in a packet, leaves no trace.
    await board.begin(kernel.tile(tiles[0]))
    for length in (words, beat):
        await board.send(kernel.packet(0)[:length])
    await ClockCycles(dut.aclk, 100)
    await board.reset()
    await board.load(kernel)

    # Nor does a packet without its last beats, or with beats behind them, were they a packet again. Each is counted
    # once.
    packet = kernel.packet(0)
    whole = packet + [0] * (-words % beat)
    for broken in (packet[: 3 * beat], packet[:-beat], whole + packet[:1], whole + packet, packet[:1]):
        await board.send(broken)
    await board.packets.wait()
    for tile in tiles:
        await board.begin(kernel.tile(tile))
        for index in range(kernel.packets):
            await board.send(kernel.packet(index))
        await board.packets.wait()
        await board.write(CONTROL, FINISH)
        while await board.read(CONTROL) & FINISH:
            pass

    compared = 0
    for tile in tiles:
        first_column, first_row, end_column, end_row = kernel.tile(tile)
        data = bytes((await board.pixels.recv()).tdata)
        places = [(x, y) for y in range(first_row, end_row) for x in range(first_column, end_column)]
        assert len(data) == 16 * len(places), f"tile {tile}: {len(data) // 16} pixels before its last one, {len(places)} in its window"
        for place, (x, y) in enumerate(places):
            word = int.from_bytes(data[16 * place : 16 * place + 16], "little")
            assert kernel.is_pixel(x, y, word), f"tile {tile}: pixel ({x}, {y}) is {word:032x}"
        compared += len(places)
    counted = [await board.read(address) for address in (PACKETS, FOREIGN, BROKEN, PIXELS)]
    assert counted == [kernel.packets * len(tiles), 0, 5, compared], counted
    dut._log.info("cocotb bench: %d pixels of %d tiles, 0 mismatches", compared, len(tiles))


@cocotb.test()
async def an_end_without_a_tile_does_nothing(dut):
    """Nor does a second end of a tile end the next one, whenever it comes. A begin and an end in one word are a tile."""
    cocotb.start_soon(Clock(dut.aclk, 10, unit="ns").start())
    board = Board(dut)
    await board.reset()
    tile, pixels = (32, 64, 36, 66), 8
    await board.write(CONTROL, FINISH)
    assert await board.read(CONTROL) & FINISH == 0, "an end waits for a tile"
    for late in range(16):
        await board.begin(tile)
        await ClockCycles(dut.aclk, 50)
        assert await board.read(PIXELS) == 2 * pixels * late, "the tile has ended by itself"
        # The second tile's end waits until the first one has been read out.
        board.pixels.pause = True
        await board.write(CONTROL, FINISH)
        await board.begin(tile)
        await board.write(CONTROL, FINISH)
        assert await board.read(CONTROL) & FINISH
        board.pixels.pause = False
        await ClockCycles(dut.aclk, late)
        await board.write(CONTROL, FINISH)
        for _ in range(2):
            assert len((await board.pixels.recv()).tdata) == 16 * pixels
    await board.write(CONTROL, BEGIN | FINISH)
    assert len((await board.pixels.recv()).tdata) == 16 * pixels
    assert await board.read(CONTROL) & (BEGIN | FINISH) == 0


async def cycles_of_packets(dut, count):
    """The cycles in which the last beats of so many packets are taken."""
    cycles = []
    for cycle in itertools.count():
        await RisingEdge(dut.aclk)
        moves = dut.s_axis_packet_tvalid.value == 1 and dut.s_axis_packet_tready.value == 1
        if moves and dut.s_axis_packet_tlast.value == 1:
            cycles.append(cycle)
        if len(cycles) == count:
            return cycles


@cocotb.test()
async def packets_follow_each_other_without_a_bubble(dut):
    """Beats of packets behind each other take a cycle each, up to the next in four in which the primitive takes a packet."""
    kernel = Kernel(os.environ["SPLATLINE_KERNEL"])
    beats = -(-kernel.words * 32 // len(dut.s_axis_packet_tdata))
    cocotb.start_soon(Clock(dut.aclk, 10, unit="ns").start())
    board = Board(dut)
    await board.reset()
    await board.begin(kernel.tile(chosen_tiles()[0]))
    # As many as have a place in the primitive, whatever they paint.
    count = 24
    data = b"".join(word.to_bytes(4, "little") for word in kernel.packet(0))
    for _ in range(count):
        board.packets.send_nowait(AxiStreamFrame(data))
    cycles = await cycles_of_packets(dut, count)
    steps = [later - cycle for cycle, later in itertools.pairwise(cycles)]
    # The first ones wait for the primitive's turn.
    assert set(steps[2:]) == {4 * -(-beats // 4)}, steps
    dut._log.info("a packet in %d beats, one in %d cycles", beats, steps[-1])
