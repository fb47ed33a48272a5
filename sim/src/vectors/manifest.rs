//! The manifest: `manifest.json`, which says what the files hold and what they were computed from.

use super::stage::digest;
use super::{RecordField, VectorStage, VectorSubject, functions};
use crate::design::{DesignChoice, ResolvedDesign};
use crate::rules::{Compositing, Rules};
use fixed::types::{I2F30, I32F32};
use serde::{Deserialize, Serialize};
use splatline::math::{Extended, SoftFloat};
use splatline::view::{Eye, Projection, RatioLimits, View};
use std::str::FromStr;

/// Version of the folder's format; another version is refused.
///
/// 1 had positions and depths in fixed point; 2 has them with exponents; 3 has a digest of the inputs; 4 has packets of
/// version 3; 5 has all constants as integers, the functions and their tables, camera space and the centres' opacities.
/// 6 has what the rules filter by, and functions to 17 bits.
pub const FORMAT_VERSION: u32 = 6;

/// The content of `manifest.json`.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Manifest {
    /// [`FORMAT_VERSION`].
    pub format_version: u32,
    /// Version of the packet's layout.
    pub packet_version: u32,
    /// Name, traversal, rounding and widths.
    pub design: ResolvedDesign,
    /// Everything else that enters the datapath and is no input: an integer each.
    pub constants: Vec<super::ConstantRecord>,
    /// `ewa` or `3dgs`.
    pub rules: String,
    /// Variance of the low-pass filter, whether opacities are compensated for it, and the samples' spacing: the rules'
    /// own, or others.
    pub filter: (f64, bool, f64),
    /// `front-to-back`, `back-to-front` or `x-ray`.
    pub compositing: Compositing,
    /// The camera.
    pub view: ViewRecord,
    /// Of design, rules, compositing and view: no result tells whether `far` has moved by a bit, but this does.
    pub inputs_digest: String,
    /// The stages in the order of the data flow.
    pub stages: Vec<StageRecord>,
}

/// The camera in the kernel's formats: integers, see the kernel's `view`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ViewRecord {
    rotation_q1_30: [[i32; 3]; 3],
    rotation_rest_2_60: [[i32; 3]; 3],
    eye_mantissas: [i64; 3],
    eye_exponent: i32,
    focal_mantissa_exponent: [[i32; 2]; 2],
    principal_q31_32: [i64; 2],
    near_mantissa_exponent: (i64, i32),
    far_mantissa_exponent: (i64, i32),
    viewport: [u16; 2],
    orthographic: bool,
    ratio_low_q31_32: [i64; 2],
    ratio_high_q31_32: [i64; 2],
}

/// One file.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct StageRecord {
    /// Name of the stage.
    pub name: String,
    /// What a record is.
    pub about: String,
    /// Name of the file.
    pub file: String,
    /// Records in it.
    pub records: usize,
    /// Bits of a record.
    pub bits: usize,
    /// FNV-1a, 64 bits, of the file's bytes.
    pub digest: String,
    /// The fields of a record.
    pub fields: Vec<RecordField>,
}

impl Manifest {
    /// Describes the stages of a subject.
    pub fn new(subject: &VectorSubject, stages: &[VectorStage]) -> Self {
        let record = |stage: &VectorStage| StageRecord {
            name: stage.name.to_owned(),
            about: stage.about.to_owned(),
            file: format!("{}.hex", stage.name),
            records: stage.records.len(),
            bits: stage.bits(),
            digest: functions::known_digest(stage)
                .unwrap_or_else(|| digest(stage.to_text().as_bytes())),
            fields: stage.fields.clone(),
        };
        let design = subject.design.resolved();
        let rules = subject.rules.name.to_owned();
        let filter = {
            let rules = &subject.rules;
            (rules.low_pass, rules.compensated, rules.spacing)
        };
        let compositing = subject.compositing;
        let view = ViewRecord::from(&subject.view);
        let inputs = serde_json::json!([design, rules, filter, compositing, view]).to_string();
        Manifest {
            format_version: FORMAT_VERSION,
            packet_version: splatline::footprint::packet::VERSION,
            constants: super::constants::of(subject),
            design,
            rules,
            filter,
            compositing,
            view,
            inputs_digest: digest(inputs.as_bytes()),
            stages: stages.iter().map(record).collect(),
        }
    }

    /// The subject again, without its splats. The message names the field that is wrong.
    pub fn subject(&self) -> Result<VectorSubject, String> {
        if self.format_version != FORMAT_VERSION {
            return Err(format!(
                "format_version is {}, expected {FORMAT_VERSION}: export the vectors again with this version",
                self.format_version
            ));
        }
        let rules = Rules::from_str(&self.rules).map_err(|error| format!("rules: {error}"))?;
        let (low_pass, compensated, spacing) = self.filter;
        Ok(VectorSubject {
            design: DesignChoice::try_from(self.design.clone())
                .map_err(|error| error.to_string())?,
            rules: Rules {
                low_pass,
                compensated,
                spacing,
                ..rules
            },
            compositing: self.compositing,
            view: self.view.view(),
            splats: Vec::new(),
            systems: self.stages.iter().any(|stage| stage.name == "colours"),
        })
    }
}

impl From<&View> for ViewRecord {
    fn from(view: &View) -> Self {
        ViewRecord {
            rotation_q1_30: view.rotation.map(|row| row.map(I2F30::to_bits)),
            rotation_rest_2_60: view.pose.rotation_rest,
            eye_mantissas: view.pose.position,
            eye_exponent: view.pose.exponent,
            focal_mantissa_exponent: view.focal.map(|f| [f.mantissa, f.exponent]),
            principal_q31_32: view.principal.map(I32F32::to_bits),
            near_mantissa_exponent: (view.near.value, view.near.exponent),
            far_mantissa_exponent: (view.far.value, view.far.exponent),
            viewport: view.viewport,
            orthographic: view.projection == Projection::Orthographic,
            ratio_low_q31_32: view.limits.low.map(I32F32::to_bits),
            ratio_high_q31_32: view.limits.high.map(I32F32::to_bits),
        }
    }
}

fn extended((value, exponent): (i64, i32)) -> Extended {
    Extended { value, exponent }
}

impl ViewRecord {
    fn view(&self) -> View {
        View {
            rotation: self.rotation_q1_30.map(|row| row.map(I2F30::from_bits)),
            pose: Eye {
                position: self.eye_mantissas,
                exponent: self.eye_exponent,
                rotation_rest: self.rotation_rest_2_60,
            },
            focal: self
                .focal_mantissa_exponent
                .map(|[mantissa, exponent]| SoftFloat { mantissa, exponent }),
            principal: self.principal_q31_32.map(I32F32::from_bits),
            near: extended(self.near_mantissa_exponent),
            far: extended(self.far_mantissa_exponent),
            viewport: self.viewport,
            projection: if self.orthographic {
                Projection::Orthographic
            } else {
                Projection::Perspective
            },
            limits: RatioLimits {
                low: self.ratio_low_q31_32.map(I32F32::from_bits),
                high: self.ratio_high_q31_32.map(I32F32::from_bits),
            },
        }
    }
}
