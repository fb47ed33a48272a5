//! The sweep as one HTML file: cycles against error and cycles against area, every point labelled under the pointer,
//! and by a script a table to sort, filters, a scatter of any two columns and parallel axes.
//!
//! Nothing comes from the network. The two charts and the list of the front stand without the script; labels are SVG
//! titles. Axes lie as in the report: faster is left and better is up, so that less error and less area are up.

use super::front::{Candidate, front};
use super::table::{RESULTS, ResultTable};
use crate::report::chart::{Axis, Chart};
use crate::report::html::escape;
use crate::report::labels::Rectangle;
use crate::report::shell::Shell;
use serde::Serialize;

/// The page of all points and of those with results; `note` is what the area is an estimate of.
pub fn page(title: &str, note: &str, table: &ResultTable, candidates: &[Candidate]) -> String {
    let front = front(candidates);
    let count = format!(
        "{} points, {} on the front of error, cycles, area and energy (filled).",
        candidates.len(),
        front.len()
    );
    let mut charts = String::new();
    match candidates {
        // A sweep that measures no error leaves its column empty, which reads as 0.
        all if all.iter().all(|c| c.rms == 0.0) => charts.push_str("<p>No errors to show.</p>\n"),
        [first, others @ ..] if others.iter().all(|other| other.rms == first.rms) => {
            charts += &format!(
                "<p>All points have the same error, {:.3e} rms in units of 1.0.</p>\n",
                first.rms
            );
        }
        _ => {
            let name = "error (rms, units of 1.0), less is up";
            charts += &chart(candidates, &front, name, |c| c.rms);
        }
    }
    let name = "area (all resources, in LUTs), less is up";
    charts += &chart(candidates, &front, name, |c| c.area);
    let mut plain = String::new();
    for candidate in &front {
        plain += &format!("<li>{}</li>\n", escape(&candidate.label));
    }
    let facts = format!(
        "<p class=\"facts\">{count} As in the report, up is better and left is faster: the best corner is the upper left. Point at a mark for its \
         settings and results.</p>\n<p class=\"facts\">Estimate of {}.</p>\n",
        escape(note)
    );
    let body = format!(
        "<section class=\"charts still\">\n{charts}</section>\n{}\
         <section id=\"plain\"><h2>The front, fastest first</h2><ol>\n{plain}</ol></section>\n",
        include_str!("front.html")
    );
    let scripts = format!(
        "<script type=\"application/json\" id=\"points\">{}</script>\n<script>\n{}</script>\n",
        points(table, candidates, &front),
        include_str!("front.js")
    );
    let product = "splatline: a sweep over designs and machines";
    let mut shell = Shell::still(product, title, &facts, &body);
    shell.scripts = &scripts;
    shell.html()
}

/// What the page's script reads.
#[derive(Serialize)]
struct PointsData<'a> {
    columns: &'a [String],
    axes: Vec<&'a str>,
    rows: Vec<&'a [String]>,
    front: Vec<usize>,
}

/// The table as the page's script reads it, without the rows' digests.
fn points(table: &ResultTable, candidates: &[Candidate], front: &[&Candidate]) -> String {
    let shown = table.heading.len().saturating_sub(1);
    let columns = &table.heading[..shown];
    let is_axis = |name: &&str| *name != "point" && RESULTS.iter().all(|(other, _)| other != name);
    let axes: Vec<&str> = columns.iter().map(String::as_str).filter(is_axis).collect();
    let row = |candidate: &Candidate| table.rows.get(&candidate.point)?.get(..shown);
    let rows: Vec<&[String]> = candidates.iter().filter_map(row).collect();
    let front: Vec<usize> = front.iter().map(|candidate| candidate.point).collect();
    let data = PointsData {
        columns,
        axes,
        rows,
        front,
    };
    // Text and numbers have a JSON form.
    let text = serde_json::to_string(&data).unwrap_or_default();
    text.replace('<', "\\u003c")
}

fn chart(
    candidates: &[Candidate],
    front: &[&Candidate],
    name: &str,
    of: fn(&Candidate) -> f64,
) -> String {
    let frame = Rectangle::new([66.0, 34.0], [676.0, 336.0]);
    let cycles = candidates.iter().map(|c| c.cycles);
    let x = Axis::of_values(cycles, 1.0, frame.across());
    // Less is better: up, as in the report.
    let ends = [frame.top, frame.top + frame.height];
    let y = Axis::of_values(candidates.iter().map(of), 1.0, ends);
    let mut chart = Chart::new(760.0, 420.0, &format!("cycles against {name}"));
    chart.columns(&frame, &x, &x.ticks(12));
    chart.rows(&frame, &y, &y.ticks(12));
    chart.names(&frame, "simulated cycles", name);
    let on_front = |candidate: &Candidate| front.iter().any(|other| other.point == candidate.point);
    let (front, others): (Vec<_>, Vec<_>) = candidates.iter().partition(|one| on_front(one));
    // The front lies above the others.
    let classed = others.into_iter().map(|one| (one, 3.5, ""));
    for (candidate, radius, class) in
        classed.chain(front.into_iter().map(|one| (one, 5.0, "front")))
    {
        let attributes = format!("class=\"point {class}\" data-point=\"{}\"", candidate.point);
        let place = (x.at(candidate.cycles), y.at(of(candidate)));
        let words = candidate.label.replace(", ", "\n");
        chart.disc(place, radius, &attributes, &words);
    }
    chart.finish()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shown(title: &str, note: &str, candidates: &[Candidate]) -> String {
        page(title, note, &ResultTable::default(), candidates)
    }

    /// What the page shows without its script.
    fn still(page: &str) -> &str {
        page.split_once("</section>").map_or(page, |parts| parts.0)
    }

    fn candidate(point: usize, rms: f64, cycles: f64, area: f64) -> Candidate {
        Candidate {
            point,
            rms,
            cycles,
            area,
            energy: 1.0,
            label: format!("p <{point}>"),
        }
    }

    #[test]
    fn less_is_up() {
        let all = [(0, 1e-5), (1, 1e-2)].map(|(point, rms)| candidate(point, rms, 1e6, 1e4));
        let page = shown("t", "", &all);
        let height = |point: &str| -> f64 {
            let mut circles = page.split("<circle");
            let circle = circles.find(|part| part.contains(point)).unwrap();
            let (_, rest) = circle.split_once("cy=\"").unwrap();
            rest.split_once('"').unwrap().0.parse().unwrap()
        };
        assert!(height("data-point=\"0\"") < height("data-point=\"1\""));
    }

    #[test]
    fn every_point_has_its_label_and_text_is_escaped() {
        let all = [
            candidate(0, 1e-3, 1e6, 5e3),
            candidate(1, 0.0, 2e6, 9e3),
            candidate(2, 1e-2, 3e6, 9e3),
        ];
        let page = shown("a & b", "area < all", &all);
        assert_eq!(still(&page).matches("<circle").count(), 6);
        assert_eq!(still(&page).matches("<svg").count(), 2);
        assert!(!still(&page).contains("NaN"));
        for words in [
            "p &lt;2&gt;",
            "a &amp; b",
            "Estimate of area &lt; all.",
            "3 points, 2 on the front",
            // A list and not a table, which would have to say what its columns are.
            "<ol>\n<li>p &lt;0&gt;</li>\n",
        ] {
            assert!(page.contains(words), "{words}");
        }
        let tables = ["<table", "<table id=\"table\">"].map(|tag| page.matches(tag).count());
        assert_eq!(tables[0], tables[1]);
    }

    #[test]
    fn an_error_that_all_points_share_is_a_sentence() {
        let all = [(1, 2e6, 7e4), (2, 3e6, 14e4)];
        let page = shown(
            "t",
            "",
            &all.map(|(point, cycles, area)| candidate(point, 2e-6, cycles, area)),
        );
        assert!(page.contains("same error, 2.000e-6"));
        assert_eq!(still(&page).matches("<svg").count(), 1);
        assert!(page.contains(">90k<"), "a short axis has all its digits");
    }
}
