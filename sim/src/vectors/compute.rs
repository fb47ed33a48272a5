//! Every stage of the kernel, run one after the other, with what crosses each boundary written down.

use super::{VectorStage, VectorSubject, functions, systems};
use crate::design::DesignJob;
use crate::fixed::{kernel_compositing, kernel_rules};
use crate::rules::Compositing as Order;
use splatline::blend::{Blend, Pixel};
use splatline::draw::cutoff_in_lane;
use splatline::footprint::Footprint;
use splatline::footprint::depth::{self, KEY_BITS};
use splatline::footprint::packet::Layout;
use splatline::format::{Design, Lane, Traversal, Widths};
use splatline::kernel::{FootprintTable, entries, fill_gaussian};
use splatline::math::{SoftFloat, shift_signed};
use splatline::raster::{BoxSpans, EllipseSpans, Spans, Window};
use splatline::rules::{Compositing, Rules};
use splatline::setup::{self, Cull};
use splatline::splat::VolumeSplat;
use splatline::view::Pose;

/// All stages in the order of the data flow. The records of one stage refer to those of another by number.
pub fn compute(subject: &VectorSubject) -> Vec<VectorStage> {
    struct StagesJob<'a>(&'a VectorSubject);
    impl DesignJob for StagesJob<'_> {
        type Output = Vec<VectorStage>;
        fn run<D: Design + Send + Sync>(self, design: D) -> Vec<VectorStage> {
            compute_with(design, self.0)
        }
    }
    subject.design.dispatch(StagesJob(subject))
}

fn compute_with<D: Design>(design: D, subject: &VectorSubject) -> Vec<VectorStage> {
    let widths = design.widths();
    let rules = kernel_rules(&subject.rules);
    if subject.systems {
        let mut splats = SetupStages::new(&widths).splats;
        splats.records = subject.splats.iter().map(splat_values).collect();
        let systems = systems::stages(design, subject);
        return [splats].into_iter().chain(systems).collect();
    }
    let mut setup = SetupStages::new(&widths);
    let mut visible = Vec::new();
    for (index, splat) in subject.splats.iter().enumerate() {
        if let Ok(footprint) = setup.record(design, subject, &rules, index, splat) {
            visible.push((index, footprint));
        }
    }
    visible.sort_by_key(|(_, footprint)| footprint.depth);
    if subject.compositing == Order::BackToFront {
        visible.reverse();
    }
    let packets = packet_stage(&widths, subject.design.traversal, &visible);
    let table = table_stage(&widths, rules.table_range);
    let mut raster = RasterStages::new(design, subject, &rules);
    for (number, (_, footprint)) in visible.iter().enumerate() {
        match subject.design.traversal {
            Traversal::Spans => {
                raster.record(number, footprint, |d, w| EllipseSpans::new(d, footprint, w))
            }
            Traversal::Box => {
                raster.record(number, footprint, |d, w| BoxSpans::new(d, footprint, w))
            }
        }
    }
    let tile = raster.tile();
    let SetupStages {
        splats,
        camera,
        projected,
        columns,
        covariance,
        opacity,
    } = setup;
    let [reciprocals, roots, logarithms] = functions::tables();
    vec![
        splats,
        reciprocals,
        roots,
        logarithms,
        functions::cases(),
        camera,
        projected,
        columns,
        covariance,
        opacity,
        packets,
        table,
        raster.runs,
        raster.pixels,
        tile,
    ]
}

pub(super) type StageSpec = (String, usize, bool, usize);

pub(super) fn field(name: &str, bits: usize, signed: bool, fraction: u8) -> StageSpec {
    (name.to_owned(), bits, signed, fraction.into())
}

/// Mantissa and exponent.
fn number(name: &str) -> [StageSpec; 2] {
    ["mantissa", "exponent"].map(|part| field(&format!("{name}_{part}"), 32, true, 0))
}

pub(super) fn numbers<'a>(
    names: impl IntoIterator<Item = &'a str>,
) -> impl Iterator<Item = StageSpec> {
    names.into_iter().flat_map(number)
}

pub(super) fn values(numbers: impl IntoIterator<Item = SoftFloat>) -> impl Iterator<Item = i64> {
    numbers
        .into_iter()
        .flat_map(|n| [n.mantissa.into(), n.exponent.into()])
}

/// One record per splat each.
struct SetupStages {
    splats: VectorStage,
    camera: VectorStage,
    projected: VectorStage,
    columns: VectorStage,
    covariance: VectorStage,
    opacity: VectorStage,
}

/// The `culled` field: 0, or the place of the reason in [`Cull::ALL`] counted from 1.
pub(super) fn reason<T>(result: &Result<T, Cull>) -> i64 {
    result
        .as_ref()
        .err()
        .map_or(0, |cull| cull.place() as i64 + 1)
}

impl SetupStages {
    fn new(widths: &Widths) -> Self {
        let subpixel = widths.subpixel;
        let centre = 28 + usize::from(subpixel);
        SetupStages {
            splats: VectorStage::new(
                "splats",
                "one input splat a record",
                numbers(["x", "y", "z"])
                    .chain(["a", "b", "c"].into_iter().flat_map(|axis| {
                        let part = |n: &str| field(&format!("axis_{axis}_{n}"), 32, true, 0);
                        ["x", "y", "z", "exponent"].map(part)
                    }))
                    .chain(number("weight"))
                    .chain(["red", "green", "blue"].map(|n| field(n, 32, false, 28))),
            ),
            camera: VectorStage::new(
                "camera",
                "t = W (u - e), one splat a record: three words with one exponent",
                ["x", "y", "z"]
                    .map(|n| field(n, 64, true, 0))
                    .into_iter()
                    .chain([field("exponent", 32, true, 0)]),
            ),
            projected: VectorStage::new(
                "projected",
                "one splat a record; culled: 0 drawn, 1 near, 2 far, 3 range, 4 degenerate, 5 transparent, 6 outside; zeros from 1 to 3",
                [
                    field("culled", 4, false, 0),
                    field("depth", KEY_BITS as usize, false, 0),
                    field("centre_u", centre, true, subpixel),
                    field("centre_v", centre, true, subpixel),
                ]
                .into_iter()
                .chain(numbers(["ratio_x", "ratio_y", "gain_x", "gain_y"])),
            ),
            columns: VectorStage::new(
                "columns",
                "M = J W A, one splat a record; zeros if it was culled before",
                numbers(["a_x", "a_y", "b_x", "b_y", "c_x", "c_y"]),
            ),
            covariance: VectorStage::new(
                "covariance",
                "V' + V^h and its determinant, one splat a record; zeros if it was culled before",
                numbers(["xx", "xy", "yy", "determinant"]),
            ),
            opacity: VectorStage::new(
                "opacity",
                "opacity at the centre before it is rounded to the packet's, one splat a record; zeros if it was culled before",
                number("peak"),
            ),
        }
    }

    fn record<D: Design>(
        &mut self,
        design: D,
        subject: &VectorSubject,
        rules: &Rules,
        index: usize,
        splat: &VolumeSplat,
    ) -> Result<Footprint, Cull> {
        let (widths, view) = (design.widths(), &subject.view);
        self.splats.records.push(splat_values(splat));
        let camera = view.pose.to_camera(&view.rotation, &splat.centre, &widths);
        let [x, y, z] = camera.value;
        let camera = vec![x, y, z, camera.exponent.into()];
        self.camera.records.push(camera);
        let result = setup::setup(design, view, rules, splat);
        let mut projected = vec![reason(&result)];
        if let Ok(found) = setup::project(&widths, view, rules, &splat.centre) {
            let depth = depth::key(found.depth) as i64;
            projected.extend([depth, found.centre[0], found.centre[1]]);
            projected.extend(values(found.ratio.into_iter().chain(found.gain)));
            let columns = setup::project_axes(&widths, &view.rotation, &found, &splat.axes);
            let covariance = setup::covariance(&widths, rules.low_pass, &columns);
            let weight = if rules.compensated {
                setup::compensate(&widths, splat.weight, &columns, &covariance)
            } else {
                splat.weight
            };
            let peak = setup::centre_opacity(&widths, rules, weight, &found, &covariance);
            self.opacity.records.push(values([peak]).collect());
            self.columns
                .records
                .push(values(columns.iter().flat_map(|c| [c.x, c.y])).collect());
            let setup::Covariance2d {
                xx,
                xy,
                yy,
                determinant,
            } = covariance;
            let terms = [xx, xy, yy, determinant];
            self.covariance.records.push(values(terms).collect());
        }
        self.projected.records.push(projected);
        for stage in [
            &mut self.projected,
            &mut self.columns,
            &mut self.covariance,
            &mut self.opacity,
        ] {
            stage.records.resize(index + 1, Vec::new());
            if let Some(last) = stage.records.last_mut() {
                last.resize(stage.fields.len(), 0);
            }
        }
        result
    }
}

fn splat_values(splat: &VolumeSplat) -> Vec<i64> {
    let mut record: Vec<i64> = values(splat.centre).collect();
    for axis in &splat.axes {
        record.extend(axis.mantissa.map(i64::from));
        record.push(axis.exponent.into());
    }
    record.extend(values([splat.weight]));
    record.extend(splat.colour.map(|c| i64::from(c.to_bits())));
    record
}

fn packet_stage(
    widths: &Widths,
    traversal: Traversal,
    visible: &[(usize, Footprint)],
) -> VectorStage {
    let layout = Layout::new(widths, traversal);
    let fields = layout
        .fields()
        .iter()
        .filter(|field| field.width > 0)
        .map(|f| field(f.name, f.width.into(), f.signed, f.fraction));
    // Behind the packet proper, so that its bits keep their places.
    let behind = [
        field("depth", KEY_BITS as usize, false, 0),
        field("splat", 32, false, 0),
    ];
    let fields = fields.chain(behind);
    let mut stage = VectorStage::new(
        "packets",
        "footprint packets in the order of drawing, then depth (the sort key) and the splat's number",
        fields,
    );
    for (index, footprint) in visible {
        let packet = layout.encode(footprint);
        let bit = |at: usize| i64::from(packet[at / 32] >> (at % 32) & 1);
        let own = stage.fields.len() - 2;
        let mut record: Vec<i64> = stage.fields[..own]
            .iter()
            .map(|field| {
                let value = (0..field.bits).fold(0i64, |v, at| v | bit(field.offset + at) << at);
                let spare = 64 - field.bits as u32;
                if field.signed {
                    value << spare >> spare
                } else {
                    value
                }
            })
            .collect();
        record.extend([footprint.depth as i64, *index as i64]);
        stage.records.push(record);
    }
    stage
}

fn table_stage(widths: &Widths, range: u8) -> VectorStage {
    let bits = usize::from(widths.weight) + 1;
    let mut stage = VectorStage::new(
        "table",
        "entries of the footprint table",
        [field("entry", bits, false, widths.weight)],
    );
    let mut memory = vec![0; entries(widths)];
    fill_gaussian(&mut memory, widths, range);
    stage.records = memory.iter().map(|entry| vec![(*entry).into()]).collect();
    stage
}

/// Runs, pixels and the picture.
struct RasterStages<D> {
    design: D,
    blend: Blend,
    compositing: Compositing,
    table: Vec<u32>,
    range: u8,
    window: Window,
    picture: Vec<Pixel>,
    runs: VectorStage,
    pixels: VectorStage,
}

impl<D: Design> RasterStages<D> {
    fn new(design: D, subject: &VectorSubject, rules: &Rules) -> Self {
        let widths = design.widths();
        let mut table = vec![0; entries(&widths)];
        fill_gaussian(&mut table, &widths, rules.table_range);
        let window = Window {
            first: [0; 2],
            end: subject.view.viewport,
        };
        let count = window.end.iter().map(|side| usize::from(*side)).product();
        let (lane, fraction) = match subject.design.traversal {
            Traversal::Spans => (8 * size_of::<D::Lane>(), widths.radial),
            Traversal::Box => (64, 36),
        };
        let place = ["packet", "row", "column"]
            .map(|n| field(n, if n == "packet" { 32 } else { 16 }, false, 0));
        RasterStages {
            design,
            blend: Blend::new(&widths, rules),
            compositing: kernel_compositing(subject.compositing),
            table,
            range: rules.table_range,
            window,
            picture: vec![Pixel::clear(&widths); count],
            runs: VectorStage::new(
                "runs",
                "runs of adjacent pixels: radial index at the first, its difference, the difference's difference",
                place
                    .clone()
                    .into_iter()
                    .chain([field("length", 16, false, 0)])
                    .chain(["radial", "first", "second"].map(|n| field(n, lane, true, fraction))),
            ),
            pixels: VectorStage::new(
                "pixels",
                "pixels inside a footprint: radial index, opacity (0: skipped), and the pixel's word afterwards",
                place.into_iter().chain([
                    field(
                        "radial",
                        usize::from(widths.radial) + 4,
                        false,
                        widths.radial,
                    ),
                    field(
                        "opacity",
                        usize::from(widths.alpha) + 1,
                        false,
                        widths.alpha,
                    ),
                    field("red", 32, false, widths.accumulator),
                    field("green", 32, false, widths.accumulator),
                    field("blue", 32, false, widths.accumulator),
                    field("transmittance", 31, false, widths.transmittance),
                    field("finished", 1, false, 0),
                ]),
            ),
        }
    }

    fn record<R: Spans>(
        &mut self,
        number: usize,
        footprint: &Footprint,
        start: impl Fn(D, &Window) -> R,
    ) {
        let mut rows = start(self.design, &self.window);
        let widths = self.design.widths();
        let drop = rows.fraction() as i32 - i32::from(widths.radial);
        let end = cutoff_in_lane(footprint.cutoff, widths.radial);
        while let Some(run) = rows.next_span() {
            let place = [number as i64, run.y.into(), run.x.into()];
            let lanes = [run.radial, run.first, run.second].map(Lane::to_wide);
            let record = place.into_iter().chain([run.length.into()]).chain(lanes);
            self.runs.records.push(record.collect());
            for (column, lane) in (run.x..).zip(run.radials()) {
                let radial = shift_signed(lane.to_wide(), drop).max(0) as u64;
                if radial < end {
                    self.pixel(number, footprint, [column, run.y], radial);
                }
            }
        }
    }

    fn pixel(&mut self, number: usize, footprint: &Footprint, [x, y]: [u16; 2], radial: u64) {
        let widths = self.design.widths();
        let at = usize::from(y) * usize::from(self.window.end[0]) + usize::from(x);
        let table = FootprintTable::new(&self.table, &widths, self.range);
        let (Ok(table), Some(pixel)) = (table, self.picture.get_mut(at)) else {
            return;
        };
        let alpha = self.blend.opacity(footprint.opacity, table.weight(radial));
        if alpha > 0 && !pixel.is_finished() {
            match self.compositing {
                Compositing::FrontToBack => {
                    self.blend.front_to_back(pixel, alpha, &footprint.colour)
                }
                Compositing::BackToFront => {
                    self.blend.back_to_front(pixel, alpha, &footprint.colour)
                }
                Compositing::XRay => self.blend.x_ray(pixel, alpha, &footprint.colour),
            }
        }
        let mut record = vec![
            number as i64,
            y.into(),
            x.into(),
            radial as i64,
            alpha.into(),
        ];
        record.extend(pixel_values(pixel));
        self.pixels.records.push(record);
    }

    fn tile(&self) -> VectorStage {
        let widths = self.design.widths();
        let mut stage = VectorStage::new(
            "tile",
            "the finished picture, row by row",
            ["red", "green", "blue"]
                .map(|n| field(n, 32, false, widths.accumulator))
                .into_iter()
                .chain([
                    field("transmittance", 31, false, widths.transmittance),
                    field("finished", 1, false, 0),
                ]),
        );
        stage.records = self
            .picture
            .iter()
            .map(|p| pixel_values(p).to_vec())
            .collect();
        stage
    }
}

pub(super) fn pixel_values(pixel: &Pixel) -> [i64; 5] {
    let [r, g, b] = pixel.colour.map(i64::from);
    [
        r,
        g,
        b,
        pixel.transmittance().into(),
        pixel.is_finished().into(),
    ]
}
