//! Quaternions of which the three smallest parts are stored: the largest follows from the length 1, with a positive
//! sign.

use std::f64::consts::FRAC_1_SQRT_2;

/// The four parts, from the place of the largest and the others in order, in units of sqrt(1/2).
pub(super) fn smallest_three(largest: usize, stored: [f64; 3]) -> [f64; 4] {
    let mut parts = [0.0; 4];
    let mut others = stored.into_iter();
    let mut squares = 0.0;
    for (place, part) in parts.iter_mut().enumerate() {
        if place != largest {
            *part = others.next().unwrap_or(0.0) * FRAC_1_SQRT_2;
            squares += *part * *part;
        }
    }
    if let Some(part) = parts.get_mut(largest) {
        *part = f64::max(0.0, 1.0 - squares).sqrt();
    }
    parts
}

#[cfg(test)]
mod tests {
    use super::smallest_three;

    #[test]
    fn the_largest_part_completes_the_length() {
        for largest in 0..4 {
            let parts = smallest_three(largest, [0.5, -0.25, 0.125]);
            let length: f64 = parts.iter().map(|part| part * part).sum();
            assert!((length - 1.0).abs() < 1e-15);
            assert!(parts[largest] > 0.5);
        }
        assert_eq!(smallest_three(1, [1.0, 1.0, 1.0])[1], 0.0);
    }
}
