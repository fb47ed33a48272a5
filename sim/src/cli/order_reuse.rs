//! `simulate` along a camera path with `sort_every`: what keeping the order of the picture before saves, and what it
//! does to the picture.
//!
//! Each picture whose order is kept is drawn and simulated twice, in the kept order and sorted anew, so that gain and
//! error are of the same picture.

use super::resolve::NamedFrame;
use crate::explore::evaluator::DesignError;
use crate::machine::simulate_alone;
use crate::machine::summary::Spread;
use crate::machine::workload::{OrderChanges, Workload};
use crate::plan::AnyScene;
use crate::report::table::psnr_of_rms;
use anyhow::Result;
use serde::Serialize;
use std::sync::Arc;

/// A picture in a kept order, beside the same sorted anew.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ReusedOrderFrame {
    /// Which one.
    pub name: String,
    /// Entries that changed, and pairs in the wrong order.
    pub lists: OrderChanges,
    /// Entries of all lists.
    pub entries: u64,
    /// Cycles of the sort: kept, anew.
    pub sort_cycles: [u64; 2],
    /// Cycles of the picture.
    pub cycles: [u64; 2],
    /// Bytes that the sort moves.
    pub sort_bytes: [u64; 2],
    /// Colours against the picture in the exact order.
    pub error: DesignError,
    /// Their PSNR; null for equal pictures.
    pub psnr_db: Option<f64>,
}

/// The picture before, as long as it is of the same scene and screen and the order is young enough.
#[derive(Default)]
pub struct OrderReuse {
    before: Option<Workload>,
    scene: Option<Arc<AnyScene>>,
    size: [usize; 2],
    age: u32,
}

impl OrderReuse {
    /// The work of the next picture, and what keeping its order is worth if it is kept.
    pub fn next(&mut self, frame: &NamedFrame) -> Result<(Workload, Option<ReusedOrderFrame>)> {
        let prepared = &frame.prepared;
        let plan = &prepared.plan;
        let size = [plan.camera.width, plan.camera.height];
        let of_scene = self.scene.as_ref();
        let follows = of_scene.is_some_and(|scene| Arc::ptr_eq(scene, &prepared.scene));
        let before = self.before.take().filter(|_| follows && size == self.size);
        self.age = match &before {
            Some(_) if self.age + 1 < plan.machine.sort_every => self.age + 1,
            _ => 0,
        };
        (self.scene, self.size) = (Some(Arc::clone(&prepared.scene)), size);
        let anew = prepared.in_order(None)?;
        let before = match before {
            Some(before) if self.age > 0 => before,
            _ => return Ok((anew.workload, None)),
        };
        let old = prepared.in_order(Some(&before))?;
        let timings = [&old, &anew].map(|one| simulate_alone(&one.workload, &plan.machine));
        let error = DesignError::of(&old.picture, &anew.picture)?;
        let reused = ReusedOrderFrame {
            name: frame.name.clone(),
            lists: old.workload.order_changes.unwrap_or_default(),
            entries: timings[0].splats.entries,
            sort_cycles: [timings[0].sort, timings[1].sort],
            cycles: [timings[0].total, timings[1].total],
            sort_bytes: [timings[0].bytes.sort_moved, timings[1].bytes.sort_moved],
            error,
            psnr_db: Some(error.psnr_db()).filter(|psnr| psnr.is_finite()),
        };
        Ok((old.workload, Some(reused)))
    }

    /// What the next picture may keep the order of.
    pub fn keep(&mut self, workload: Workload) {
        self.before = Some(workload);
    }
}

/// Gain and errors over all pictures whose order was kept; nothing of none.
pub fn text(reused: &[&ReusedOrderFrame], frames: usize) -> String {
    let Some(worst) = reused
        .iter()
        .max_by(|a, b| a.error.max_abs.total_cmp(&b.error.max_abs))
    else {
        return String::new();
    };
    let mean = |of: &dyn Fn(&ReusedOrderFrame) -> u64| {
        reused.iter().map(|frame| of(frame) as f64).sum::<f64>() / reused.len() as f64
    };
    let pair = |name: &str, of: fn(&ReusedOrderFrame) -> [u64; 2], unit: f64| {
        let [old, anew] = [0, 1].map(|which| mean(&|frame: &ReusedOrderFrame| of(frame)[which]));
        let (gain, old, anew) = (100.0 * (old / anew.max(1.0) - 1.0), old / unit, anew / unit);
        format!("  {name:<22} {old:>10.3} in place of {anew:>10.3} ({gain:+.1} %)\n")
    };
    let part = |of: fn(&OrderChanges) -> u64, whole: &dyn Fn(&ReusedOrderFrame) -> u64| {
        100.0 * mean(&|frame: &ReusedOrderFrame| of(&frame.lists)) / mean(whole).max(1.0)
    };
    let rms = Spread::of(reused.iter().map(|frame| frame.error.rms));
    let bias = reused
        .iter()
        .fold(0.0, |most: f64, frame| most.max(frame.error.bias.abs()));
    format!(
        "order kept in {} of {frames} frames, a frame of them on the mean:\n{}{}{}  \
           entries                {:.2} % came, {:.2} % left; inversions {:.0}, {:.4} % of a tile's pairs of entries\n  \
           against exact order    PSNR worst {}, 95 % {}, mean {}; largest error {:.2e} ({}), bias up to {:.2e}\n",
        reused.len(),
        pair("sort, Mcycles", |frame| frame.sort_cycles, 1e6),
        pair("all phases, Mcycles", |frame| frame.cycles, 1e6),
        pair("bytes of the sort, MB", |frame| frame.sort_bytes, 1e6),
        part(|lists| lists.came, &|frame| frame.entries),
        part(|lists| lists.left, &|frame| frame.entries),
        mean(&|frame: &ReusedOrderFrame| frame.lists.inversions),
        part(|lists| lists.inversions, &|frame| frame.lists.pairs),
        psnr_of_rms(rms.worst),
        psnr_of_rms(rms.percentile_95),
        psnr_of_rms(rms.mean),
        worst.error.max_abs,
        worst.name,
        bias,
    )
}
