//! The report's forms: round trip, no infinity in JSON, nothing external in the page, the text table as a snapshot.

pub mod sample;

use super::error_map::ErrorMap;
use super::scale::ErrorScale;
use super::*;
use crate::picture::Picture;
use proptest::prelude::*;

fn page(report: &Report, fixed: &Picture, float: &Picture) -> String {
    html::page(report, fixed, float, &ErrorMap::new(fixed, float)).unwrap()
}

/// A page's policy forbids it to load anything, and it does not ask to.
pub fn loads_nothing(page: &str) {
    assert!(page.contains("default-src 'none'"));
    let loading = "http:|https:|url(|@import|<script src|<link|<iframe|fetch(";
    for outside in loading.split('|') {
        assert!(!page.contains(outside), "the page holds {outside}");
    }
}

#[test]
fn json_has_the_keys_that_scripts_read() {
    let (fixed, float) = sample::pictures(40, 30);
    let value = serde_json::to_value(sample::report(&fixed, &float)).unwrap();
    let keys = "
        /design name
        /scene name splats skipped/non_finite culled/outside
        /error/rgb psnr_db max_abs bias ssim covered/pixels covered/psnr_db covered/bias covered/ssim
        /error/alpha psnr_db
        /error_map limit knee magnification
        /warnings 0
        /pixels covered visited
        /host setup_s sort_s raster_s total_s repeat
        /table/0 design traversal error/psnr_db visited covered visited_per_covered host/total_s
        /camera world_to_camera/15
        /rules name";
    for (object, keys) in keys
        .trim()
        .lines()
        .filter_map(|line| line.trim().split_once(' '))
    {
        for key in keys.split(' ') {
            let pointer = format!("{object}/{key}");
            assert!(value.pointer(&pointer).is_some(), "{pointer} is missing");
        }
    }
    assert!(value.get("cycles").is_some() && value.get("pace").is_some());
    assert!(value["cycles"].is_null());
}

#[test]
fn json_round_trips_and_identical_pictures_are_null_in_it() {
    let (fixed, float) = sample::pictures(40, 30);
    let reports = [&fixed, &float].map(|picture| sample::report(picture, &float));
    let texts = reports.each_ref().map(|report| report.to_json().unwrap());
    for (text, report) in texts.iter().zip(&reports) {
        assert_eq!(serde_json::from_str::<Report>(text).unwrap(), *report);
    }
    let identical: serde_json::Value = serde_json::from_str(&texts[1]).unwrap();
    assert!(identical["error"]["rgb"]["psnr_db"].is_null());
    assert_eq!(identical["error"]["rgb"]["identical"], true);
}

#[test]
fn medians_are_taken_field_by_field() {
    let runs: Vec<HostTimes> = [3.0, 1.0, 2.0].iter().map(|&t| sample::times(t)).collect();
    let median = HostTimes::median_of(&runs);
    assert_eq!(
        (median.total_s, median.setup_s, median.repeat),
        (2.0, 0.4, 3)
    );
    assert_eq!(HostTimes::median_of(&runs[..2]).total_s, 2.0);
    assert_eq!(HostTimes::median_of(&[]).total_s, 0.0);
}

#[test]
fn nothing_covered_gives_no_ratio() {
    let row = ReportRow {
        visited_per_covered: PixelCounts::default().ratio(),
        ..sample::rows()[0].clone()
    };
    assert_eq!(row.visited_per_covered, None);
    assert!(table::plain(&[row]).contains(" - "));
}

#[test]
fn the_text_table_is_aligned() {
    let expected = "\
design    traversal  PSNR dB  max error     p99     bias     SSIM    FLIP  PSNR cov  bias cov  SSIM cov     visited  vis/cov  setup ms  sort ms  raster ms  total ms  Mcycles
--------  ---------  -------  ---------  ------  -------  -------  ------  --------  --------  --------  ----------  -------  --------  -------  ---------  --------  -------
classic8  box          32.41     1.8e-1  7.4e-2  -1.9e-2  0.92812  9.6e-3     28.91   -4.2e-2   0.85624  46 677 771     2.56      82.4     20.6      309.0     412.0   51.678
classic8  spans        32.52     1.8e-1  7.3e-2  -1.9e-2  0.92902  9.5e-3     29.02   -4.2e-2   0.85804  18 931 002     1.04      61.0     15.2      228.8     305.0   23.931
lean18    box          55.13     1.3e-2  5.4e-3  -4.1e-5  0.99474  7.0e-4     51.63   -9.0e-5   0.98949  46 677 771     2.56      86.2     21.6      323.2     431.0   51.678
";
    assert_eq!(table::plain(&sample::rows()[..3]), expected);
}

#[test]
fn the_page_is_one_file_without_any_address() {
    let (fixed, float) = sample::pictures(64, 48);
    let page = page(&sample::report(&fixed, &float), &fixed, &float);
    // base64 may hold two slashes, so pictures and numbers are left out.
    let text: String = page
        .split("src=\"data:")
        .map(|part| part.split_once("\">").map_or(part, |p| p.1))
        .collect();
    let (before, packed) = text.split_once("id=\"values\">").unwrap();
    let text = before.to_owned() + packed.split_once("</script>").unwrap().1;
    assert!(!text.contains("//"), "the page holds //");
    loads_nothing(&text);
    assert_eq!(page.matches("<img").count(), 3);
    assert_eq!(page.matches("src=\"data:image/png;base64,iVBOR").count(), 3);
    let still = page.split("<script").next().unwrap();
    assert_eq!(still.matches("<tr").count(), 1 + 3 + 9);
    assert_eq!(
        still
            .matches("<tr class=\"chosen\" data-row=\"5\">")
            .count(),
        1
    );
    // Each row has a place on both sizes of both plots.
    assert_eq!(
        still
            .matches("<circle class=\"place\" data-row=\"5\"")
            .count(),
        4
    );
}

#[test]
fn one_design_has_a_row_and_no_plot() {
    let (fixed, float) = sample::pictures(16, 16);
    let mut report = sample::report(&fixed, &float);
    report.table.truncate(1);
    let page = page(&report, &fixed, &float);
    assert!(!page.contains("class=\"plot\"") && page.contains("All designs"));
}

#[test]
fn the_scale_ends_at_a_percentile_and_counts_what_is_beyond() {
    let differences: Vec<f64> = (1..=1000).map(f64::from).chain([-1e6, 0.0]).collect();
    let scale = ErrorScale::of(&differences, 99.9);
    assert_eq!(
        (scale.limit, scale.outliers, scale.largest),
        (1000.0, 1, 1e6)
    );
    assert_eq!(scale.position(-1000.0), -1.0);
    assert_eq!(
        error_map::colour(scale.position(-1e6)),
        error_map::colour(-1.0)
    );
    let whole = ErrorScale::of(&differences, 100.0);
    assert_eq!((whole.limit, whole.outliers), (1e6, 0));
    assert_eq!(ErrorScale::of(&[0.0; 3], 99.9), ErrorScale::default());
}

#[test]
fn the_page_survives_odd_names_and_identical_pictures() {
    let (_, float) = sample::pictures(5, 3);
    let mut report = sample::report(&float, &float);
    report.scene.name = "<script>alert('x')</script> & \"co\"".to_owned();
    report.table.clear();
    let page = page(&report, &float, &float);
    assert!(!page.contains("<script>alert"));
    assert!(page.contains("&lt;script&gt;"));
    assert!(page.contains("the pictures are identical"));
}

#[test]
fn the_error_map_is_signed_and_the_largest_error_fills_the_scale() {
    let float = Picture {
        width: 3,
        height: 1,
        pixels: vec![[0.5; 4]; 3],
    };
    let mut fixed = float.clone();
    fixed.pixels[0] = [0.5, 0.4, 0.55, 0.0];
    fixed.pixels[2][2] = 0.52;
    let map = ErrorMap::new(&fixed, &float);
    assert!((map.scale.limit - 0.1).abs() < 1e-12);
    assert!((map.differences[0] + 0.1).abs() < 1e-12);
    assert!((map.differences[2] - 0.02).abs() < 1e-12);
    let rgb = map.to_rgb();
    assert_eq!(rgb.bytes[0..3], error_map::colour(-1.0));
    assert_eq!(rgb.bytes[3..6], error_map::colour(0.0));
    assert!(rgb.bytes[6] > rgb.bytes[8], "brighter is warm");
    assert_eq!(rgb.to_png().unwrap()[1..4], *b"PNG");
}

#[test]
fn stray_pixels_do_not_hide_the_rest_and_the_scale_is_invertible() {
    let float = Picture {
        width: 100,
        height: 10,
        pixels: vec![[0.5; 4]; 1000],
    };
    let mut fixed = float.clone();
    for (index, pixel) in fixed.pixels.iter_mut().enumerate() {
        pixel[0] += if index == 7 { -0.1 } else { 1e-5 };
    }
    let map = ErrorMap::new(&fixed, &float);
    assert_eq!(map.scale.position(map.differences[7]), -1.0);
    assert!(
        map.scale.position(1e-5) > 0.15,
        "{}",
        map.scale.position(1e-5)
    );
    for difference in [-0.1, -1e-7, 0.0, 1e-5, 0.03] {
        assert!(
            (map.scale.difference_at(map.scale.position(difference)) - difference).abs() < 1e-12
        );
    }
}

#[test]
fn the_scale_grows_in_lightness_on_both_sides() {
    let lightness = |relative: f64| {
        error_map::colour(relative)
            .iter()
            .map(|&c| u32::from(c))
            .sum::<u32>()
    };
    for step in 0..100 {
        let (nearer, farther) = (f64::from(step) / 100.0, f64::from(step + 1) / 100.0);
        assert!(lightness(nearer) <= lightness(farther));
        assert!(lightness(-nearer) <= lightness(-farther));
    }
}

#[test]
fn the_plot_names_every_design_once_and_both_traversals() {
    let svg = plot::svg(&sample::rows(), plot::Across::HostTime, 760.0, 440.0);
    for name in ["classic8", "lean18", "standard24", "deep32", "box", "spans"] {
        let labels = svg.matches(&format!(">{name}</text>")).count();
        assert_eq!(labels, 1, "{name}\n{svg}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    #[test]
    fn no_figures_break_plot_or_table(
        figures in proptest::collection::vec(
            (proptest::option::of(-50.0..400.0f64), 0.0..1e5f64, any::<u64>(), any::<u64>()), 0..12),
        width in 1.0..900.0f64, height in 1.0..700.0f64,
    ) {
        let rows: Vec<ReportRow> = figures.iter().enumerate().map(|(index, &(psnr_db, total_s, visited, covered))| {
            let mut row = sample::rows()[index % 8].clone();
            row.error.psnr_db = psnr_db.unwrap_or(f64::INFINITY);
            row.error.identical = psnr_db.is_none();
            row.host.total_s = total_s;
            row.visited = visited;
            row.covered = covered;
            row
        }).collect();
        prop_assert!(plot::svg(&rows, plot::Across::Cycles, width, height).contains("</svg>"));
        prop_assert_eq!(table::plain(&rows).lines().count(), rows.len() + 2);
    }
}
