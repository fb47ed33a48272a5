//! Handshakes that coincide: what the circuit does where two of its interfaces, or an interface and reset, act in the same cycle.
//!
//! A bench that offers one thing after the other never meets these cycles; a board does. Each test draws a tile whose pixels are known from
//! a quiet run, disturbs it, and looks at that tile and at the next.

use crate::bench::{Bench, Pauses, pixel};
use crate::golden::Golden;
use crate::model::{Inputs, Outputs};
use crate::suite::LANES;
use crate::workload::{self, BenchTile, BenchWorkload};
use splatline::blend::Pixel;
use splatline::format::Lean18;
use splatline::raster::Window;
use splatline::rules::Rules;

/// Cycles within which anything must happen.
const PATIENCE: usize = 20_000;

/// A tile of random splats that cover it, a circuit, and what the kernel draws.
struct HandshakeScene {
    bench: Bench,
    load: BenchWorkload,
    tile: BenchTile,
    expected: Vec<Pixel>,
}

impl HandshakeScene {
    fn new(lanes: usize) -> HandshakeScene {
        let widths = Lean18::WIDTHS;
        let load = workload::random(&widths, 40, 20, 5);
        let tile = load.tiles[0].clone();
        let expected = Golden::new(Lean18, &Rules::EWA)
            .draw(&tile, &load.footprints)
            .0;
        let clear = Pixel::clear(&widths);
        assert!(expected.iter().any(|pixel| *pixel != clear));
        let bench = Bench::new("lean18", &widths, lanes, &Rules::EWA, 3).unwrap();
        HandshakeScene {
            bench,
            load,
            tile,
            expected,
        }
    }

    /// Steps with these inputs until the circuit's outputs are as wanted.
    fn until(&mut self, inputs: &Inputs, wanted: impl Fn(&Outputs) -> bool) -> Outputs {
        for _ in 0..PATIENCE {
            let out = self.bench.step(inputs);
            if wanted(&out) {
                return out;
            }
        }
        panic!("the circuit hangs");
    }

    fn quiet(&self) -> Inputs {
        self.bench.pixel_offer(false)
    }

    fn packet(&self, place: usize) -> Inputs {
        let index = self.tile.list[place] as usize;
        self.bench.packet_offer(&self.load.footprints[index])
    }

    fn open(&mut self) {
        let offer = self.bench.tile_offer(&self.tile);
        self.until(&offer, |out| out.tile_ready == 1);
    }

    /// Ends the tile and reads it out.
    fn close(&mut self) -> Vec<Pixel> {
        let finish = self.bench.finish_offer();
        self.until(&finish, |out| out.finish_ready == 1);
        self.read()
    }

    fn read(&mut self) -> Vec<Pixel> {
        let take = self.bench.pixel_offer(true);
        let read =
            |scene: &mut HandshakeScene| pixel(&scene.until(&take, |out| out.pixel_valid == 1));
        (0..self.expected.len()).map(|_| read(self)).collect()
    }

    /// The same tile, drawn quietly, is the kernel's: nothing lingers.
    fn assert_sound(&mut self) {
        let (tile, load) = (self.tile.clone(), self.load.footprints.clone());
        let drawn = self.bench.draw(&tile, &load, Pauses::default()).unwrap();
        assert!(drawn.pixels == self.expected, "a trace of what came before");
    }
}

/// An idle primitive is offered a packet and `finish` in the same cycle, for every packet of the tile: it takes the packet.
#[test]
fn a_packet_offered_with_finish_belongs_to_its_tile() {
    for lanes in LANES {
        let mut scene = HandshakeScene::new(lanes);
        scene.open();
        for place in 0..scene.tile.list.len() {
            let quiet = scene.quiet();
            scene.until(&quiet, |out| out.idle == 1);
            let both = Inputs {
                finish_valid: 1,
                ..scene.packet(place)
            };
            let out = scene.until(&both, |out| out.packet_ready == 1);
            assert_eq!(out.finish_ready, 0, "both were taken at once");
        }
        assert!(scene.close() == scene.expected, "{lanes} lanes");
        scene.assert_sound();
    }
}

/// `finish` waits from the first packet on, while packets come at random: it is taken after the last one and its pixels.
#[test]
fn finish_waits_for_what_was_taken() {
    for lanes in LANES {
        let mut scene = HandshakeScene::new(lanes);
        scene.open();
        for place in 0..scene.tile.list.len() {
            let both = Inputs {
                finish_valid: 1,
                ..scene.packet(place)
            };
            scene.until(&both, |out| out.packet_ready == 1);
        }
        let finish = scene.bench.finish_offer();
        let out = scene.until(&finish, |out| out.finish_ready == 1);
        assert_eq!(out.idle, 1);
        assert!(scene.read() == scene.expected, "{lanes} lanes");
    }
}

/// The next tile is drawn while this one is read out; its end waits until the last pixel has been taken, and not a word of either is the other's.
#[test]
fn a_tile_is_drawn_while_the_one_before_is_read_out() {
    for lanes in LANES {
        let mut scene = HandshakeScene::new(lanes);
        scene.open();
        for place in 0..scene.tile.list.len() {
            let packet = scene.packet(place);
            scene.until(&packet, |out| out.packet_ready == 1);
        }
        let finish = scene.bench.finish_offer();
        scene.until(&finish, |out| out.finish_ready == 1);
        let open = scene.bench.tile_offer(&scene.tile);
        let out = scene.bench.step(&open);
        assert_eq!((out.tile_ready, out.packet_ready), (1, 0));
        // Every third cycle a pixel is taken; all the while packets are offered, and finish, once they are through.
        let (mut place, mut pixels) = (0, Vec::new());
        for cycle in 0.. {
            assert!(cycle < PATIENCE, "the circuit hangs");
            let offer = if place < scene.tile.list.len() {
                scene.packet(place)
            } else {
                scene.bench.finish_offer()
            };
            let inputs = Inputs {
                pixel_ready: (cycle % 3 == 0).into(),
                ..offer
            };
            let out = scene.bench.step(&inputs);
            place += usize::from(inputs.packet_valid == 1 && out.packet_ready == 1);
            if out.pixel_valid == 1 && inputs.pixel_ready == 1 {
                pixels.push(pixel(&out));
            }
            if out.finish_ready == 1 {
                break;
            }
        }
        assert_eq!(place, scene.tile.list.len());
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
            lanes_enable: 0,
            ..inputs
        };
        // More than one, since a splat may have no pixel in the window.
        const HELD: usize = 6;
        for place in 0..HELD {
            let packet = hold(scene.packet(place));
            scene.until(&packet, |out| out.packet_ready == 1);
        }
        let finish = hold(scene.bench.finish_offer());
        for cycle in 0..2_000 {
            let out = scene.bench.step(&finish);
            assert_eq!((out.finish_ready, out.lanes_popped), (0, 0), "{cycle}");
        }
        for place in HELD..scene.tile.list.len() {
            let packet = scene.packet(place);
            scene.until(&packet, |out| out.packet_ready == 1);
        }
        // Every other cycle, while `finish` waits.
        let finish = scene.bench.finish_offer();
        for cycle in 0.. {
            let inputs = if cycle % 2 == 0 { hold(finish) } else { finish };
            if scene.bench.step(&inputs).finish_ready == 1 {
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
        let reset = |inputs: Inputs| Inputs { rst: 1, ..inputs };
        for cycles in (0..160).step_by(7) {
            scene.open();
            for place in 0..4 {
                let packet = scene.packet(place);
                scene.until(&packet, |out| out.packet_ready == 1);
            }
            let finish = scene.bench.finish_offer();
            if cycles % 2 == 1 {
                scene.until(&finish, |out| out.finish_ready == 1);
            }
            let take = scene.bench.pixel_offer(true);
            (0..cycles).for_each(|_| {
                scene.bench.step(&take);
            });
            let everything = Inputs {
                packet_valid: 1,
                packet: scene.packet(0).packet,
                finish_valid: 1,
                pixel_ready: 1,
                ..scene.bench.tile_offer(&scene.tile)
            };
            scene.bench.step(&reset(everything));
            let quiet = scene.quiet();
            let out = scene.bench.step(&quiet);
            assert_eq!(
                (out.tile_ready, out.idle, out.pixel_valid),
                (0, 1, 0),
                "{lanes} lanes, reset after {cycles} cycles"
            );
            // Both buffers are cleared, all lanes at once, and nothing comes out meanwhile.
            let clearing = 1024 / lanes as u64;
            let start = scene.bench.cycles();
            let out = scene.until(&take, |out| out.tile_ready == 1 || out.pixel_valid == 1);
            assert_eq!(
                (out.pixel_valid, scene.bench.cycles() - start),
                (0, clearing)
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
        let [x, y] = scene.tile.window.first;
        for last in [[x, y + 3], [x + 3, y], [x, y]] {
            let window = Window {
                first: [x, y],
                end: last,
            };
            let list = Vec::new();
            let offer = scene.bench.tile_offer(&BenchTile { window, list });
            scene.until(&offer, |out| out.tile_ready == 1);
            let packet = scene.packet(0);
            scene.until(&packet, |out| out.packet_ready == 1);
            let finish = scene.bench.finish_offer();
            scene.until(&finish, |out| out.finish_ready == 1);
            let take = scene.bench.pixel_offer(true);
            for _ in 0..8 {
                let out = scene.bench.step(&take);
                assert_eq!(
                    (out.tile_ready, out.pixel_valid),
                    (1, 0),
                    "{lanes} lanes, up to {last:?}"
                );
            }
            scene.assert_sound();
        }
    }
}
