"""The splat primitive as a LiteX module: registers for the SoC's bus, packets and pixels as streams.

    self.splat = Splat(platform, lanes=4)
    self.bus.add_slave("splat", self.splat.bus, SoCRegion(0x9000_0000, Splat.SIZE, cached=False))
    self.comb += [dma.source.connect(self.splat.sink), self.splat.source.connect(frame.sink)]

registers.json lists the registers. `run_litex.py` beside this file simulates a SoC. Needs `pip install litex`.
"""

from pathlib import Path

from litex.build.generic_platform import GenericPlatform
from litex.gen import LiteXModule
from litex.soc.interconnect import stream
from litex.soc.interconnect.axi import AXILiteInterface
from migen import ClockSignal, Instance, ResetSignal

RTL = Path(__file__).resolve().parent.parent


def add_sources(platform: GenericPlatform, design: str | Path) -> None:
    """The sources in their order. The design is lean18, standard24 or the folder of a package of your own."""
    package = RTL / design / "splatline_pkg.sv"
    if not package.exists():
        raise ValueError(f"the design {design} has no package: {package}")
    if any(Path(name).name == package.name and Path(name) != package for name, *_ in platform.sources):
        raise ValueError(f"the chip has the package of another design than {design}, and both are of one name")
    units = (RTL / "files.txt").read_text().split()
    for source in (package, *map(RTL.joinpath, units), RTL / "shell" / "splat_axi.sv"):
        platform.add_source(str(source))


class Splat(LiteXModule):
    """`splat_axi`, whose head describes both streams. A packet's last word has `last`, as a tile's last pixel has."""

    SIZE = 0x80  # of the registers, in bytes

    def __init__(
        self,
        platform: GenericPlatform,
        design: str | Path = "lean18",
        lanes: int = 1,
        queue: int = 8,
        setup_interval: int = 4,
        row_interval: int = 1,
        added_bits: int = 4,
        wide_multipliers: int = 4,
    ):
        self.bus = bus = AXILiteInterface(data_width=32, address_width=32)
        self.sink = sink = stream.Endpoint([("data", 32)])
        self.source = source = stream.Endpoint([("data", 128)])
        add_sources(platform, design)
        ports = {
            "i_aclk": ClockSignal(),
            "i_aresetn": ~ResetSignal(),
            "i_s_axis_packet_tdata": sink.data,
            "i_s_axis_packet_tvalid": sink.valid,
            "o_s_axis_packet_tready": sink.ready,
            "i_s_axis_packet_tlast": sink.last,
            "o_m_axis_pixel_tdata": source.data,
            "o_m_axis_pixel_tvalid": source.valid,
            "i_m_axis_pixel_tready": source.ready,
            "o_m_axis_pixel_tlast": source.last,
        }
        for name, channel in (("aw", bus.aw), ("ar", bus.ar)):
            ports |= {f"i_s_axil_{name}addr": channel.addr[:7], f"i_s_axil_{name}prot": channel.prot}
        for name, channel in (("aw", bus.aw), ("w", bus.w), ("ar", bus.ar)):
            ports |= {f"i_s_axil_{name}valid": channel.valid, f"o_s_axil_{name}ready": channel.ready}
        for name, channel in (("b", bus.b), ("r", bus.r)):
            ports |= {f"o_s_axil_{name}valid": channel.valid, f"i_s_axil_{name}ready": channel.ready}
            ports[f"o_s_axil_{name}resp"] = channel.resp
        ports |= {"i_s_axil_wdata": bus.w.data, "i_s_axil_wstrb": bus.w.strb, "o_s_axil_rdata": bus.r.data}
        parameters = {"p_LANES": lanes, "p_QUEUE": queue, "p_SETUP_INTERVAL": setup_interval}
        parameters |= {"p_ROW_INTERVAL": row_interval, "p_ADDED_BITS": added_bits}
        parameters |= {"p_WIDE_MULTIPLIERS": wide_multipliers}
        self.specials += Instance("splat_axi", name="splat_axi", **parameters, **ports)
