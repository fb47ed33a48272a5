//! Every stage of the kernel, run one after the other, with what crosses each boundary written down.

use super::record::{Words, reason, record};
use super::{VectorStage, VectorSubject, functions, systems};
use crate::fixed::{TableMemory, kernel_compositing, kernel_rules};
use crate::rules::Compositing as Order;
use splatline::blend::{Blend, Pixel};
use splatline::draw::cutoff_in_lane;
use splatline::footprint::Footprint;
use splatline::footprint::depth::{self, KEY_BITS};
use splatline::footprint::packet::Layout;
use splatline::format::{Design, Lane, Traversal, Widths};
use splatline::math::shift_signed;
use splatline::raster::{BoxSpans, EllipseSpans, Spans, Window};
use splatline::rules::{Compositing, Rules};
use splatline::setup::{self, Cull};
use splatline::splat::VolumeSplat;
use splatline::view::Pose;

/// All stages in the order of the data flow. The records of one stage refer to those of another by number.
pub fn compute(subject: &VectorSubject) -> Vec<VectorStage> {
    match subject.design.in_short_lanes() {
        Some(design) => compute_with(design, subject),
        None => compute_with(subject.design.in_fields(), subject),
    }
}

fn compute_with<D: Design>(design: D, subject: &VectorSubject) -> Vec<VectorStage> {
    let widths = design.widths();
    let rules = kernel_rules(&subject.rules);
    if subject.systems {
        let mut splats = splats_stage();
        splats.fill(&subject.splats);
        let systems = systems::stages(design, subject);
        return [splats].into_iter().chain(systems).collect();
    }
    let mut setup = setup_stages(&widths);
    let mut visible = Vec::new();
    for (index, splat) in subject.splats.iter().enumerate() {
        let (records, footprint) = setup_records(design, subject, &rules, splat);
        for (stage, mut record) in setup.iter_mut().zip(records) {
            // What comes after a splat was culled is zeros.
            record.resize(stage.fields.len(), 0);
            stage.add(record);
        }
        visible.extend(footprint.ok().map(|footprint| (index, footprint)));
    }
    visible.sort_by_key(|(_, footprint)| footprint.depth);
    if subject.compositing == Order::BackToFront {
        visible.reverse();
    }
    let packets = packet_stage(&widths, subject.design.traversal, &visible);
    let mut raster = RasterStages::new(design, subject, rules);
    for (number, (_, footprint)) in visible.iter().enumerate() {
        match subject.design.traversal {
            Traversal::Spans => {
                let rows = EllipseSpans::new(design, footprint, &raster.window);
                raster.record(number, footprint, rows);
            }
            Traversal::Box => {
                let rows = BoxSpans::new(design, footprint, &raster.window);
                raster.record(number, footprint, rows);
            }
        }
    }
    let [splats, setup @ ..] = setup;
    let mut stages = vec![splats];
    stages.extend(functions::stages());
    stages.extend(setup);
    stages.push(packets);
    stages.extend(raster.finish());
    stages
}

/// The inputs, whose fields are the same for every subject.
pub(super) fn splats_stage() -> VectorStage {
    VectorStage::new(
        "splats",
        "one input splat a record",
        "x:n y:n z:n axis_a_x:-32 axis_a_y:-32 axis_a_z:-32 axis_a_exponent:-32 axis_b_x:-32 axis_b_y:-32 axis_b_z:-32 axis_b_exponent:-32 \
         axis_c_x:-32 axis_c_y:-32 axis_c_z:-32 axis_c_exponent:-32 weight:n red:32.28 green:32.28 blue:32.28",
    )
}

/// The stages of setup, with a record for each splat: the splat itself, camera, projection, columns, covariance,
/// opacity.
fn setup_stages(widths: &Widths) -> [VectorStage; 6] {
    let subpixel = widths.subpixel;
    let centre = 28 + subpixel;
    [
        splats_stage(),
        VectorStage::new(
            "camera",
            "t = W (u - e), one splat a record: three words with one exponent",
            "x:-64 y:-64 z:-64 exponent:-32",
        ),
        VectorStage::new(
            "projected",
            "one splat a record; culled: 0 drawn, 1 near, 2 far, 3 range, 4 degenerate, 5 transparent, 6 outside; zeros from 1 to 3",
            &format!(
                "culled:4 depth:{KEY_BITS} centre_u:-{centre}.{subpixel} centre_v:-{centre}.{subpixel} ratio_x:n ratio_y:n gain_x:n gain_y:n"
            ),
        ),
        VectorStage::new(
            "columns",
            "M = J W A, one splat a record; zeros if it was culled before",
            "a_x:n a_y:n b_x:n b_y:n c_x:n c_y:n",
        ),
        VectorStage::new(
            "covariance",
            "V' + V^h and its determinant, one splat a record; zeros if it was culled before",
            "xx:n xy:n yy:n determinant:n",
        ),
        VectorStage::new(
            "opacity",
            "opacity at the centre before it is rounded to the packet's, one splat a record; zeros if it was culled before",
            "peak:n",
        ),
    ]
}

/// A splat's records in the order of [`setup_stages`], and its footprint.
fn setup_records<D: Design>(
    design: D,
    subject: &VectorSubject,
    rules: &Rules,
    splat: &VolumeSplat,
) -> ([Vec<i64>; 6], Result<Footprint, Cull>) {
    let (widths, view) = (design.widths(), &subject.view);
    let camera = view.pose.to_camera(&view.rotation, &splat.centre, &widths);
    let result = setup::setup(design, view, rules, splat);
    let mut projected = record![reason(&result)];
    let [mut columns, mut covariance, mut opacity] = [const { Vec::new() }; 3];
    if let Ok(found) = setup::project(&widths, view, rules, &splat.centre) {
        projected.extend(record![depth::key(found.depth); found.centre; found.ratio; found.gain]);
        let axes = setup::project_axes(&widths, &view.rotation, &found, &splat.axes);
        let of_axes = setup::covariance(&widths, rules.low_pass, &axes);
        let weight = if rules.compensated {
            setup::compensate(&widths, splat.weight, &axes, &of_axes)
        } else {
            splat.weight
        };
        opacity = record![setup::centre_opacity(
            &widths, rules, weight, &found, &of_axes
        )];
        columns = record![axes.map(|column| [column.x, column.y]).as_flattened()];
        covariance = record![of_axes.xx; of_axes.xy; of_axes.yy; of_axes.determinant];
    }
    let (splat, camera) = (record![splat], record![camera.value; camera.exponent]);
    let records = [splat, camera, projected, columns, covariance, opacity];
    (records, result)
}

fn packet_stage(
    widths: &Widths,
    traversal: Traversal,
    visible: &[(usize, Footprint)],
) -> VectorStage {
    let layout = Layout::new(widths, traversal);
    let mut fields = String::new();
    for field in layout.fields().iter().filter(|field| field.width > 0) {
        let sign = if field.signed { "-" } else { "" };
        fields += &format!("{}:{sign}{}.{} ", field.name, field.width, field.fraction);
    }
    // Behind the packet proper, so that its bits keep their places.
    fields += &format!("depth:{KEY_BITS} splat");
    let mut stage = VectorStage::new(
        "packets",
        "footprint packets in the order of drawing, then depth (the sort key) and the splat's number",
        &fields,
    );
    for (index, footprint) in visible {
        let packet = layout.encode(footprint);
        let join = |word, part: &u32| word << 32 | u64::from(*part);
        let words: Vec<u64> = packet
            .chunks(2)
            .map(|pair| pair.iter().rev().fold(0, join))
            .collect();
        let own = &stage.fields[..stage.fields.len() - 2];
        let mut record: Vec<i64> = own.iter().map(|field| field.value(&words)).collect();
        record.extend([footprint.depth as i64, *index as i64]);
        stage.add(record);
    }
    stage
}

/// The fields of a pixel's word.
fn pixel_fields(widths: &Widths) -> String {
    let (a, t) = (widths.accumulator, widths.transmittance);
    format!("red:32.{a} green:32.{a} blue:32.{a} transmittance:31.{t} finished:1")
}

/// The footprint table, runs, pixels and the picture.
struct RasterStages<D> {
    design: D,
    compositing: Compositing,
    table: TableMemory,
    window: Window,
    picture: Vec<Pixel>,
    runs: VectorStage,
    pixels: VectorStage,
}

impl<D: Design> RasterStages<D> {
    fn new(design: D, subject: &VectorSubject, rules: Rules) -> Self {
        let widths = design.widths();
        let window = Window {
            first: [0; 2],
            end: subject.view.viewport,
        };
        let (lane, fraction) = match subject.design.traversal {
            Traversal::Spans => (8 * size_of::<D::Lane>(), widths.radial),
            Traversal::Box => (64, 36),
        };
        RasterStages {
            design,
            compositing: kernel_compositing(subject.compositing),
            table: TableMemory::new(&widths, &rules),
            window,
            picture: vec![Pixel::clear(&widths); window.pixels()],
            runs: VectorStage::new(
                "runs",
                "runs of adjacent pixels: radial index at the first, its difference, the difference's difference",
                &format!(
                    "packet row:16 column:16 length:16 radial:-{lane}.{fraction} first:-{lane}.{fraction} second:-{lane}.{fraction}"
                ),
            ),
            pixels: VectorStage::new(
                "pixels",
                "pixels inside a footprint: radial index, opacity (0: skipped), and the pixel's word afterwards",
                &format!(
                    "packet row:16 column:16 radial:{}.{} opacity:{}.{} {}",
                    widths.radial + 4,
                    widths.radial,
                    widths.alpha + 1,
                    widths.alpha,
                    pixel_fields(&widths)
                ),
            ),
        }
    }

    /// A footprint's rows, with the pixels that it covers composited one by one.
    fn record(&mut self, number: usize, footprint: &Footprint, mut rows: impl Spans) {
        let widths = self.design.widths();
        let (table, blend) = (self.table.table(), Blend::new(&widths, &self.table.rules));
        let drop = rows.fraction() as i32 - i32::from(widths.radial);
        let end = cutoff_in_lane(footprint.cutoff, widths.radial);
        let (columns, colour) = (usize::from(self.window.end[0]), &footprint.colour);
        while let Some(run) = rows.next_span() {
            let lanes = [run.radial, run.first, run.second].map(Lane::to_wide);
            let record = record![number as i64; run.y; run.x; run.length; lanes];
            self.runs.add(record);
            for (column, lane) in (run.x..).zip(run.radials()) {
                let radial = shift_signed(lane.to_wide(), drop).max(0) as u64;
                if radial >= end {
                    continue;
                }
                let pixel = &mut self.picture[usize::from(run.y) * columns + usize::from(column)];
                let alpha = blend.opacity(footprint.opacity, table.weight(radial));
                if alpha > 0 && !pixel.is_finished() {
                    match self.compositing {
                        Compositing::FrontToBack => blend.front_to_back(pixel, alpha, colour),
                        Compositing::BackToFront => blend.back_to_front(pixel, alpha, colour),
                        Compositing::XRay => blend.x_ray(pixel, alpha, colour),
                    }
                }
                let record = record![number as i64; run.y; column; radial; alpha; *pixel];
                self.pixels.add(record);
            }
        }
    }

    fn finish(self) -> [VectorStage; 4] {
        let widths = self.design.widths();
        let entry = format!("entry:{}.{}", widths.weight + 1, widths.weight);
        let about = "entries of the footprint table";
        let table = VectorStage::of("table", about, &entry, &self.table.entries);
        let about = "the finished picture, row by row";
        let tile = VectorStage::of("tile", about, &pixel_fields(&widths), &self.picture);
        [table, self.runs, self.pixels, tile]
    }
}
