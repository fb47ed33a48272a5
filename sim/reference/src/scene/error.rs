//! What can be wrong with a scene: every message names the file, the field and the fix.

use crate::memory::TooLarge;
use std::io;

/// A scene that could not be loaded.
#[derive(Debug, thiserror::Error)]
#[error("{file}: {problem}")]
pub struct LoadError {
    /// The file as the caller named it.
    pub file: String,
    /// What is wrong with it.
    #[source]
    pub problem: Problem,
}

/// The reasons for which a file is refused.
#[derive(Debug, thiserror::Error)]
pub enum Problem {
    /// The operating system could not read it.
    #[error("cannot be read: {0}")]
    Unreadable(#[from] io::Error),
    /// More than there is memory for.
    #[error(transparent)]
    TooLarge(#[from] TooLarge),
    /// A folder, a pipe or a device.
    #[error("is not a regular file; name a scene file")]
    NotAFile,
    /// Neither the extension nor the first bytes are known.
    #[error(
        "is of no known format; expected .ply, .splat, .spz, .sog (or a folder with its meta.json), .ksplat, .glb, .gltf, .nrrd, .nhdr, .nii, .nii.gz, .mhd, .mha or .vti, a point cloud (.ply, .xyz, .obj, .las, .laz) or a height field (.csv) with --as surface (or one of 'demo', 'random:COUNT[:SEED]', 'deep-stack')"
    )]
    UnknownFormat,
    /// Points where splats were asked for.
    #[error("is a file of points; add --as surface")]
    Points,
    /// A format that this build leaves out.
    #[error(
        ".{feature}: this program was built without its reader; build it with `cargo build --features {feature}` or convert the file"
    )]
    LeftOut {
        /// The Cargo feature, which is named after the format.
        feature: &'static str,
    },
    /// A field needs more bytes than there are.
    #[error(
        "{field}: {needed} bytes are needed but {found} are left; the file is truncated or its counts are wrong"
    )]
    Truncated {
        /// The part of the file that was being read.
        field: String,
        /// Bytes that the header asks for.
        needed: u64,
        /// Bytes that are there.
        found: u64,
    },
    /// A compressed part that does not unpack.
    #[error("{field}: the gzip stream is damaged or truncated ({reason}); fetch the file again")]
    Gzip {
        /// The compressed part.
        field: String,
        /// What the decompressor said.
        reason: String,
    },
    /// A part packed by zstd that does not unpack.
    #[error("{field}: the zstd stream is damaged or truncated ({reason}); fetch the file again")]
    Zstd {
        /// The compressed part.
        field: String,
        /// What the decompressor said.
        reason: String,
    },
    /// Anything else: the field, what was found there, and what to do.
    #[error("{field}: {found}; {fix}")]
    Malformed {
        /// The field, with its line where the format has lines.
        field: String,
        /// What the file says.
        found: String,
        /// How to repair it.
        fix: String,
    },
}

impl Problem {
    /// A malformed field, what was found there and what to do about it.
    pub(crate) fn malformed(
        field: impl Into<String>,
        found: impl Into<String>,
        fix: impl Into<String>,
    ) -> Self {
        Problem::Malformed {
            field: field.into(),
            found: found.into(),
            fix: fix.into(),
        }
    }

    /// A format whose feature was not built.
    #[allow(dead_code)] // With all features there is none.
    pub(crate) fn without(feature: &'static str) -> Self {
        Problem::LeftOut { feature }
    }

    /// The same problem as an error about `file`.
    pub(crate) fn of(self, file: impl Into<String>) -> LoadError {
        LoadError {
            file: file.into(),
            problem: self,
        }
    }
}

/// What a message may show of a file: no control characters, and not much.
pub(crate) fn shorten(text: &str) -> String {
    text.chars().filter(|c| !c.is_control()).take(60).collect()
}
