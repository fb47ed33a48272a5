//! The reference's formulas once more, as naively as possible: full matrices, a loop over every splat at every pixel,
//! sums instead of closed forms. Slow and less accurate, but with no line in common with what it checks.

use splatline_reference::camera::Camera;
use splatline_reference::picture::Picture;
use splatline_reference::rules::{Compositing, Rules};
use splatline_reference::scene::{Scene, Splat};

type Matrix = [[f64; 3]; 3];

/// Which engine to imitate.
#[derive(Clone, Copy, Debug)]
pub enum Engine {
    /// The Jacobian at the splat's centre.
    Float,
    /// The Jacobian at each pixel's ray.
    Exact,
}

fn product(a: &Matrix, b: &Matrix) -> Matrix {
    let entry = |i: usize, j: usize| (0..3).map(|k| a[i][k] * b[k][j]).sum();
    std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j)))
}

fn transposed(a: &Matrix) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|j| a[j][i]))
}

fn determinant(a: &Matrix) -> f64 {
    let minor = |i: usize, j: usize| a[1][i] * a[2][j] - a[1][j] * a[2][i];
    a[0][0] * minor(1, 2) - a[0][1] * minor(0, 2) + a[0][2] * minor(0, 1)
}

/// V in camera space: W (sum of a a^T) W^T.
fn camera_variance(splat: &Splat, camera: &Camera) -> Matrix {
    let world: Matrix = std::array::from_fn(|i| {
        std::array::from_fn(|j| splat.axes.iter().map(|a| a[i] * a[j]).sum())
    });
    product(
        &product(&camera.rotation, &world),
        &transposed(&camera.rotation),
    )
}

/// The 3x3 ray-space Jacobian of \[EWA\] eq. 29 in pixels, at the ray (sx, sy, 1) and depth z.
fn ray_jacobian(slope: [f64; 2], z: f64, camera: &Camera) -> Matrix {
    if camera.orthographic {
        return [
            [camera.fx, 0.0, 0.0],
            [0.0, camera.fy, 0.0],
            [0.0, 0.0, 1.0],
        ];
    }
    let [x, y] = [slope[0] * z, slope[1] * z];
    let l = (x * x + y * y + z * z).sqrt();
    [
        [camera.fx / z, 0.0, -camera.fx * x / (z * z)],
        [0.0, camera.fy / z, -camera.fy * y / (z * z)],
        [x / l, y / l, z / l],
    ]
}

fn clamped_slope(slope: f64, size: usize, centre: f64, focal_length: f64) -> f64 {
    let t = size as f64 / (2.0 * focal_length);
    slope.clamp(
        -(centre / focal_length + 0.3 * t),
        (size as f64 - centre) / focal_length + 0.3 * t,
    )
}

/// Opacity of one splat at one point of the picture.
fn opacity(
    engine: Engine,
    splat: &Splat,
    camera: &Camera,
    rules: &Rules,
    point: [f64; 2],
) -> Option<f64> {
    let [x, y, z] = camera.to_camera(splat.centre);
    if z <= camera.near || z >= camera.far {
        return None;
    }
    let distance = if camera.orthographic { 1.0 } else { z };
    let [u, v] = [
        camera.fx * x / distance + camera.cx,
        camera.fy * y / distance + camera.cy,
    ];
    let slope = match engine {
        Engine::Exact => [
            (point[0] - camera.cx) / camera.fx,
            (point[1] - camera.cy) / camera.fy,
        ],
        Engine::Float if rules.clamp_jacobian => [
            clamped_slope(x / z, camera.width, camera.cx, camera.fx),
            clamped_slope(y / z, camera.height, camera.cy, camera.fy),
        ],
        Engine::Float => [x / z, y / z],
    };
    let jacobian = ray_jacobian(slope, z, camera);
    let variance = product(
        &product(&jacobian, &camera_variance(splat, camera)),
        &transposed(&jacobian),
    );
    let a = variance[0][0] + rules.low_pass;
    let b = variance[0][1];
    let c = variance[1][1] + rules.low_pass;
    let determinant_of_variance = a * c - b * b;
    let [dx, dy] = [point[0] - u, point[1] - v];
    let r = (c * dx * dx - 2.0 * b * dx * dy + a * dy * dy) / determinant_of_variance;
    let mass_to_peak =
        determinant(&jacobian).abs() / (std::f64::consts::TAU * determinant_of_variance.sqrt());
    let peak = splat.weight * if rules.normalised { mass_to_peak } else { 1.0 };
    let alpha = (peak * (-r / 2.0).exp()).min(rules.alpha_max);
    (r < rules.cutoff && alpha >= rules.alpha_min && alpha > 0.0).then_some(alpha)
}

/// The whole picture, from the formulas above.
pub fn naive_picture(
    engine: Engine,
    scene: &Scene,
    camera: &Camera,
    rules: &Rules,
    compositing: Compositing,
) -> Picture {
    let depth = |index: usize| camera.to_camera(scene.splats[index].centre)[2];
    let mut order: Vec<usize> = (0..scene.splats.len()).collect();
    order.sort_by(|&a, &b| depth(a).total_cmp(&depth(b)));
    gather(camera, rules, compositing, &order, |index, point| {
        let splat = &scene.splats[index];
        Some((opacity(engine, splat, camera, rules, point)?, splat.colour))
    })
}

/// Blends what `sample` returns for every splat of `order` (nearest first) at every pixel.
pub fn gather(
    camera: &Camera,
    rules: &Rules,
    compositing: Compositing,
    order: &[usize],
    sample: impl Fn(usize, [f64; 2]) -> Option<(f64, [f64; 3])>,
) -> Picture {
    let mut picture = Picture::new(camera.width, camera.height);
    for (position, pixel) in picture.pixels.iter_mut().enumerate() {
        let point = [
            (position % camera.width) as f64 + 0.5,
            (position / camera.width) as f64 + 0.5,
        ];
        let samples: Vec<_> = order
            .iter()
            .filter_map(|&index| sample(index, point))
            .collect();
        *pixel = match compositing {
            Compositing::FrontToBack => front_to_back(&samples, rules),
            Compositing::BackToFront => front_to_back(
                &samples,
                &Rules {
                    minimum_transmittance: -1.0,
                    ..*rules
                },
            ),
            Compositing::XRay => x_ray(&samples),
        };
    }
    picture
}

fn front_to_back(samples: &[(f64, [f64; 3])], rules: &Rules) -> [f64; 4] {
    let mut rgb = [0.0; 3];
    let mut transmittance = 1.0;
    for (alpha, colour) in samples {
        let next = transmittance * (1.0 - alpha);
        if rules.omit_finishing && next <= rules.minimum_transmittance {
            break;
        }
        for i in 0..3 {
            rgb[i] += transmittance * alpha * colour[i];
        }
        transmittance = next;
        if transmittance <= rules.minimum_transmittance {
            break;
        }
    }
    [rgb[0], rgb[1], rgb[2], 1.0 - transmittance]
}

fn x_ray(samples: &[(f64, [f64; 3])]) -> [f64; 4] {
    let mut sum = [0.0; 4];
    for (alpha, [r, g, b]) in samples {
        let weighted = [alpha * r, alpha * g, alpha * b, *alpha];
        sum = std::array::from_fn(|i| sum[i] + weighted[i]);
    }
    sum.map(|channel: f64| channel.min(1.0))
}

/// By summation along the ray through `point`: the integral of the splat's widened Gaussian in pixel units, and the
/// smallest squared Mahalanobis distance.
pub fn integral_and_distance(
    splat: &Splat,
    camera: &Camera,
    point: [f64; 2],
    low_pass: f64,
) -> (f64, f64) {
    let centre = camera.to_camera(splat.centre);
    let z0 = centre[2];
    let mut variance = camera_variance(splat, camera);
    variance[0][0] += low_pass * (z0 / camera.fx).powi(2);
    variance[1][1] += low_pass * (z0 / camera.fy).powi(2);
    let inverse = inverted(&variance);
    let ray = [
        (point[0] - camera.cx) / camera.fx,
        (point[1] - camera.cy) / camera.fy,
        1.0,
    ];
    let form = |a: [f64; 3], b: [f64; 3]| -> f64 {
        (0..3)
            .map(|i| (0..3).map(|j| a[i] * inverse[i][j] * b[j]).sum::<f64>())
            .sum()
    };
    // Samples around the nearest point, far enough and dense enough for the trapezoidal rule on a Gaussian.
    let nearest = form(ray, centre) / form(ray, ray);
    let step = 0.1 / form(ray, ray).sqrt();
    let distances = (-100..=100).map(|i| {
        let z = nearest + f64::from(i) * step;
        let offset = std::array::from_fn(|k| z * ray[k] - centre[k]);
        form(offset, offset)
    });
    let distances: Vec<f64> = distances.collect();
    let stretch = (ray[0] * ray[0] + ray[1] * ray[1] + 1.0).sqrt();
    let norm = 1.0 / (std::f64::consts::TAU.powf(1.5) * determinant(&variance).sqrt());
    let sum: f64 = distances.iter().map(|r| (-r / 2.0).exp()).sum();
    (
        norm * sum * step * stretch,
        distances.into_iter().fold(f64::INFINITY, f64::min),
    )
}

fn inverted(a: &Matrix) -> Matrix {
    let det = determinant(a);
    let cofactor = |i: usize, j: usize| {
        let (i1, i2, j1, j2) = ((i + 1) % 3, (i + 2) % 3, (j + 1) % 3, (j + 2) % 3);
        a[i1][j1] * a[i2][j2] - a[i1][j2] * a[i2][j1]
    };
    std::array::from_fn(|i| std::array::from_fn(|j| cofactor(j, i) / det))
}
