//! Damped sparse least squares, for the optimised texture coefficients (\[SURF\] 5).
//!
//! Wanted is the w that minimises sum_j |sum_k R_jk w_k - c_j|^2 + lambda d sum_k |w_k - w0_k|^2. Its normal equations
//! (R^T R + lambda d I) w = R^T c + lambda d w0, with d the mean of R^T R's diagonal, are symmetric and sparse: basis
//! functions overlap with a dozen neighbours. They are gathered row by row of R, which is never stored (14 million
//! entries for a photograph of 2048^2), and solved per colour channel by the BiCGSTAB of the crate `sprs`. Why this
//! crate: docs/systems.md.

use anyhow::{Result, ensure};
use sprs::linalg::bicgstab::BiCGSTAB;
use sprs::{CsMat, CsVec, TriMat};

/// lambda: keeps points determined that no sample sees, far below what changes a colour visibly.
const DAMPING: f64 = 1e-4;
/// Norm of the residual at the end, in norms of the right-hand side.
const TOLERANCE: f64 = 1e-8;
/// Iterations at most; a well-sampled grid takes about thirty.
const MOST_ITERATIONS: usize = 2000;

/// Normal equations with one right-hand side per colour channel.
#[derive(Clone, Debug)]
pub struct NormalEquations {
    /// Per unknown the entries of R^T R, in the order in which they were met.
    rows: Vec<Vec<(usize, f64)>>,
    /// R^T c.
    right: Vec<[f64; 3]>,
}

impl NormalEquations {
    /// No equation yet for `count` unknowns.
    pub fn new(count: usize) -> NormalEquations {
        NormalEquations {
            rows: vec![Vec::new(); count],
            right: vec![[0.0; 3]; count],
        }
    }

    /// Adds the equation sum_k `row`_k w_k = `colour`.
    pub fn add(&mut self, row: &[(usize, f64)], colour: [f64; 3]) {
        for &(k, weight) in row {
            for (sum, channel) in self.right[k].iter_mut().zip(colour) {
                *sum += weight * channel;
            }
            for &(other, second) in row {
                let entries = &mut self.rows[k];
                match entries.iter_mut().find(|(index, _)| *index == other) {
                    Some((_, sum)) => *sum += weight * second,
                    None => entries.push((other, weight * second)),
                }
            }
        }
    }

    /// The unknowns, damped towards `start`.
    pub fn solve(&self, start: &[[f64; 3]]) -> Result<Vec<[f64; 3]>> {
        let mut unknowns = start.to_vec();
        let diagonal = self.mean_diagonal();
        if diagonal == 0.0 {
            return Ok(unknowns);
        }
        let damping = DAMPING * diagonal;
        let matrix = self.matrix(damping);
        for channel in 0..3 {
            let first: Vec<f64> = start.iter().map(|colour| colour[channel]).collect();
            let right = self.right.iter().zip(&first);
            let right = right.map(|(sum, w0)| sum[channel] + damping * w0).collect();
            let values = solve_one(&matrix, dense(right), dense(first))?;
            for (unknown, value) in unknowns.iter_mut().zip(values) {
                unknown[channel] = value;
            }
        }
        Ok(unknowns)
    }

    fn mean_diagonal(&self) -> f64 {
        let diagonal = self.rows.iter().enumerate().flat_map(|(k, entries)| {
            let own = entries.iter().filter(move |(index, _)| *index == k);
            own.map(|(_, value)| *value)
        });
        diagonal.sum::<f64>() / self.rows.len().max(1) as f64
    }

    /// R^T R with the damping on its diagonal, by columns: the crate multiplies those by a full vector in linear time.
    fn matrix(&self, damping: f64) -> CsMat<f64> {
        let count = self.rows.len();
        let mut matrix = TriMat::new((count, count));
        for (k, entries) in self.rows.iter().enumerate() {
            for (index, value) in entries {
                matrix.add_triplet(*index, k, *value);
            }
            matrix.add_triplet(k, k, damping);
        }
        matrix.to_csc()
    }
}

/// One channel's unknowns.
fn solve_one(matrix: &CsMat<f64>, right: CsVec<f64>, start: CsVec<f64>) -> Result<Vec<f64>> {
    let norm = right.l2_norm().max(f64::MIN_POSITIVE);
    let tolerance = TOLERANCE * norm;
    let fresh = BiCGSTAB::<f64, _, _>::new(matrix.view(), start.view(), right.view());
    // An exact start has no direction to search in.
    let solved = if fresh.err() < tolerance {
        Ok(Box::new(fresh))
    } else {
        BiCGSTAB::<f64, _, _>::solve(
            matrix.view(),
            start.view(),
            right.view(),
            tolerance,
            MOST_ITERATIONS,
        )
    };
    let (ended, solver) = match solved {
        Ok(solver) => (true, solver),
        Err(solver) => (false, solver),
    };
    let values = solver.x().to_dense().to_vec();
    ensure!(
        ended && values.iter().all(|value| value.is_finite()),
        "the texture coefficients did not converge: residual {:.1e} after {} iterations; \
         use plain or prefiltered coefficients",
        solver.err() / norm,
        solver.iteration_count()
    );
    Ok(values)
}

/// The crate's vectors are sparse; these have every entry.
fn dense(values: Vec<f64>) -> CsVec<f64> {
    CsVec::new(values.len(), (0..values.len()).collect(), values)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vector;

    #[test]
    fn the_solution_is_that_of_dense_elimination() {
        let count = 12;
        let mut state = 1u32;
        let mut random = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(state >> 8) / f64::from(1 << 24)
        };
        let mut equations = NormalEquations::new(count);
        // With the right-hand side behind each row.
        let mut dense = vec![vec![0.0; count + 1]; count];
        for sample in 0..60 {
            let row: Vec<(usize, f64)> = (0..3)
                .map(|step| ((sample + 2 * step) % count, 0.1 + random()))
                .collect();
            let colour = [random(), random(), random()];
            equations.add(&row, colour);
            for &(k, a) in &row {
                dense[k][count] += a * colour[1];
                row.iter().for_each(|&(l, b)| dense[k][l] += a * b);
            }
        }
        let start = vec![[0.5; 3]; count];
        let mean = (0..count).map(|k| dense[k][k]).sum::<f64>() / count as f64;
        for (k, row) in dense.iter_mut().enumerate() {
            row[k] += DAMPING * mean;
            row[count] += DAMPING * mean * 0.5;
        }
        vector::eliminate(&mut dense);
        let solution = equations.solve(&start).unwrap();
        for (found, row) in solution.iter().zip(dense) {
            assert!((found[1] - row[count]).abs() < 1e-6, "{found:?} {row:?}");
        }
    }

    #[test]
    fn without_equations_and_with_an_exact_start_nothing_moves() {
        let start = vec![[0.25, 0.5, 0.75]; 4];
        assert_eq!(NormalEquations::new(4).solve(&start).unwrap(), start);
        let mut equations = NormalEquations::new(4);
        (0..4).for_each(|k| equations.add(&[(k, 1.0)], start[k]));
        assert_eq!(equations.solve(&start).unwrap(), start);
        assert!(NormalEquations::new(0).solve(&[]).unwrap().is_empty());
    }
}
