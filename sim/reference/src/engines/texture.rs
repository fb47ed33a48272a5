//! The continuous texture function of \[SURF\] eq. 2 and its exact reprojection (\[HYBRID\] 3), summed in the plainest way.
//!
//! What a surface splatted with given coefficients looks like on its own texture, without screen, low-pass filter and depth: the function
//! that the optimised coefficients fit, and the limit of a drawing under ever greater magnification.

use crate::texture::coefficients::SamplePoint;

/// f(u) = sum_k w_k g_k(u) / sum_k g_k(u) with g_k = exp(-r_k / 2) inside `cutoff`; none where no function reaches.
pub fn texture_function(
    points: &[SamplePoint],
    colours: &[[f64; 3]],
    cutoff: f64,
    place: [f64; 2],
) -> Option<[f64; 3]> {
    let (mut sum, mut colour) = (0.0, [0.0; 3]);
    for (point, coefficient) in points.iter().zip(colours) {
        let index = radial_index(point, place);
        if index < cutoff {
            let height = (-0.5 * index).exp();
            sum += height;
            for (total, channel) in colour.iter_mut().zip(coefficient) {
                *total += height * channel;
            }
        }
    }
    (sum > 0.0).then(|| colour.map(|total| total / sum))
}

/// Squared length of the place in the point's own axes: the two axes' coordinates by Cramer's rule.
fn radial_index(point: &SamplePoint, place: [f64; 2]) -> f64 {
    let [a, b] = point.axes;
    let [x, y] = [place[0] - point.place[0], place[1] - point.place[1]];
    let area = a[0] * b[1] - a[1] * b[0];
    let along = [(x * b[1] - y * b[0]) / area, (a[0] * y - a[1] * x) / area];
    along[0] * along[0] + along[1] * along[1]
}
