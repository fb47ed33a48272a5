//! Handshakes that coincide: what the circuit does where two of its interfaces, or an interface and reset, act in the
//! same cycle.
//!
//! A bench that offers one thing after the other never meets these cycles; a board does. Each test draws a tile whose
//! pixels are known, disturbs it, and looks at that tile and at the next.
#![cfg(has_rtl)]

use splatline::blend::Pixel;
use splatline::footprint::packet::{Layout, VERSION};
use splatline::format::{Lean18, Traversal};
use splatline::raster::Window;
use splatline::rules::Rules;
use splatline_rtl::bench::Bench;
use splatline_rtl::primitive::unit::{LANES, circuit, draw, pixel};
use splatline_rtl::primitive::workload::{self, BenchWorkload};
use splatline_rtl::rules::write_rules;
use splatline_rtl::unit::Extent;
use splatline_sim::design::DesignChoice;
use splatline_sim::machine::primitive::Intervals;
use splatline_sim::scene::synthetic::Random;

/// Cycles within which anything must happen.
const PATIENCE: usize = 20_000;

/// What the circuit is offered in a cycle.
#[derive(Clone, Default)]
struct Inputs {
    rst: bool,
    tile: Option<Window>,
    packet: Option<Vec<u32>>,
    finish: bool,
    pixel_ready: bool,
    held: bool,
}

/// What it answers.
struct Outputs {
    tile_ready: bool,
    packet_ready: bool,
    finish_ready: bool,
    pixel_valid: bool,
    idle: bool,
    raster_idle: bool,
    lanes_popped: u64,
    foreign_packets: u64,
    pixel: Pixel,
}

/// A tile of random splats that cover it, a circuit, and what the kernel draws.
struct HandshakeScene {
    bench: Bench,
    load: BenchWorkload,
    window: Window,
    packets: Vec<Vec<u32>>,
    expected: Vec<Pixel>,
    /// When the first packet was taken, and the cycles of the tile from then to the last packet's last pixel.
    first_taken: Option<u64>,
    raster_cycles: u64,
}

impl HandshakeScene {
    fn new(lanes: u32) -> HandshakeScene {
        let widths = Lean18::WIDTHS;
        let load = workload::random(&widths, 40, 20, 5);
        let tile = load.tiles[0].clone();
        let design = DesignChoice::load("lean18").unwrap();
        let drawn = draw(&design, &Rules::EWA, &load.tiles[..1], &load.footprints);
        let expected = drawn.unwrap().0;
        let clear = Pixel::clear(&widths);
        assert!(expected.iter().any(|pixel| *pixel != clear));
        let circuit = circuit("lean18", lanes, Intervals::USUAL).unwrap();
        let library = circuit.library(Extent::Quick).unwrap();
        let mut bench = Bench::new(&library, 3, 0).unwrap();
        write_rules(&mut bench, &widths, &Rules::EWA);
        let layout = Layout::new(&widths, Traversal::Spans);
        let packet = |index: &u32| layout.encode(&load.footprints[*index as usize]).to_vec();
        HandshakeScene {
            bench,
            window: tile.window,
            packets: tile.list.iter().map(packet).collect(),
            load,
            expected,
            first_taken: None,
            raster_cycles: 0,
        }
    }

    fn step(&mut self, inputs: &Inputs) -> Outputs {
        let window = inputs.tile.unwrap_or(self.window);
        let set = [
            ("rst", inputs.rst.into()),
            ("tile_valid", inputs.tile.is_some().into()),
            ("first_column", window.first[0].into()),
            ("first_row", window.first[1].into()),
            ("end_column", window.end[0].into()),
            ("end_row", window.end[1].into()),
            ("packet_valid", inputs.packet.is_some().into()),
            ("finish_valid", inputs.finish.into()),
            ("pixel_ready", inputs.pixel_ready.into()),
            ("lanes_enable", (!inputs.held).into()),
        ];
        self.bench.set(&set);
        let circuit = &mut self.bench.circuit;
        if let Some(packet) = &inputs.packet {
            let port = circuit.port("packet");
            circuit.set_words(port, packet);
        }
        circuit.settle();
        let get = |name| circuit.read(name);
        let words = ["finished", "transmittance", "red", "green", "blue"];
        let outputs = Outputs {
            tile_ready: get("tile_ready") == 1,
            packet_ready: get("packet_ready") == 1,
            finish_ready: get("finish_ready") == 1,
            pixel_valid: get("pixel_valid") == 1,
            idle: get("idle") == 1,
            raster_idle: get("raster_idle") == 1,
            lanes_popped: get("lanes_popped"),
            foreign_packets: get("foreign_packets"),
            pixel: pixel(&words.map(|name| vec![get(name) as u32])),
        };
        circuit.edge();
        self.bench.cycles += 1;
        outputs
    }

    /// Steps with these inputs until the circuit's outputs are as wanted.
    fn until(&mut self, inputs: &Inputs, wanted: impl Fn(&Outputs) -> bool) -> Outputs {
        for _ in 0..PATIENCE {
            let out = self.step(inputs);
            if wanted(&out) {
                return out;
            }
        }
        panic!("the circuit hangs");
    }

    fn quiet(&self) -> Inputs {
        Inputs::default()
    }

    fn packet(&self, place: usize) -> Inputs {
        Inputs {
            packet: Some(self.packets[place].clone()),
            ..Inputs::default()
        }
    }

    fn tile_offer(&self) -> Inputs {
        Inputs {
            tile: Some(self.window),
            ..Inputs::default()
        }
    }

    fn finish_offer(&self) -> Inputs {
        Inputs {
            finish: true,
            ..Inputs::default()
        }
    }

    fn pixel_offer(&self) -> Inputs {
        Inputs {
            pixel_ready: true,
            ..Inputs::default()
        }
    }

    fn open(&mut self) {
        self.until(&self.tile_offer(), |out| out.tile_ready);
    }

    fn draw(&mut self, packets: &[Vec<u32>]) -> Vec<Pixel> {
        self.open();
        for packet in packets {
            let offer = Inputs {
                packet: Some(packet.clone()),
                ..Inputs::default()
            };
            self.until(&offer, |out| out.packet_ready);
            self.first_taken.get_or_insert(self.bench.cycles);
        }
        self.until(&self.quiet(), |out| out.raster_idle);
        let first = self.first_taken.take();
        self.raster_cycles = first.map_or(0, |first| self.bench.cycles - first);
        self.close()
    }

    /// Ends the tile and reads it out.
    fn close(&mut self) -> Vec<Pixel> {
        self.until(&self.finish_offer(), |out| out.finish_ready);
        self.read()
    }

    fn read(&mut self) -> Vec<Pixel> {
        let take = self.pixel_offer();
        let count = self.expected.len();
        let read = |_| self.until(&take, |out| out.pixel_valid).pixel;
        (0..count).map(read).collect()
    }

    /// The same tile, drawn quietly, is the kernel's: nothing lingers.
    fn assert_sound(&mut self) {
        let packets = self.packets.clone();
        assert!(
            self.draw(&packets) == self.expected,
            "a trace of what came before"
        );
    }
}

/// An idle primitive is offered a packet and `finish` in the same cycle, for every packet of the tile: it takes the
/// packet.
#[test]
fn a_packet_offered_with_finish_belongs_to_its_tile() {
    for lanes in LANES {
        let mut scene = HandshakeScene::new(lanes);
        scene.open();
        for place in 0..scene.packets.len() {
            let quiet = scene.quiet();
            scene.until(&quiet, |out| out.idle);
            let both = Inputs {
                finish: true,
                ..scene.packet(place)
            };
            let out = scene.until(&both, |out| out.packet_ready);
            assert!(!out.finish_ready, "both were taken at once");
        }
        assert!(scene.close() == scene.expected, "{lanes} lanes");
        scene.assert_sound();
    }
}

/// `finish` waits from the first packet on, while packets come at random: it is taken after the last one and its
/// pixels.
#[test]
fn finish_waits_for_what_was_taken() {
    for lanes in LANES {
        let mut scene = HandshakeScene::new(lanes);
        scene.open();
        for place in 0..scene.packets.len() {
            let both = Inputs {
                finish: true,
                ..scene.packet(place)
            };
            scene.until(&both, |out| out.packet_ready);
        }
        let finish = scene.finish_offer();
        let out = scene.until(&finish, |out| out.finish_ready);
        assert!(out.idle);
        assert!(scene.read() == scene.expected, "{lanes} lanes");
    }
}

/// The next tile is drawn while this one is read out; its end waits until the last pixel has been taken, and not a word
/// of either is the other's.
#[test]
fn a_tile_is_drawn_while_the_one_before_is_read_out() {
    for lanes in LANES {
        let mut scene = HandshakeScene::new(lanes);
        scene.open();
        for place in 0..scene.packets.len() {
            let packet = scene.packet(place);
            scene.until(&packet, |out| out.packet_ready);
        }
        let finish = scene.finish_offer();
        scene.until(&finish, |out| out.finish_ready);
        let open = scene.tile_offer();
        let out = scene.step(&open);
        assert_eq!((out.tile_ready, out.packet_ready), (true, false));
        // Every third cycle a pixel is taken; all the while packets are offered, and finish, once they are through.
        let (mut place, mut pixels) = (0, Vec::new());
        for cycle in 0.. {
            assert!(cycle < PATIENCE, "the circuit hangs");
            let offer = if place < scene.packets.len() {
                scene.packet(place)
            } else {
                scene.finish_offer()
            };
            let inputs = Inputs {
                pixel_ready: cycle % 3 == 0,
                ..offer
            };
            let out = scene.step(&inputs);
            place += usize::from(inputs.packet.is_some() && out.packet_ready);
            if out.pixel_valid && inputs.pixel_ready {
                pixels.push(out.pixel);
            }
            if out.finish_ready {
                break;
            }
        }
        assert_eq!(place, scene.packets.len());
        assert!(pixels == scene.expected, "{lanes} lanes");
        assert!(scene.read() == scene.expected, "{lanes} lanes, next tile");
        scene.assert_sound();
    }
}

/// Lanes that may not move do not: nothing is popped, `finish` is not taken; afterwards the tile is whole.
#[test]
fn lanes_wait_for_their_enable() {
    for lanes in LANES {
        let mut scene = HandshakeScene::new(lanes);
        scene.open();
        let hold = |inputs: Inputs| Inputs {
            held: true,
            ..inputs
        };
        // More than one, since a splat may have no pixel in the window.
        const HELD: usize = 6;
        for place in 0..HELD {
            let packet = hold(scene.packet(place));
            scene.until(&packet, |out| out.packet_ready);
        }
        let finish = hold(scene.finish_offer());
        for cycle in 0..2_000 {
            let out = scene.step(&finish);
            assert_eq!((out.finish_ready, out.lanes_popped), (false, 0), "{cycle}");
        }
        for place in HELD..scene.packets.len() {
            let packet = scene.packet(place);
            scene.until(&packet, |out| out.packet_ready);
        }
        // Every other cycle, while `finish` waits.
        let finish = scene.finish_offer();
        for cycle in 0.. {
            let offer = finish.clone();
            let inputs = if cycle % 2 == 0 { hold(offer) } else { offer };
            if scene.step(&inputs).finish_ready {
                break;
            }
            assert!(cycle < PATIENCE, "the circuit hangs");
        }
        assert!(scene.read() == scene.expected, "{lanes} lanes");
    }
}

/// Reset in every phase of a tile, together with every offer: the next tile bears no trace.
#[test]
fn reset_in_mid_tile_leaves_no_trace() {
    for lanes in LANES {
        let mut scene = HandshakeScene::new(lanes);
        let reset = |inputs: Inputs| Inputs {
            rst: true,
            ..inputs
        };
        for cycles in (0..160).step_by(7) {
            scene.open();
            for place in 0..4 {
                let packet = scene.packet(place);
                scene.until(&packet, |out| out.packet_ready);
            }
            let finish = scene.finish_offer();
            if cycles % 2 == 1 {
                scene.until(&finish, |out| out.finish_ready);
            }
            let take = scene.pixel_offer();
            (0..cycles).for_each(|_| {
                scene.step(&take);
            });
            let everything = Inputs {
                packet: scene.packet(0).packet,
                finish: true,
                pixel_ready: true,
                ..scene.tile_offer()
            };
            scene.step(&reset(everything));
            let quiet = scene.quiet();
            let out = scene.step(&quiet);
            assert_eq!(
                (out.tile_ready, out.idle, out.pixel_valid),
                (false, true, false),
                "{lanes} lanes, reset after {cycles} cycles"
            );
            // Both buffers are cleared, all lanes at once, and nothing comes out meanwhile.
            let clearing = 1024 / u64::from(lanes);
            let start = scene.bench.cycles;
            let out = scene.until(&take, |out| out.tile_ready || out.pixel_valid);
            assert_eq!(
                (out.pixel_valid, scene.bench.cycles - start),
                (false, clearing)
            );
            scene.assert_sound();
        }
    }
}

/// A window without columns or rows reads nothing out, whatever was drawn, and the next tile is whole.
#[test]
fn an_empty_window_reads_out_nothing() {
    for lanes in LANES {
        let mut scene = HandshakeScene::new(lanes);
        let [x, y] = scene.window.first;
        for last in [[x, y + 3], [x + 3, y], [x, y]] {
            let window = Window {
                first: [x, y],
                end: last,
            };
            let offer = Inputs {
                tile: Some(window),
                ..Inputs::default()
            };
            scene.until(&offer, |out| out.tile_ready);
            let packet = scene.packet(0);
            scene.until(&packet, |out| out.packet_ready);
            let finish = scene.finish_offer();
            scene.until(&finish, |out| out.finish_ready);
            let take = scene.pixel_offer();
            for _ in 0..8 {
                let out = scene.step(&take);
                assert_eq!(
                    (out.tile_ready, out.pixel_valid),
                    (true, false),
                    "{lanes} lanes, up to {last:?}"
                );
            }
            scene.assert_sound();
        }
    }
}

/// Packets of arbitrary bits leave no splat stuck and the next tile untouched.
#[test]
fn hostile_packets_neither_hang_nor_linger() {
    let layout = Layout::new(&Lean18::WIDTHS, Traversal::Spans);
    for lanes in LANES {
        let mut scene = HandshakeScene::new(lanes);
        let mut random = Random(17);
        let mut hostile = Vec::new();
        for footprint in &mut scene.load.footprints[..20] {
            let mut bits = || random.next() as i64;
            footprint.centre = [bits(), bits()];
            footprint.ldl.shear.mantissa = bits() as i32;
            footprint.ldl.shear.exponent = bits() as i32 % 512;
            footprint.ldl.vertical.exponent = bits() as i32 % 512;
            footprint.ldl.horizontal.exponent = bits() as i32 % 512;
            footprint.ldl.squared_width.exponent = bits() as i32 % 512;
            footprint.first = [bits() as u16, bits() as u16];
            footprint.end = [bits() as u16, bits() as u16];
            footprint.cutoff = bits() as u32;
            hostile.push(layout.encode(footprint).to_vec());
        }
        let mut cycles = Vec::new();
        for packets in [scene.packets.clone(), hostile, scene.packets.clone()] {
            let pixels = scene.draw(&packets);
            cycles.push(scene.raster_cycles);
            let sound = packets == scene.packets;
            assert!(!sound || pixels == scene.expected, "{lanes} lanes");
        }
        assert_eq!(cycles[0], cycles[2], "the tiles' cycles");
    }
}

#[test]
fn packets_of_another_version_are_dropped_and_counted() {
    let mut scene = HandshakeScene::new(1);
    scene.open();
    let mut packet = vec![0; scene.packets[0].len()];
    packet[0] = VERSION + 1;
    let offer = Inputs {
        packet: Some(packet),
        ..Inputs::default()
    };
    scene.until(&offer, |out| out.packet_ready);
    let out = scene.step(&scene.quiet());
    assert_eq!((out.foreign_packets, out.raster_idle), (1, true));
}

#[test]
fn an_empty_tile_is_transparent_black() {
    let mut scene = HandshakeScene::new(4);
    let clear = Pixel::clear(&Lean18::WIDTHS);
    assert!(scene.draw(&[]).iter().all(|pixel| *pixel == clear));
}
