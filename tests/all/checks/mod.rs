//! What must hold whatever the input: the bodies of the totality tests and of the fuzz targets.

#![allow(dead_code)] // Each fuzz target uses one of them.

use super::arbitrary::Source;
use splatline::blend::{Blend, Pixel};
use splatline::draw::{Coverage, Painter};
use splatline::footprint::Footprint;
use splatline::footprint::packet::{Layout, VERSION};
use splatline::format::{Classic8, Deep32, Design, Lean18, Standard24, Traversal, Widths};
use splatline::kernel::{FootprintTable, entries, fill_gaussian};
use splatline::math::{self, Product};
use splatline::raster::Window;
use splatline::rules::{Compositing, Rules};
use splatline::setup;
use splatline::splat::Axis;
use splatline::target::Target;

/// Every function of `math`, for any operands and any width that a design may ask for.
pub fn arithmetic(source: &mut Source) {
    let bits = 1 + u32::from(source.byte()) % 31;
    let (a, b) = (source.scaled(), source.scaled());
    let terms = [(); 4].map(|()| Product {
        value: source.i64(),
        exponent: source.i32(),
        length: u32::from(source.byte()) % 64,
    });
    let results = [
        math::sum_of_products(terms, bits),
        math::square_root(a, bits),
        math::reciprocal(a, bits).unwrap_or_default(),
        a.multiply(b, bits),
        math::SoftFloat::from_wide(source.i64(), source.i32(), bits),
        terms[0].normalise(bits),
    ];
    for result in results {
        assert!(
            result.mantissa.unsigned_abs() >> bits == 0,
            "{result:?} has more than {bits} bits"
        );
    }
    let fraction = u32::from(source.byte());
    let _ = (
        a.to_fixed(fraction),
        terms[0].to_fixed(fraction),
        a.leading(),
        a.scaled_by(source.i32()),
    );
    let (value, shift) = (source.i64(), source.u32());
    let _ = (
        math::shift_round(value, shift),
        math::shift_left(value, shift),
        math::shift_signed(value, shift as i32),
    );
    let _ = math::shift_unsigned(value as u64, shift as i32, source.widths().rounding);
    let _ = (math::ln(a), math::root_seed(value as u64));
    let _ = (
        Axis::from_components([a, b, source.scaled()]),
        Axis::from_covariance([(); 6].map(|()| source.scaled())),
    );
}

/// Setup as a whole under every design, and each of its units on inputs that no other unit would hand it.
pub fn setup(source: &mut Source) {
    let design = source.design();
    let (view, rules, splat) = (source.view(), source.rules(), source.volume_splat());
    let viewport = view.viewport;
    check_footprint(&setup::setup(design, &view, &rules, &splat), viewport);
    check_footprint(&setup::setup(Classic8, &view, &rules, &splat), viewport);
    check_footprint(&setup::setup(Lean18, &view, &rules, &splat), viewport);
    check_footprint(&setup::setup(Standard24, &view, &rules, &splat), viewport);
    check_footprint(&setup::setup(Deep32, &view, &rules, &splat), viewport);
    let (fixed_view, fixed_splat) = (source.fixed_view(view), source.fixed_splat(splat));
    check_footprint(
        &setup::setup(design, &fixed_view, &rules, &fixed_splat),
        viewport,
    );
    let view = source.sound_view();
    check_footprint(&setup::setup(design, &view, &rules, &splat), view.viewport);
    units_of_setup(source, &design.widths());
}

fn check_footprint(outcome: &Result<Footprint, setup::Cull>, viewport: [u16; 2]) {
    let Ok(footprint) = outcome else { return };
    for ((first, last), size) in footprint.first.iter().zip(footprint.end).zip(viewport) {
        assert!(*first < last && last <= size);
    }
    assert!(footprint.cutoff <= 15 << 28 && footprint.opacity > 0);
}

fn units_of_setup(source: &mut Source, widths: &Widths) {
    let (view, rules, splat) = (source.view(), source.rules(), source.volume_splat());
    let projected = setup::Projected {
        depth: source.extended(),
        centre: [(); 2].map(|()| source.i64()),
        ratio: [(); 2].map(|()| source.scaled()),
        gain: [(); 2].map(|()| source.scaled()),
    };
    let _ = setup::project_axes(widths, &view.rotation, &projected, &splat.axes);
    let columns = [(); 3].map(|()| setup::ScreenAxis {
        x: source.scaled(),
        y: source.scaled(),
    });
    let _ = setup::covariance(widths, rules.low_pass, &columns);
    let variance = setup::Covariance2d {
        xx: source.scaled(),
        xy: source.scaled(),
        yy: source.scaled(),
        determinant: source.scaled(),
    };
    let _ = (
        setup::ldl(widths, &variance),
        setup::conic(widths, &variance, source.scaled()),
    );
    let _ = setup::centre_opacity(widths, &rules, source.scaled(), &projected, &variance);
    let _ = (
        setup::cutoff(&rules, source.scaled()),
        setup::opacity_fixed(source.scaled(), widths.peak.into()),
    );
}

/// Any packet decodes to its footprint or names its version; what was decoded encodes to the same bits.
pub fn packet(source: &mut Source) {
    let layout = any_layout(source);
    let mut packet = source.packet();
    match layout.decode(&packet) {
        Err(error) => assert_ne!(error.found, VERSION),
        Ok(footprint) => {
            clear_unused(&mut packet, layout.bits());
            assert_eq!(layout.encode(&footprint), packet);
        }
    }
    let any = layout.encode(&source.footprint());
    assert!(layout.decode(&any).is_ok());
}

fn any_layout(source: &mut Source) -> Layout {
    let widths = source.widths();
    let traversal = [Traversal::Spans, Traversal::Box][usize::from(source.bool())];
    if source.bool() {
        Layout::with_depth(&widths, traversal)
    } else {
        Layout::new(&widths, traversal)
    }
}

fn clear_unused(packet: &mut [u32], bits: usize) {
    for (index, word) in packet.iter_mut().enumerate() {
        let used = bits.saturating_sub(index * 32).min(32);
        *word &= ((1u64 << used) - 1) as u32;
    }
}

/// Tables of any range and of any contents, looked up anywhere.
pub fn table(source: &mut Source) {
    let widths = source.widths();
    let range = source.bits(8) as u8;
    let mut memory = vec![0; entries(&widths)];
    fill_gaussian(&mut memory, &widths, range);
    assert!(
        memory.windows(2).all(|pair| pair[0] >= pair[1]),
        "the Gaussian falls: {widths:?}, range {range}"
    );
    for _ in 0..8 {
        let place = source.u32() as usize % memory.len();
        memory[place] = source.u32();
    }
    let table =
        FootprintTable::new(&memory, &widths, range).expect("the memory has the entries asked for");
    for _ in 0..16 {
        let _ = table.weight(source.i64() as u64);
    }
    assert!(FootprintTable::new(&memory[1..], &widths, range).is_err());
}

/// Any pixel under any splat: a transmittance never rises.
pub fn blend(source: &mut Source) {
    let widths = source.widths();
    let blend = Blend::new(&widths, &source.rules());
    let colour = [(); 3].map(|()| source.u32());
    let pixel = Pixel {
        colour: [(); 3].map(|()| source.u32()),
        transmittance: source.u32(),
    };
    let alpha = if source.bool() {
        blend.opacity(source.u32(), source.u32())
    } else {
        source.u32()
    };
    let mut after = [pixel; 3];
    blend.front_to_back(&mut after[0], alpha, &colour);
    blend.back_to_front(&mut after[1], alpha, &colour);
    blend.x_ray(&mut after[2], alpha, &colour);
    for result in after {
        assert!(
            result.transmittance() <= pixel.transmittance,
            "{pixel:?} under {alpha}: {result:?}"
        );
    }
}

/// Any footprints, made or decoded, drawn into any window.
pub fn draw(source: &mut Source) {
    let traversal = [Traversal::Spans, Traversal::Box][usize::from(source.bool())];
    let layout = Layout::new(&Standard24::WIDTHS, traversal);
    let footprint = if source.bool() {
        source.footprint()
    } else {
        layout
            .decode(&source.packet())
            .unwrap_or_else(|_| source.footprint())
    };
    let (window, rules, compositing) = (source.window(), source.rules(), source.compositing());
    let clear = source.bool();
    let pixel = Pixel {
        colour: [(); 3].map(|()| source.u32()),
        transmittance: source.u32(),
    };
    let custom = source.design();
    for traversal in [Traversal::Spans, Traversal::Box] {
        let job = ExactJob {
            footprint: &footprint,
            window,
            rules: &rules,
            compositing,
            traversal,
        };
        let start = |widths: &Widths| if clear { Pixel::clear(widths) } else { pixel };
        job.run(custom, start(&custom.widths()));
        job.run(Classic8, start(&Classic8::WIDTHS));
        job.run(Lean18, start(&Lean18::WIDTHS));
        job.run(Standard24, start(&Standard24::WIDTHS));
        job.run(Deep32, start(&Deep32::WIDTHS));
    }
}

/// Any splat before a sound camera, through setup and into the pixels; returns the pixels covered.
pub fn splat_to_pixels(source: &mut Source) -> u64 {
    let design = source.design();
    let (view, rules, splat) = (source.sound_view(), source.rules(), source.visible_splat());
    let Ok(footprint) = setup::setup(design, &view, &rules, &splat) else {
        return 0;
    };
    let window = Window {
        first: [0, 0],
        end: view.viewport,
    };
    let compositing = source.compositing();
    let mut covered = 0;
    for traversal in [Traversal::Spans, Traversal::Box] {
        let job = ExactJob {
            footprint: &footprint,
            window,
            rules: &rules,
            compositing,
            traversal,
        };
        covered += job.run(design, Pixel::clear(&design.widths())).covered;
    }
    covered
}

struct ExactJob<'a> {
    footprint: &'a Footprint,
    window: Window,
    rules: &'a Rules,
    compositing: Compositing,
    traversal: Traversal,
}

/// Pixels of foreign memory on both sides of the lent memory, and between its rows.
const GUARD: usize = 64;
const GAP: usize = 3;
const FOREIGN: Pixel = Pixel {
    colour: [0xdead_beef; 3],
    transmittance: 0x7ead_beef,
};

impl ExactJob<'_> {
    /// Draws into lent memory between guards; checks the guards, the gaps between rows and the bound of the work.
    fn run<D: Design>(&self, design: D, start: Pixel) -> Coverage {
        let Window { first, end: last } = self.window;
        let size = [0, 1].map(|axis| usize::from(last[axis].saturating_sub(first[axis])));
        let [columns, rows] = size;
        let stride = columns + GAP;
        let mut memory = vec![FOREIGN; 2 * GUARD + rows * stride];
        let owned = |index: usize| {
            let place = index.wrapping_sub(GUARD);
            index >= GUARD && place < rows * stride && place % stride < columns
        };
        for (index, pixel) in memory.iter_mut().enumerate() {
            if owned(index) {
                *pixel = start;
            }
        }
        let lent = &mut memory[GUARD..GUARD + rows * stride];
        let mut target =
            Target::new(lent, self.window, stride).expect("the memory holds the window");
        let coverage = self.paint(design, &mut target);
        let pixels = (columns * rows) as u64;
        assert!(
            coverage.visited <= pixels,
            "{} pixels visited of {pixels}",
            coverage.visited
        );
        assert!(coverage.covered <= coverage.visited && coverage.finished <= coverage.covered);
        for (index, pixel) in memory.iter().enumerate() {
            assert!(
                owned(index) || *pixel == FOREIGN,
                "pixel {index} lies outside the window"
            );
        }
        coverage
    }

    fn paint<D: Design>(&self, design: D, target: &mut Target) -> Coverage {
        let widths = design.widths();
        let mut memory = vec![0; entries(&widths)];
        fill_gaussian(&mut memory, &widths, self.rules.table_range);
        let table = FootprintTable::new(&memory, &widths, self.rules.table_range)
            .expect("the size is right");
        Painter::new(design, self.rules, table, self.compositing, self.traversal)
            .draw(self.footprint, target)
    }
}

/// Targets of any shape: refused, or no row of theirs reaches beyond the lent memory.
pub fn target(source: &mut Source) {
    let window = source.window();
    let mut memory = vec![Pixel::default(); usize::from(source.u16() % 4096)];
    let stride = if source.bool() {
        usize::from(source.byte())
    } else {
        source.i64() as usize
    };
    let Ok(mut target) = Target::new(&mut memory, window, stride) else {
        return;
    };
    for _ in 0..8 {
        let (x, y, length) = (source.u16(), source.u16(), source.u16());
        let found = target.row(y, x, length).len();
        assert!(found == 0 || found == usize::from(length));
    }
    for y in window.first[1]..window.end[1] {
        let columns = window.end[0].saturating_sub(window.first[0]);
        let x = window.first[0];
        assert_eq!(
            target.row(y, x, columns).len(),
            usize::from(columns),
            "row {y} of {window:?}"
        );
    }
    let _ = target.is_finished();
    target.clear(&source.widths());
}
