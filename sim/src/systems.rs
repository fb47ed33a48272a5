//! The eighteen systems of the four papers: what they are and where they live.

use serde::{Deserialize, Serialize};

/// A system of the papers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct System {
    /// 1 to 18.
    pub number: u8,
    /// What it is.
    pub name: &'static str,
    /// Paper and section or equation.
    pub source: &'static str,
    /// Files that hold it: of the kernel, or of the host where they begin with `sim`.
    pub modules: &'static str,
    /// Its counterpart in double precision, in `sim/reference/src/engines`.
    pub reference: &'static str,
}

const fn system(
    number: u8,
    name: &'static str,
    source: &'static str,
    modules: &'static str,
    reference: &'static str,
) -> System {
    System {
        number,
        name,
        source,
        modules,
        reference,
    }
}

/// All of them, by number.
#[rustfmt::skip]
pub const SYSTEMS: [System; 18] = [
    system(1, "EWA volume splat", "[EWA] 6.2, 7.1", "setup/project, jacobian, covariance, shape, opacity", "jacobian, float"),
    system(2, "EWA surface splat", "[EWA] 6.3, [SURF] 3.3, 4", "setup/surface, footprint/surface", "surface"),
    system(3, "flattening a volume kernel into a surface kernel", "[EWA] 6.4", "setup/surface, setup/mod", "surface, jacobian"),
    system(4, "forward-differencing rasterizer", "[EWA] 7.1.2, [SURF] 4", "raster/conic, spans; kernel", "compositor"),
    system(5, "compositing, sheet buffers, X-ray", "[EWA] 4.1, 7.1, [HYBRID] 4.1, [SWAN] 3.1", "blend, blend/sheets", "compositor, sheets"),
    system(6, "distance scaling", "[SWAN] 4.3", "setup/distance", "kernels"),
    system(7, "hardware splat primitive: kernels, stamps", "[SWAN] 6", "kernel/shape, raster/stamp, draw/stamp", "kernels, hybrid"),
    system(8, "deep alpha channel", "[SWAN] 6", "blend/deep", "compositor"),
    system(9, "accumulation buffer with normalisation", "[SURF] 4, eq. 9", "blend/surface, blend/resolve", "surface"),
    system(10, "deferred shading", "[SURF] 4", "blend/shading", "surface"),
    system(11, "layered A-buffer", "[SURF] 6, eq. 12", "blend/layers", "surface"),
    system(12, "edge antialiasing", "[SURF] 7", "blend/edge", "surface"),
    system(13, "texture acquisition", "[SURF] 5", "sim/reference/src/texture/coefficients, solve, drape", "surface"),
    system(14, "hybrid points and splats", "[HYBRID] 2, 4", "setup/point, blend/points, draw/hybrid", "hybrid"),
    system(15, "exact ellipse of a projected sphere", "[HYBRID] 4.2, app. A", "setup/sphere", "sphere"),
    system(16, "perspective-correct footprint index", "[HYBRID] 4.2", "kernel/perspective, kernel/ray", "sphere"),
    system(17, "hybrid image warping and texture mapping", "[HYBRID] 3", "sim/reference/src/texture/warp", "hybrid"),
    system(18, "volume shading and classification", "[EWA] 7.1, [SWAN] 5", "sim/reference/src/scene/shade, transfer", "float"),
];

/// Whether a system is exercised, and why.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct SystemVerdict {
    /// 1 to 18.
    pub number: u8,
    /// What it is.
    pub name: String,
    /// Is it exercised?
    pub used: bool,
    /// Why, or what it lacks.
    pub reason: String,
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A name without a folder lies in the folder of the name before: `setup/project, jacobian` are two of `setup`.
    #[test]
    fn files_of_systems_exist() {
        let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
        let exists = |path: &std::path::Path| path.is_dir() || path.with_extension("rs").exists();
        for system in &SYSTEMS {
            for group in system.modules.split("; ") {
                let mut folder = root.join("src");
                for name in group.split(", ") {
                    let file = if name.starts_with("sim/") {
                        root.join(name)
                    } else if name.contains('/') {
                        root.join("src").join(name)
                    } else {
                        folder.join(name)
                    };
                    assert!(exists(&file), "{}: {name}", system.number);
                    folder = file.parent().map_or(folder, |parent| parent.to_owned());
                }
            }
            for name in system.reference.split(", ") {
                let file = root.join("sim/reference/src/engines").join(name);
                assert!(exists(&file), "{}: {name}", system.number);
            }
        }
    }

    #[test]
    fn systems_are_numbered_in_order() {
        assert!(
            SYSTEMS
                .iter()
                .zip(1..)
                .all(|(system, number)| system.number == number)
        );
    }
}
