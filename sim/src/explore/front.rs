//! The Pareto front of a sweep: points that no other point beats in error, cycles, area and energy at once.

use super::table::{ROW_DIGEST, ResultTable};

/// A finished point as far as the front and the plot need it.
#[derive(Clone, Debug, PartialEq)]
pub struct Candidate {
    /// Number in the sweep.
    pub point: usize,
    /// Root mean square error of red, green and blue; 0 where errors were left out.
    pub rms: f64,
    /// All cycles.
    pub cycles: f64,
    /// All resources, in look-up tables.
    pub area: f64,
    /// mJ a picture.
    pub energy: f64,
    /// Every axis and result, for people: `lanes 4, layout rows, ...`.
    pub label: String,
}

/// The table's points that have results.
pub fn candidates(table: &ResultTable) -> Vec<Candidate> {
    let places = ["rms", "cycles", "area", "energy_mj"].map(|name| table.column(name));
    let [Some(rms), Some(cycles), Some(area), Some(energy)] = places else {
        return Vec::new();
    };
    let candidate = |(point, fields): (&usize, &Vec<String>)| {
        let named = table.heading.iter().zip(fields);
        let named = named.filter(|(name, value)| !value.is_empty() && *name != ROW_DIGEST);
        let label: Vec<String> = named
            .map(|(name, value)| format!("{name} {value}"))
            .collect();
        Some(Candidate {
            point: *point,
            rms: fields.get(rms)?.parse().unwrap_or(0.0),
            cycles: fields.get(cycles)?.parse().ok()?,
            area: fields.get(area)?.parse().ok()?,
            energy: fields.get(energy)?.parse().ok()?,
            label: label.join(", "),
        })
    };
    table.rows.iter().filter_map(candidate).collect()
}

/// The points of the front, by cycles. Of equal points the first counts.
pub fn front(candidates: &[Candidate]) -> Vec<&Candidate> {
    let mut sorted: Vec<&Candidate> = candidates.iter().collect();
    sorted.sort_by(|a, b| {
        let by = |of: fn(&Candidate) -> f64| of(a).total_cmp(&of(b));
        by(|c| c.cycles)
            .then(by(|c| c.rms))
            .then(by(|c| c.area))
            .then(by(|c| c.energy))
            .then(a.point.cmp(&b.point))
    });
    // Sorted by cycles, so only points before can beat one; and if any does, one of the front does.
    let mut front: Vec<&Candidate> = Vec::new();
    for candidate in sorted {
        let beats = |other: &&Candidate| {
            other.rms <= candidate.rms
                && other.area <= candidate.area
                && other.energy <= candidate.energy
        };
        if !front.iter().any(beats) {
            front.push(candidate);
        }
    }
    front
}

/// The table's lines of the front.
pub fn front_table(table: &ResultTable, front: &[&Candidate]) -> ResultTable {
    let rows = front
        .iter()
        .filter_map(|candidate| Some((candidate.point, table.rows.get(&candidate.point)?.clone())));
    ResultTable {
        heading: table.heading.clone(),
        rows: rows.collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn beats(a: &Candidate, b: &Candidate) -> bool {
        a.rms <= b.rms
            && a.cycles <= b.cycles
            && a.area <= b.area
            && a.energy <= b.energy
            && (a.rms < b.rms || a.cycles < b.cycles || a.area < b.area || a.energy < b.energy)
    }

    proptest! {
        #[test]
        fn the_front_is_what_nothing_beats(values in proptest::collection::vec((0u8..5, 0u8..5, 0u8..5, 0u8..4), 0..40)) {
            let all: Vec<Candidate> = (0..).zip(values).map(|(point, (rms, cycles, area, energy))| Candidate {
                point, rms: rms.into(), cycles: cycles.into(), area: area.into(), energy: energy.into(), label: String::new(),
            }).collect();
            let front = front(&all);
            for candidate in &all {
                let beaten = all.iter().any(|other| beats(other, candidate));
                let equal = front.iter().any(|k| (k.rms, k.cycles, k.area, k.energy) == (candidate.rms, candidate.cycles, candidate.area, candidate.energy));
                prop_assert_eq!(equal, !beaten, "{:?}", candidate);
            }
        }
    }
}
