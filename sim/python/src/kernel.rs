//! The kernel stage by stage, in its own integers: what a bench holds a circuit against.

use crate::convert::{raise, record, rows};
use crate::plan::Plan;
use anyhow::{Context, Result, ensure};
use numpy::{
    PyArray1, PyArray2, PyArray3, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2,
    PyUntypedArrayMethods,
};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use splatline::blend::{Blend, Pixel};
use splatline::draw::cutoff_in_lane;
use splatline::footprint::Footprint;
use splatline::footprint::packet::{Field, Layout, Packet, WORDS};
use splatline::format::{Design as _, Lane, RuntimeWidths, Traversal, Widths};
use splatline::math::shift_signed;
use splatline::raster::{BoxSpans, EllipseSpans, Span, Spans, Window};
use splatline::rules::Compositing;
use splatline::setup::setup;
use splatline::target::Target;
use splatline_sim::fixed::{QuantisedScene, TableMemory, kernel_compositing};
use splatline_sim::plan::draw::cull_name;
use splatline_sim::vectors::{self, VectorSubject};

/// The stages of a plan of composited splats. All values are the kernel's integers; `layout` and `formats` say what
/// they are.
#[pyclass(frozen, skip_from_py_object, module = "splatline._native")]
pub struct Kernel {
    design: RuntimeWidths,
    traversal: Traversal,
    colour_log2: i32,
    table: TableMemory,
    /// View, splats and order, as vectors take them.
    subject: VectorSubject,
}

/// A pixel as Python has it: red, green, blue, transmittance.
fn words_of(pixel: &Pixel) -> [u32; 4] {
    let [red, green, blue] = pixel.colour;
    [red, green, blue, pixel.transmittance]
}

impl Kernel {
    fn widths(&self) -> Widths {
        self.design.widths()
    }

    fn packet_layout(&self) -> Layout {
        Layout::new(&self.widths(), self.traversal)
    }

    fn window(&self, given: Option<[u16; 4]>) -> Window {
        let [columns, rows] = self.subject.view.viewport;
        let [x0, y0, x1, y1] = given.unwrap_or([0, 0, columns, rows]);
        Window {
            first: [x0, y0],
            end: [x1.min(columns), y1.min(rows)],
        }
    }

    fn packet(&self, words: &[u32]) -> Result<Footprint> {
        let layout = self.packet_layout();
        ensure!(
            words.len() == layout.words(),
            "a packet has {} words of 32 bits: this design's have {}",
            words.len(),
            layout.words()
        );
        let mut packet: Packet = [0; WORDS];
        packet[..words.len()].copy_from_slice(words);
        let found = layout.decode(&packet);
        found.map_err(|wrong| {
            let version = wrong.found;
            anyhow::anyhow!("a packet of version {version}: this kernel reads others")
        })
    }

    /// Spans of a footprint in a window, and the fraction bits of their radial indices.
    fn spans(&self, footprint: &Footprint, window: &Window) -> (Vec<Span<i64>>, u32) {
        fn all<R: Spans>(mut rows: R) -> (Vec<Span<i64>>, u32) {
            let fraction = rows.fraction();
            let mut found = Vec::new();
            while let Some(span) = rows.next_span() {
                found.push(Span {
                    y: span.y,
                    x: span.x,
                    length: span.length,
                    radial: span.radial.to_wide(),
                    first: span.first.to_wide(),
                    second: span.second.to_wide(),
                });
            }
            (found, fraction)
        }
        match self.traversal {
            Traversal::Spans => all(EllipseSpans::new(self.design, footprint, window)),
            Traversal::Box => all(BoxSpans::new(self.design, footprint, window)),
        }
    }
}

#[pymethods]
impl Kernel {
    #[new]
    fn new(py: Python<'_>, plan: &Plan) -> PyResult<Kernel> {
        let prepared = &plan.prepared;
        let made = py.detach(|| -> Result<Kernel> {
            let splats = prepared.splats()?;
            let entry = &prepared.plan.entry;
            let scene = QuantisedScene::new(splats.scene, splats.camera, splats.rules);
            let widths = entry.design.widths;
            let design = RuntimeWidths::new(widths)
                .ok()
                .context("a design's widths are in range")?;
            Ok(Kernel {
                design,
                traversal: entry.traversal,
                table: TableMemory::new(&widths, &scene.rules),
                colour_log2: scene.colour_log2,
                subject: VectorSubject {
                    design: entry.design.clone(),
                    rules: *splats.rules,
                    compositing: splats.compositing,
                    view: scene.view,
                    splats: scene.splats,
                    systems: false,
                },
            })
        });
        raise(made)
    }

    /// Fields of a packet of the plan's traversal: name, first bit, bits, signed, fraction bits.
    fn layout(&self) -> Vec<(&'static str, u16, u8, bool, u8)> {
        let layout = self.packet_layout();
        let field = |f: &Field| (f.name, f.offset, f.width, f.signed, f.fraction);
        let fields = layout.fields().iter().filter(|f| f.width > 0);
        fields.map(field).collect()
    }

    /// 32-bit words of a packet.
    #[getter]
    fn packet_words(&self) -> usize {
        self.packet_layout().words()
    }

    /// Unit of the colours as a power of two.
    #[getter]
    fn colour_log2(&self) -> i32 {
        self.colour_log2
    }

    /// What a circuit is told of the rules of blending, at the design's widths.
    fn rules<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let constants = Blend::new(&self.widths(), &self.table.rules).constants();
        let rules = PyDict::new(py);
        rules.set_item("alpha_max", constants.alpha_max)?;
        rules.set_item("least", constants.opacity_min)?;
        rules.set_item("minimum_transmittance", constants.minimum_transmittance)?;
        rules.set_item("omit_finishing", constants.omit_finishing)?;
        rules.set_item("wide_table", self.table.rules.table_range == 4)?;
        Ok(rules)
    }

    /// Setup of these splats (all of them): packets, uint32 of shape (n, words), the keys that they are sorted by,
    /// int64, and why a splat has none, `None` where it has one.
    #[pyo3(signature = (indices=None))]
    fn setup<'py>(
        &self,
        py: Python<'py>,
        indices: Option<Vec<usize>>,
    ) -> PyResult<(
        Bound<'py, PyArray2<u32>>,
        Bound<'py, PyArray1<i64>>,
        Vec<Option<&'static str>>,
    )> {
        let layout = self.packet_layout();
        let (view, splats) = (&self.subject.view, &self.subject.splats);
        let all = || (0..splats.len()).collect();
        let indices = indices.unwrap_or_else(all);
        let mut reasons = Vec::with_capacity(indices.len());
        let mut words = Vec::with_capacity(indices.len() * layout.words());
        let mut keys = Vec::with_capacity(indices.len());
        for index in &indices {
            let missing = || format!("splat {index}: there are {}", splats.len());
            let splat = splats.get(*index).with_context(missing);
            let (mut packet, mut key) = ([0; WORDS], 0);
            reasons.push(
                match setup(self.design, view, &self.table.rules, raise(splat)?) {
                    Ok(footprint) => {
                        packet = layout.encode(&footprint);
                        key = footprint.depth as i64;
                        None
                    }
                    Err(reason) => Some(cull_name(reason)),
                },
            );
            keys.push(key);
            words.extend(&packet[..layout.words()]);
        }
        let array = PyArray1::from_vec(py, words).reshape([indices.len(), layout.words()])?;
        Ok((array, PyArray1::from_vec(py, keys), reasons))
    }

    /// Spans of a packet in a window (x0, y0, x1, y1), int64 of shape (n, 6): row, column, pixels, radial index, first
    /// and second difference; and the fraction bits of the last three.
    #[pyo3(signature = (packet, window=None))]
    fn spans_of<'py>(
        &self,
        py: Python<'py>,
        packet: PyReadonlyArray1<'py, u32>,
        window: Option<[u16; 4]>,
    ) -> PyResult<(Bound<'py, PyArray2<i64>>, u32)> {
        let footprint = raise(self.packet(&packet.to_vec()?))?;
        let (spans, fraction) = self.spans(&footprint, &self.window(window));
        let row = |s: &Span<i64>| -> [i64; 6] {
            let [y, x, length] = [s.y, s.x, s.length].map(i64::from);
            [y, x, length, s.radial, s.first, s.second]
        };
        Ok((rows(py, spans.iter().map(row).collect())?, fraction))
    }

    /// Pixels of a packet in a window that lie inside its footprint, int64 of shape (n, 3): row, column, radial index
    /// UQ4.radial.
    #[pyo3(signature = (packet, window=None))]
    fn radial_indices<'py>(
        &self,
        py: Python<'py>,
        packet: PyReadonlyArray1<'py, u32>,
        window: Option<[u16; 4]>,
    ) -> PyResult<Bound<'py, PyArray2<i64>>> {
        let footprint = raise(self.packet(&packet.to_vec()?))?;
        let (spans, fraction) = self.spans(&footprint, &self.window(window));
        let bits = self.widths().radial;
        let drop = fraction as i32 - i32::from(bits);
        let end = cutoff_in_lane(footprint.cutoff, bits);
        let mut found: Vec<[i64; 3]> = Vec::new();
        for span in &spans {
            for (column, lane) in (span.x..).zip(span.radials()) {
                let radial = shift_signed(lane, drop).max(0) as u64;
                if radial < end {
                    found.push([span.y.into(), column.into(), radial as i64]);
                }
            }
        }
        rows(py, found)
    }

    /// Entries of the footprint table, UQ1.weight, uint32.
    #[getter]
    fn table<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<u32>> {
        PyArray1::from_slice(py, &self.table.entries)
    }

    /// The kernel at these radial indices (UQ4.radial, int64), UQ1.weight.
    fn weights<'py>(
        &self,
        py: Python<'py>,
        radial: PyReadonlyArray1<'py, i64>,
    ) -> Bound<'py, PyArray1<u32>> {
        let table = self.table.table();
        let weight = |radial: &i64| table.weight((*radial).max(0) as u64);
        PyArray1::from_vec(py, radial.as_array().iter().map(weight).collect())
    }

    /// Opacities UQ1.alpha of a peak UQ4.peak at these weights UQ1.weight; 0 where the rules skip them.
    fn opacities<'py>(
        &self,
        py: Python<'py>,
        peak: u32,
        weights: PyReadonlyArray1<'py, u32>,
    ) -> Bound<'py, PyArray1<u32>> {
        let blend = Blend::new(&self.widths(), &self.table.rules);
        let opacity = |weight: &u32| blend.opacity(peak, *weight);
        PyArray1::from_vec(py, weights.as_array().iter().map(opacity).collect())
    }

    /// Pixels, uint32 of shape (n, 4): red, green, blue UQ4.accumulator and transmittance as the kernel keeps it, each
    /// with its opacity UQ1.alpha of a colour UQ4.colour composited into it. A new array; transparent pixels are
    /// `clear`.
    fn blend<'py>(
        &self,
        py: Python<'py>,
        pixels: PyReadonlyArray2<'py, u32>,
        opacities: PyReadonlyArray1<'py, u32>,
        colour: [u32; 3],
    ) -> PyResult<Bound<'py, PyArray2<u32>>> {
        let count = opacities.len();
        if pixels.shape() != [count, 4] {
            return raise(Err(anyhow::anyhow!(
                "pixels has the shape {:?}: allowed is [{count}, 4]",
                pixels.shape()
            )));
        }
        let blend = Blend::new(&self.widths(), &self.table.rules);
        let words = pixels.as_array().iter().copied().collect::<Vec<u32>>();
        let mut mixed = words.as_chunks::<4>().0.to_vec();
        for (pixel, alpha) in mixed.iter_mut().zip(opacities.as_array()) {
            let [red, green, blue, transmittance] = *pixel;
            let mut word = Pixel {
                colour: [red, green, blue],
                transmittance,
            };
            if *alpha > 0 && !word.is_finished() {
                match kernel_compositing(self.subject.compositing) {
                    Compositing::FrontToBack => blend.front_to_back(&mut word, *alpha, &colour),
                    Compositing::BackToFront => blend.back_to_front(&mut word, *alpha, &colour),
                    Compositing::XRay => blend.x_ray(&mut word, *alpha, &colour),
                }
            }
            *pixel = words_of(&word);
        }
        rows(py, mixed)
    }

    /// A transparent pixel: red, green, blue, transmittance.
    #[getter]
    fn clear(&self) -> [u32; 4] {
        words_of(&Pixel::clear(&self.widths()))
    }

    /// Packets, uint32 of shape (n, words), drawn in their order into a window; uint32 of shape (rows, columns, 4).
    #[pyo3(signature = (packets, window=None))]
    fn tile<'py>(
        &self,
        py: Python<'py>,
        packets: PyReadonlyArray2<'py, u32>,
        window: Option<[u16; 4]>,
    ) -> PyResult<Bound<'py, PyArray3<u32>>> {
        let widths = self.widths();
        let window = self.window(window);
        let mut pixels = vec![Pixel::clear(&widths); window.pixels()];
        let mut footprints = Vec::new();
        for words in packets.as_array().rows() {
            footprints.push(raise(self.packet(&words.to_vec()))?);
        }
        let drawn = py.detach(|| -> Result<()> {
            let order = kernel_compositing(self.subject.compositing);
            let painter = self.table.painter(self.design, order, self.traversal);
            let mut target = Target::new(&mut pixels, window, window.columns().into())
                .map_err(|wrong| anyhow::anyhow!("{wrong}"))?;
            for footprint in &footprints {
                painter.draw(footprint, &mut target);
            }
            Ok(())
        });
        raise(drawn)?;
        let words: Vec<[u32; 4]> = pixels.iter().map(words_of).collect();
        let [rows, columns] = [window.rows(), window.columns()].map(usize::from);
        PyArray1::from_vec(py, words.into_flattened()).reshape([rows, columns, 4])
    }

    /// All stages of the first `splats` splats as `splatline vectors` writes them, in the order of the data flow: name,
    /// what a record is, fields (name, offset, bits, signed, fraction), and records, int64 of shape (n, fields).
    fn vectors<'py>(
        &self,
        py: Python<'py>,
        splats: usize,
    ) -> PyResult<
        Vec<(
            &'static str,
            &'static str,
            Bound<'py, PyAny>,
            Bound<'py, PyArray2<i64>>,
        )>,
    > {
        let mut subject = self.subject.clone();
        subject.splats.truncate(splats);
        raise(vectors::room_for_splats(subject.splats.len()))?;
        let stages = py.detach(|| vectors::compute(&subject));
        let stage = |stage: vectors::VectorStage| {
            let shape = [stage.records.len(), stage.fields.len()];
            let records = PyArray1::from_vec(py, stage.records.concat()).reshape(shape)?;
            Ok((stage.name, stage.about, record(py, &stage.fields)?, records))
        };
        stages.into_iter().map(stage).collect()
    }
}
