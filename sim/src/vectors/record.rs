//! What records are made of: words of anything, operands of all lengths.

use super::VectorStage;
use super::builtin::{BuiltinRandom, soft};
use fixed::types::{I2F30, I4F28, U4F28};
use splatline::blend::Pixel;
use splatline::blend::deep::DeepPixel;
use splatline::blend::points::Slab;
use splatline::blend::surface::Fragment;
use splatline::footprint::Footprint;
use splatline::footprint::surface::Attributes;
use splatline::math::SoftFloat;
use splatline::setup::Cull;
use splatline::splat::{Axis, VolumeSplat};

/// The `culled` field: 0, or the place of the reason in [`Cull::ALL`] counted from 1.
pub(super) fn reason<T>(result: &Result<T, Cull>) -> i64 {
    let cull = result.as_ref().err();
    cull.map_or(0, |cull| cull.place() as i64 + 1)
}

/// What a record is made of.
pub(super) trait Words {
    fn put(&self, record: &mut Vec<i64>);
}

macro_rules! words {
    ($($type:ty: |$value:ident| $word:expr;)*) => {
        $(impl Words for $type {
            fn put(&self, record: &mut Vec<i64>) {
                let $value = self;
                $word.put(record);
            }
        })*
    };
}

macro_rules! record {
    ($($part:expr);* $(;)?) => {{
        let mut record = Vec::new();
        $($part.put(&mut record);)*
        record
    }};
}

impl Words for i64 {
    fn put(&self, record: &mut Vec<i64>) {
        record.push(*self);
    }
}

impl<T: Words> Words for [T] {
    fn put(&self, record: &mut Vec<i64>) {
        self.iter().for_each(|word| word.put(record));
    }
}

words! {
    bool: |word| i64::from(*word);
    u8: |word| i64::from(*word);
    u16: |word| i64::from(*word);
    u32: |word| i64::from(*word);
    i32: |word| i64::from(*word);
    u64: |word| (*word as i64);
    I2F30: |word| word.to_bits();
    I4F28: |word| word.to_bits();
    U4F28: |word| word.to_bits();
    SoftFloat: |number| [number.mantissa, number.exponent];
    Pixel: |pixel| record![pixel.colour; pixel.transmittance(); pixel.is_finished()];
    Axis: |axis| record![axis.mantissa; axis.exponent];
    VolumeSplat: |splat| record![splat.centre; splat.axes; splat.weight; splat.colour];
    DeepPixel: |pixel| record![pixel.colour; pixel.alpha];
    Attributes: |own| record![own.colour; own.opacity; own.normal];
    Slab: |slab| record![slab.colour; slab.opacity; slab.first];
    Fragment: |sum| record![sum.weight; sum.colour; sum.opacity; sum.normal; sum.near; sum.far; sum.material];
    Footprint: |print| record![
        0i64; print.depth; print.centre; print.first; print.end; print.ldl.horizontal; print.ldl.squared_width; print.ldl.shear;
        print.ldl.vertical; print.cutoff; print.opacity;
    ];
}

/// Operands and results, zeros where there are none.
pub(super) fn push(stage: &mut VectorStage, mut record: Vec<i64>, found: Result<Vec<i64>, Cull>) {
    record.extend(found.as_ref().unwrap_or(&vec![reason(&found)]));
    record.resize(stage.fields.len(), 0);
    stage.add(record);
}

pub(super) use record;

/// Operands.
impl BuiltinRandom {
    /// Of 0 to `most`: every fourth at an end or next to one, every fourth short.
    pub(super) fn up_to(&mut self, most: u32) -> u32 {
        let (word, choice) = (self.bits(), self.bits() >> 24);
        let last = choice & 8 != 0;
        match choice & 7 {
            0 => u32::from(last) * most,
            1 if last => most.saturating_sub(word >> 30),
            1 => (word >> 30).min(most),
            2 | 3 => (word >> (choice >> 3)).min(most),
            _ => ((u64::from(word) * (u64::from(most) + 1)) >> 32) as u32,
        }
    }

    /// The same, the half of them halved up to three times.
    pub(super) fn shorter(&mut self, most: u32) -> u32 {
        self.up_to(most) >> (self.bits() >> 30)
    }

    /// The same with either sign.
    pub(super) fn within(&mut self, most: u32) -> i32 {
        self.up_to(most) as i32 * (1 - 2 * (self.bits() >> 31) as i32)
    }

    /// Below 2^power.
    pub(super) fn number(&mut self, power: i32) -> SoftFloat {
        let (mantissa, lower) = (self.up_to(i32::MAX as u32) as i32, self.up_to(2) as i32);
        let exponent = power - 31 - lower;
        soft(mantissa, exponent)
    }

    /// Every eighth is -1, 0 or 1.
    pub(super) fn weight(&mut self, usual: SoftFloat) -> SoftFloat {
        let mantissa = self.within(1);
        if self.up_to(7) > 0 {
            return usual;
        }
        soft(mantissa, 0)
    }

    /// Three words.
    pub(super) fn three(&mut self, most: u32) -> [u32; 3] {
        [(); 3].map(|()| self.up_to(most))
    }
}
