"""Simulates a LiteX SoC with the splat primitive: `python3 sim/rtl/shell/run_litex.py [--lanes N] [TILE ...]`.

The SoC has no CPU. A sequencer writes the registers over the SoC's bus, a DMA reader streams the packets of the C
interface's example picture from a memory on that bus, and the kernel judges every pixel that comes out. Packets and
registers' values are those of `test_splat_axi.py`.

Needs verilator, a C++ compiler and cargo, and `pip install litex 'cocotb>=2' cocotbext-axi`. LiteX's own main program
around Verilator wants libraries that its package does not bring, so that a bench of a few lines gives the clock. All is
built in target/shell/litex.
"""

import argparse
import asyncio
import os
import subprocess
from pathlib import Path

import run
import test_splat_axi as bench
from litex.build.generic_platform import Pins
from litex.build.io import CRG
from litex.build.sim import SimPlatform
from litex.gen import LiteXModule
from litex.soc.cores.dma import WishboneDMAReader
from litex.soc.integration.soc import SoCRegion
from litex.soc.integration.soc_core import SoCMini
from litex.soc.interconnect import stream, wishbone
from migen import Cat, Display, Finish, If, Memory, Signal
from splat_litex import Splat

BUILD = run.BUILD / "litex"
WRITE, POLL, SEND = range(3)
REGISTERS, PACKETS = 0x9000_0000, 0x4000_0000
# Cycles without a pixel after which none is expected, and those of the whole run at most.
QUIET, LIMIT = 1 << 14, 20_000_000
TOP = f"""module top;
  reg clock = 0;
  always #1 clock = !clock;
  initial #{2 * LIMIT} $finish;
  sim soc(.sys_clk(clock), .sim_trace());
endmodule
"""


class Script(bench.Board):
    """The bench's board, whose accesses are written down as steps of the sequencer."""

    def __init__(self) -> None:
        self.steps: list[tuple[int, int, int]] = []

    async def write(self, address: int, value: int) -> None:
        self.steps.append((WRITE, REGISTERS + address, value))

    async def read(self, address: int) -> int:
        """Reads until begin and end are done, and any other register once."""
        self.steps.append((POLL, REGISTERS + address, bench.BEGIN | bench.FINISH if address == bench.CONTROL else 0))
        return 0

    async def draw(self, kernel: bench.Kernel, tiles: list[int]) -> None:
        # They are 0 after a reset, which this picture does not tell from their values.
        for rule in (bench.STOP, bench.LEAST_HIGH):
            await self.write(rule, 0xFFFF_FFFF)
        await self.load(kernel)
        for tile in tiles:
            await self.begin(kernel.tile(tile))
            self.steps.append((SEND, 0, 0))
            await self.write(bench.CONTROL, bench.FINISH)
            await self.read(bench.CONTROL)
        for counter in (bench.PACKETS, bench.FOREIGN, bench.BROKEN):
            await self.read(counter)


class Sequencer(LiteXModule):
    """Takes steps one after the other: a write, reads until the value's bits are 0, or packets until they are sent."""

    def __init__(self, steps: list[tuple[int, int, int]]):
        self.bus = bus = wishbone.Interface(data_width=32, address_width=32, addressing="word")
        self.send, self.sent, self.done = Signal(), Signal(), Signal()
        memory = Memory(66, len(steps), init=[kind << 64 | address << 32 | value for kind, address, value in steps])
        port = memory.get_port(async_read=True)
        self.specials += memory, port
        step, kind, address, value = Signal(max=len(steps) + 1), Signal(2), Signal(32), Signal(32)
        is_read, moves = Signal(), Signal()
        self.comb += [
            port.adr.eq(step),
            Cat(value, address, kind).eq(port.dat_r),
            self.done.eq(step == len(steps)),
            self.send.eq(~self.done & (kind == SEND)),
            bus.cyc.eq(~self.done & (kind != SEND)),
            bus.stb.eq(bus.cyc),
            bus.we.eq(kind == WRITE),
            bus.adr.eq(address[2:]),
            bus.sel.eq(0xF),
            bus.dat_w.eq(value),
            is_read.eq(bus.cyc & bus.ack & ~bus.we & ((bus.dat_r & value) == 0)),
            moves.eq(is_read | (bus.cyc & bus.ack & bus.we) | (self.send & self.sent)),
        ]
        self.sync += [If(moves, step.eq(step + 1)), If(is_read, Display("register %x", bus.dat_r))]


class SoC(SoCMini):
    """The primitive, its packets in a memory, and who fills the registers and takes the pixels."""

    def __init__(self, platform: SimPlatform, steps: list[tuple[int, int, int]], packets: list[list[int]], lanes: int):
        SoCMini.__init__(self, platform, clk_freq=int(100e6))
        self.crg = CRG(platform.request("sys_clk"))
        self.splat = Splat(platform, run.DESIGN, lanes)
        self.bus.add_slave("splat", self.splat.bus, SoCRegion(origin=REGISTERS, size=Splat.SIZE, cached=False))
        self.sequencer = Sequencer(steps)
        self.bus.add_master("sequencer", self.sequencer.bus)
        self.add_packets([word for packet in packets for word in packet], len(packets[0]))
        self.take_pixels(self.splat.source)

    def add_packets(self, words: list[int], length: int) -> None:
        """All packets whenever the sequencer asks for them. `last` goes with a packet's last word."""
        self.add_rom("packets", PACKETS, 4 * len(words), words)
        bus = wishbone.Interface(data_width=32, address_width=32, addressing="word")
        self.dma = dma = WishboneDMAReader(bus, endianness="big")
        self.bus.add_master("dma", bus)
        asked, word, place = self.sequencer.send, Signal(max=len(words) + 1), Signal(max=length)
        self.comb += [
            dma.sink.valid.eq(asked & (word != len(words))),
            dma.sink.address.eq(PACKETS // 4 + word),
            dma.sink.last.eq(place == length - 1),
            dma.source.connect(self.splat.sink),
            self.sequencer.sent.eq((word == len(words)) & ~dma.source.valid),
        ]
        self.sync += [
            If(~asked, word.eq(0)),
            If(dma.sink.valid & dma.sink.ready, word.eq(word + 1), place.eq(place + 1), If(dma.sink.last, place.eq(0))),
        ]

    def take_pixels(self, source: stream.Endpoint) -> None:
        """Prints them, and holds them back in one cycle of four."""
        turn, quiet = Signal(2), Signal(max=QUIET + 1)
        self.comb += source.ready.eq(turn != 0)
        self.sync += [
            turn.eq(turn + 1),
            If(source.valid | ~self.sequencer.done, quiet.eq(0)).Else(quiet.eq(quiet + 1)),
            If(source.valid & source.ready, Display("pixel %x %x", source.last, source.data)),
            If(quiet == QUIET, Display("end"), Finish()),
        ]


def simulate(steps: list[tuple[int, int, int]], packets: list[list[int]], lanes: int) -> list[list[str]]:
    """The words of the lines that the simulation prints."""
    BUILD.mkdir(parents=True, exist_ok=True)
    os.chdir(BUILD)
    platform = SimPlatform("SIM", [("sys_clk", 0, Pins(1))])
    soc = SoC(platform, steps, packets, lanes)
    soc.finalize()
    platform.get_verilog(soc, name="sim").write("sim.v")
    Path("top.sv").write_text(TOP)
    sources = [name for name, *_ in platform.sources]
    # What LiteX writes has non-blocking assignments in combinational logic, which its own runs waive too.
    waived = ["-Wno-lint", "-Wno-style", "-Wno-COMBDLY", "-Wno-UNOPTFLAT"]
    options = ["--binary", "-O3", "--timescale", "1ns/1ps", "-MAKEFLAGS", "-s", *waived, "--top-module", "top"]
    run.run("verilator", *options, *sources, "sim.v", "top.sv", folder=BUILD)
    lines = subprocess.run(["obj_dir/Vtop"], check=True, capture_output=True, text=True).stdout.splitlines()
    return [line.split() for line in lines]


def judge(kernel: bench.Kernel, tiles: list[int], lines: list[list[str]]) -> None:
    """Compares every pixel and its `last`, and the counters of packets."""
    found = [(int(line[1]), int(line[2], 16)) for line in lines if line[:1] == ["pixel"]]
    wanted = []
    for left, top, right, bottom in map(kernel.tile, tiles):
        wanted += [(x, y, (x, y) == (right - 1, bottom - 1)) for y in range(top, bottom) for x in range(left, right)]
    pairs = list(zip(wanted, found))
    wrong = [(x, y) for (x, y, end), (last, word) in pairs if last != end or not kernel.is_pixel(x, y, word)]
    print(f"LiteX bench: {len(pairs)} pixels of {len(tiles)} tiles compared, {len(wrong)} differences")
    counters = [int(line[1], 16) for line in lines if line[:1] == ["register"]][-3:]
    if wrong:
        raise SystemExit(f"the first wrong pixel is {wrong[0]}")
    if len(found) != len(wanted):
        raise SystemExit(f"{len(found)} pixels came, {len(wanted)} are in the tiles")
    if ["end"] not in lines:
        raise SystemExit(f"no end in {LIMIT} cycles")
    if counters != [kernel.packets * len(tiles), 0, 0]:
        raise SystemExit(f"packets drawn, foreign and broken: {counters}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--lanes", type=int, default=1)
    parser.add_argument("tiles", type=int, nargs="*", default=[0, 2])
    options = parser.parse_args()
    run.BUILD.mkdir(parents=True, exist_ok=True)
    kernel = bench.Kernel(str(run.kernel()))
    script = Script()
    asyncio.run(script.draw(kernel, options.tiles))
    packets = [kernel.packet(index) for index in range(kernel.packets)]
    judge(kernel, options.tiles, simulate(script.steps, packets, options.lanes))


if __name__ == "__main__":
    main()
