use super::*;
use crate::tests::changed;
use splatline::format::{Classic8, Deep32, Lean18, Standard24};

fn area(widths: &Widths, config: &Config, family: Family) -> Area {
    estimate(widths, Traversal::Spans, config, &family.calibration())
}

#[test]
fn designs_are_ranked_by_their_widths() {
    for family in Family::ALL {
        let widths = [
            Classic8::WIDTHS,
            Lean18::WIDTHS,
            Standard24::WIDTHS,
            Deep32::WIDTHS,
        ];
        let areas = widths.map(|widths| area(&widths, &Config::default(), family).weight);
        assert!(
            areas.is_sorted() && areas[3] > 1.5 * areas[0],
            "{family:?}: {areas:?}"
        );
    }
}

#[test]
fn more_of_anything_is_never_smaller() {
    for family in Family::ALL {
        let base = area(&Standard24::WIDTHS, &Config::default(), family);
        let changes = "lanes=2 raster_units=2 rows_at_once=4 row_fifo=64 tile_width=64 setup_units=2 \
                       packet_fifo=512 pixel_termination=skip";
        for words in changes.split(' ') {
            let config = changed(Config::default(), words);
            let more = area(&Standard24::WIDTHS, &config, family);
            // Two banks of a tile may lie in the same blocks as one; a queue of twice the places in the same cells.
            let fits = family == Family::Ice40 && words == "row_fifo=64";
            assert!(
                more.weight > base.weight || fits && more.weight == base.weight,
                "{family:?}: {words}"
            );
        }
    }
}

#[test]
fn intervals_share_multipliers() {
    let base = area(&Standard24::WIDTHS, &Config::default(), Family::Xilinx7);
    for words in [
        "splat_cycles=3",
        "row_cycles=4",
        "blend_interval=3",
        "setup_interval=8",
    ] {
        let config = changed(Config::default(), words);
        let fewer = area(&Standard24::WIDTHS, &config, Family::Xilinx7);
        let dsps = |area: &Area| area.raster.dsps + area.around.dsps;
        assert!(dsps(&fewer) < dsps(&base), "{words}");
    }
}

#[test]
fn products_are_tiled_as_synthesis_does() {
    let xilinx = Family::Xilinx7.calibration();
    assert_eq!(xilinx.tiles([17, 18]), 1);
    // Signed multipliers of 18 bits hold 17 unsigned ones.
    assert_eq!(xilinx.tiles([18, 18]), 2);
    assert_eq!(xilinx.tiles([64, 16]), 4);
    let ecp5 = Family::Ecp5.calibration();
    assert_eq!(ecp5.tiles([18, 18]), 1);
    // A part of one bit takes gates, one of up to four additions.
    assert_eq!(ecp5.tiles([19, 19]), 1);
    assert_eq!(ecp5.tiles([26, 20]), 2);
    assert_eq!(ecp5.tiles([26, 23]), 4);
}

#[test]
fn prices_can_be_replaced_and_misspellings_are_told() {
    let text = "family = \"ecp5\"\nluts_per_dsp = 7.0\n[luts.lane]\nper_bit = 9.0\n";
    let own = Calibration::from_toml("c.toml", text).unwrap();
    let base = Family::Ecp5.calibration();
    assert_eq!((own.luts_per_dsp, own.luts.lane.per_bit), (7.0, 9.0));
    assert_eq!(own.luts.lane.at_zero, base.luts.lane.at_zero);
    assert_eq!(own.flip_flops, base.flip_flops);
    let usual = Calibration::from_toml("c.toml", "").unwrap();
    assert_eq!(usual, Calibration::default());
    for wrong in [
        "lut_overhed = 1.0",
        "family = \"spartan\"",
        "[luts]\nlanes = 1.0",
    ] {
        let problem = Calibration::from_toml("c.toml", wrong).unwrap_err();
        assert!(problem.contains("c.toml"), "{problem}");
    }
}

#[test]
fn the_estimate_of_a_machine_is_that_of_its_circuits() {
    let widths = Lean18::WIDTHS;
    for line in synthesis::synthesised() {
        let synthesis::SynthesisedPart::Lanes(lanes) = line.part else {
            continue;
        };
        if line.widths != widths {
            continue;
        }
        let config = changed(Config::primitive(lanes), "raster_units=3");
        let three = area(&widths, &config, line.family).raster;
        let error = three.worst_error(&(line.fabric * 3));
        assert!(error < 0.1, "{:?}, {lanes} lanes: {three}", line.family);
    }
}
