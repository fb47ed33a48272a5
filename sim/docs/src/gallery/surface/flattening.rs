//! Volume kernels flattened into surface kernels, and the depth of the tangent plane.

use super::{GalleryError, exhibit, standard};
use crate::gallery::Exhibit;
use splatline::format::Traversal;
use splatline_sim::camera::Camera;
use splatline_sim::fixed::surface::{QuantisedPoints, footprints as surface_footprints};
use splatline_sim::fixed::{self, Options, kernel_rules};
use splatline_sim::reference::{float, surface};
use splatline_sim::rules::{Compositing, Rules};
use splatline_sim::scene::points::synthetic::{Paint, scene, sphere};
use splatline_sim::scene::points::{SurfacePoint, share_of_area};
use splatline_sim::scene::{Scene, Skipped, SortOrder, Splat, Weight};
use splatline_sim::surface::Style;
use splatline_sim::vector;

/// Powers of two of s, by which the kernel's third axis is divided.
const FLATTENINGS: [i32; 7] = [0, 2, 4, 6, 8, 10, 14];

/// A conic and the height of its kernel.
struct FlatShape {
    conic: [f64; 3],
    peak: f64,
}

impl FlatShape {
    /// Largest deviation of the conic, relative to its trace, and of the peak, relative to a kernel seen head-on.
    fn deviation(&self, from: &FlatShape) -> [f64; 2] {
        let size = from.conic[0] + from.conic[2];
        let conic = self
            .conic
            .iter()
            .zip(from.conic)
            .map(|(a, b)| (a - b).abs() / size);
        [
            conic.fold(0.0, f64::max),
            (self.peak - from.peak).abs() / share_of_area(),
        ]
    }
}

/// The kernel's third axis along the normal divided by s, against the surface kernel.
pub fn flattening() -> Result<Exhibit, GalleryError> {
    let points = sphere([0.0; 3], 1.0, 2_000, Paint::opaque([1.0; 3]));
    let camera = Camera::look_at([0.3, -4.0, 0.8], [0.0; 3], [0.0, 0.0, 1.0], 40.0, 512, 512)?;
    let style = Style::opaque(0.1);
    let mut exhibit = exhibit(
        "Flattening a volume kernel into a surface kernel",
        "[EWA] section 6.4 (system 3)",
        "2,000 kernels on a sphere, their third axis (along the normal) divided by s, against the surface kernels of the same points: largest \
         deviation of the conic, relative to its trace, and of the peak, relative to a kernel seen head-on. Masses are w 2 pi r^2 cos(normal, ray): a sheet's integral along a ray grows \
         with its obliquity, a surface's weight does not. The deviation falls as 1/s^2 in double precision down to rounding, and in fixed point \
         down to the mantissa.",
    );
    let (float_surface, fixed_surface) = surface_shapes(&points, &camera, &style);
    for power in FLATTENINGS {
        let volume = flattened(&points, &camera, f64::from(power).exp2());
        let (float_volume, fixed_volume) = volume_shapes(&volume, &camera, &style);
        for (engine, volume, surface) in [
            ("float", &float_volume, &float_surface),
            ("fixed", &fixed_volume, &fixed_surface),
        ] {
            let pairs = volume
                .iter()
                .zip(surface)
                .filter_map(|(v, s)| v.as_ref().zip(s.as_ref()));
            let worst = pairs.map(|(v, s)| v.deviation(s));
            let [conic, peak] =
                worst.fold([0.0; 2], |[a, b]: [f64; 2], [c, d]| [a.max(c), b.max(d)]);
            exhibit.number(format!("{engine}, s = 2^{power}: conic"), conic, "");
            exhibit.number(format!("{engine}, s = 2^{power}: peak"), peak, "");
        }
    }
    Ok(exhibit)
}

/// Volume splats of the same points, thin along the normal.
fn flattened(points: &[SurfacePoint], camera: &Camera, s: f64) -> Scene {
    let splat = |point: &SurfacePoint| {
        let radius = vector::length(point.frame[0]);
        let position = camera.to_camera(point.centre);
        let normal = vector::transform(&camera.rotation, point.normal);
        let cosine = vector::dot(normal, position).abs() / vector::length(position);
        Splat {
            centre: point.centre,
            axes: [
                point.frame[0],
                point.frame[1],
                vector::scale(radius / s, point.normal),
            ],
            weight: point.weight * std::f64::consts::TAU * radius * radius * cosine,
            colour: point.colour,
        }
    };
    Scene {
        name: "flattened".to_owned(),
        natural_rules: Rules::EWA,
        weight: Weight::Mass,
        splats: points.iter().map(splat).collect(),
        harmonics: None,
        skipped: Skipped::default(),
        order: SortOrder::Depth,
        up: [0.0, 0.0, 1.0],
    }
}

type Shapes = Vec<Option<FlatShape>>;

fn surface_shapes(points: &[SurfacePoint], camera: &Camera, style: &Style) -> (Shapes, Shapes) {
    let design = standard();
    let cloud = scene("points", points.to_vec());
    let quantised = QuantisedPoints::new(&cloud, camera);
    let fixed = surface_footprints(&quantised, style, &design);
    let fixed = fixed
        .iter()
        .map(|f| f.as_ref().ok().map(|f| fixed_shape(&f.footprint)));
    let float = points
        .iter()
        .map(|point| surface::project(point, camera, style).ok());
    let float = float.map(|f| {
        f.map(|f| FlatShape {
            conic: f.conic,
            peak: f.peak,
        })
    });
    (float.collect(), fixed.collect())
}

fn volume_shapes(scene: &Scene, camera: &Camera, style: &Style) -> (Shapes, Shapes) {
    let design = standard();
    let rules = Rules {
        cutoff: style.cutoff,
        ..Rules::EWA
    };
    debug_assert_eq!(kernel_rules(&rules).table_range, 2);
    let options = Options {
        rules: &rules,
        compositing: Compositing::XRay,
        design: &design,
        traversal: Traversal::Spans,
    };
    let fixed = fixed::footprints(scene, camera, &options);
    let fixed = fixed.iter().map(|f| f.as_ref().ok().map(fixed_shape));
    let float = float::footprints(scene, camera, &rules);
    let float = float.iter().map(|f| {
        f.as_ref().ok().map(|f| FlatShape {
            conic: f.conic,
            peak: f.peak,
        })
    });
    (float.collect(), fixed.collect())
}

fn fixed_shape(footprint: &splatline::footprint::Footprint) -> FlatShape {
    let unit = f64::from(footprint.conic.exponent).exp2();
    FlatShape {
        conic: footprint.conic.mantissa.map(|m| f64::from(m) * unit),
        peak: f64::from(footprint.opacity) / f64::from(standard().widths.peak).exp2(),
    }
}

/// What the affine depth leaves out, over all splats and the pixels inside their cut-off.
pub fn plane_depth() -> Result<Exhibit, GalleryError> {
    let points = sphere([0.0; 3], 1.0, 40_000, Paint::opaque([1.0; 3]));
    let cloud = scene("points", points);
    let camera = Camera::look_at([0.3, -4.0, 0.8], [0.0; 3], cloud.up, 40.0, 512, 512)?;
    let mut exhibit = exhibit(
        "Depth of the tangent plane",
        "[SURF] section 4 (system 9)",
        "Depth lane of the rasterizer on a sphere of 40,000 points, in radii of the splats. The affine depth against the plane cut by the pixel's ray \
         (perspective), for splats that are no more than 60 degrees oblique, without and with the low-pass filter's share in the slope; the fixed lane against the affine depth in double precision, for all; and the largest excursion from \
         the centre's depth, which the regression keeps below sqrt(2) radii where the plane's own slope grows without bound.",
    );
    let style = Style::opaque(cloud.usual_threshold());
    let quantised = QuantisedPoints::new(&cloud, &camera);
    let unit = f64::from(quantised.scale_log2).exp2() * 2f64.powi(32);
    let fixed = surface_footprints(&quantised, &style, &standard());
    let sharp = Style {
        low_pass: 1e-9,
        ..style
    };
    let mut filtered = 0.0f64;
    let (mut affine, mut lane, mut excursion, mut steep) = (0.0f64, 0.0f64, 0.0f64, 0.0f64);
    for (point, fixed) in cloud.points.iter().zip(&fixed) {
        let (Ok(splat), Ok(fixed)) = (surface::project(point, &camera, &style), fixed) else {
            continue;
        };
        let Ok(unfiltered) = surface::project(point, &camera, &sharp) else {
            continue;
        };
        let cosine = vector::dot(splat.normal, camera.to_camera(point.centre)).abs()
            / vector::length(camera.to_camera(point.centre));
        for (x, y) in inside(&splat, style.cutoff) {
            let place = [x as f64 + 0.5, y as f64 + 0.5];
            let offset = [place[0] - splat.centre[0], place[1] - splat.centre[1]];
            let slope = splat.gradient[0] * offset[0] + splat.gradient[1] * offset[1];
            let exact = surface::exact_depth(point, &camera, place);
            let got = fixed.depth_at(x as u16, y as u16) as f64 / unit;
            lane = lane.max((got - splat.depth - slope).abs());
            excursion = excursion.max(slope.abs());
            steep = steep.max((exact - splat.depth).abs());
            if cosine > 0.5 {
                let [across, down] = unfiltered.gradient;
                let plane = splat.depth + across * offset[0] + down * offset[1];
                affine = affine.max((plane - exact).abs());
                filtered = filtered.max((splat.depth + slope - exact).abs());
            }
        }
    }
    for (name, value) in [
        (
            "affine plane against exact plane, up to 60 degrees oblique",
            affine,
        ),
        (
            "filtered affine plane against exact plane, up to 60 degrees oblique",
            filtered,
        ),
        ("fixed lane against affine", lane),
        ("largest excursion, filtered", excursion),
        ("largest excursion, exact plane", steep),
    ] {
        exhibit.number(name, value / cloud.radius, "radii");
    }
    Ok(exhibit)
}

/// Pixels inside a footprint's cut-off.
fn inside(splat: &surface::SurfaceFootprint, cutoff: f64) -> Vec<(usize, usize)> {
    let [a, b, c] = splat.conic;
    let bounds = splat.bounds;
    let all = (bounds.y0..bounds.y1).flat_map(|y| (bounds.x0..bounds.x1).map(move |x| (x, y)));
    all.filter(|(x, y)| {
        let (dx, dy) = (
            *x as f64 + 0.5 - splat.centre[0],
            *y as f64 + 0.5 - splat.centre[1],
        );
        a * dx * dx + 2.0 * b * dx * dy + c * dy * dy < cutoff
    })
    .collect()
}
