//! Parsing of options, and the commands from options to files against the synthetic engines.

use super::args::*;
use super::*;
use clap::CommandFactory;
use clap::error::ErrorKind;
use splatline_sim::report::Report;
use std::path::Path;

fn parse(line: &str) -> Result<Cli, clap::Error> {
    Cli::try_parse_from(std::iter::once("splatline").chain(line.split_whitespace()))
}

fn run_line(line: &str) -> Result<(), Failure> {
    dispatch(parse(line).unwrap().command)
}

fn read_report(path: &Path) -> Report {
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

#[test]
fn the_definition_is_consistent() {
    Cli::command().debug_assert();
}

#[test]
fn only_commands_that_exist_are_listed_and_each_shows_examples() {
    let command = Cli::command();
    let names: Vec<&str> = command.get_subcommands().map(|sub| sub.get_name()).collect();
    assert_eq!(names, ["render", "compare", "footprints"]);
    for sub in command.get_subcommands() {
        assert!(sub.get_after_help().unwrap().to_string().contains("Examples:"), "{}", sub.get_name());
    }
    assert!(command.get_after_help().unwrap().to_string().contains("Examples:"));
}

#[test]
fn the_examples_of_the_help_parse() {
    let command = Cli::command();
    let texts = command.get_subcommands().map(|sub| sub.get_after_help().unwrap().to_string());
    let mut tried = 0;
    for text in texts.chain([command.get_after_help().unwrap().to_string()]) {
        for line in text.lines().filter_map(|line| line.strip_prefix("  splatline")) {
            let options = line.split("      ").next().unwrap();
            parse(options).unwrap_or_else(|error| panic!("{options}: {error}"));
            tried += 1;
        }
    }
    assert_eq!(tried, 14);
}

#[test]
fn negative_coordinates_parse() {
    let cli = parse("render a.ply -o a.png --eye -1,2,-3.5 --target 0,-0.5,1e1 --up 0,-1,0 --light -1,-1,0").unwrap();
    let Some(Command::Render(options)) = cli.command else { panic!("not render") };
    assert_eq!(options.view.eye, Some(Vector([-1.0, 2.0, -3.5])));
    assert_eq!(options.view.target, Some(Vector([0.0, -0.5, 10.0])));
    assert_eq!(options.view.up, Some(Vector([0.0, -1.0, 0.0])));
    assert_eq!(options.view.light, Some(Vector([-1.0, -1.0, 0.0])));
}

#[test]
fn defaults_are_those_of_the_help() {
    let Some(Command::Render(options)) = parse("render a.ply -o a.png").unwrap().command else { panic!("not render") };
    assert_eq!(options.drawing.engine, Engine::Fixed);
    assert_eq!(options.drawing.design, DesignChoice::Named("standard24"));
    assert_eq!((options.drawing.depth, options.drawing.repeat), (8, 1));
    assert_eq!((options.drawing.traversal, options.drawing.compositing), (None, CompositingChoice::FrontToBack));
    assert!(options.view.rules.is_none() && options.view.size.is_none());
}

#[test]
fn values_that_make_no_sense_are_refused() {
    for options in [
        "--size 0x5", "--size 5x0", "--size 16385x1", "--size 5", "--size 5x-1", "--size x", "--size 1e3x2",
        "--eye 1,2 --target 0,0,0", "--eye 1,2,3,4 --target 0,0,0", "--eye 1,nan,3 --target 0,0,0",
        "--eye inf,0,0 --target 0,0,0", "--eye a,b,c --target 0,0,0", "--eye 1,2,3", "--target 1,2,3", "--fov 40",
        "--up 0,1,0", "--fov 0 --eye 1,2,3 --target 0,0,0", "--fov 180 --eye 1,2,3 --target 0,0,0",
        "--camera c.json --eye 1,2,3 --target 0,0,0", "--camera c.json --fov 40", "--rules gl", "--engine gpu",
        "--design fancy", "--depth 12", "--threads 0", "--repeat 0", "--threads -1", "--threads 99999",
        "--traversal zigzag", "--compositing sideways",
    ] {
        let error = parse(&format!("render a.ply -o a.png {options}")).expect_err(options);
        assert_eq!(error.exit_code(), 2, "{options}");
    }
    assert_eq!(parse("render a.ply").unwrap_err().kind(), ErrorKind::MissingRequiredArgument);
    assert_eq!(parse("model a.ply").unwrap_err().kind(), ErrorKind::InvalidSubcommand);
}

#[test]
fn compare_writes_all_files_and_all_designs() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("new/out");
    run_line(&format!("compare disc.ply --size 60x40 --repeat 3 -o {}", out.display())).unwrap();
    for name in ["fixed.png", "float.png", "error.png", "report.json", "report.html"] {
        assert!(out.join(name).is_file(), "{name}");
    }
    let report = read_report(&out.join("report.json"));
    assert_eq!(report.table.len(), 8);
    assert_eq!((report.engine.as_str(), report.reference.as_deref()), ("fixed", Some("float")));
    assert_eq!((report.design_name(), report.traversal.as_deref()), ("standard24", Some("spans")));
    assert_eq!((report.host.repeat, report.host.setup_s), (3, 0.001));
    assert_eq!(report.scene.skipped["non_finite"], 1);
    assert_eq!(report.scene.culled["near"], 1);
    let error = report.error.unwrap();
    assert!(error.rgb.bias < 0.0, "the stand-in truncates");
    let row = report.table.iter().find(|row| row.design == "standard24" && row.traversal == "spans").unwrap();
    assert_eq!(row.error, error.rgb);
}

#[test]
fn only_restricts_the_table_and_a_file_joins_it() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().display();
    run_line(&format!("compare disc.ply --size 30x30 --only --design lean18 --traversal box -o {out}")).unwrap();
    let report = read_report(&folder.path().join("report.json"));
    assert_eq!(report.table.len(), 1);
    assert_eq!((report.design_name(), report.traversal.as_deref()), ("lean18", Some("box")));

    run_line(&format!("compare disc.ply --size 30x30 --design mine12.toml --engine exact -o {out}")).unwrap();
    let report = read_report(&folder.path().join("report.json"));
    assert_eq!(report.table.len(), 10);
    assert_eq!((report.design_name(), report.reference.as_deref()), ("mine12", Some("exact")));
}

#[test]
fn render_writes_the_picture_and_a_report_without_errors() {
    let folder = tempfile::tempdir().unwrap();
    let (png, json) = (folder.path().join("a.png"), folder.path().join("a.json"));
    for (engine, design) in [("fixed", true), ("float", false)] {
        let line = format!("render disc.ply --engine {engine} --camera c.json -o {} --json {}", png.display(), json.display());
        run_line(&line).unwrap();
        let report = read_report(&json);
        assert_eq!((report.camera.width, report.camera.height), (40, 30));
        assert_eq!((report.error, report.table.len()), (None, 0));
        assert_eq!((report.pixels.is_some(), report.design.is_null()), (design, !design));
        assert_eq!(report.engine, engine);
    }
    assert!(png.is_file());
}

#[test]
fn footprints_are_csv_with_empty_fields_for_culled_splats() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("f.csv");
    run_line(&format!("footprints disc.ply --engine float --size 40x30 -o {}", path.display())).unwrap();
    let expected = "index,u,v,depth,conic_a,conic_b,conic_c,x0,y0,x1,y1\n\
                    0,20,15,5,1e-2,-0e0,1e-20,-3,0,17,12\n\
                    1,,,,,,,,,,\n";
    assert_eq!(std::fs::read_to_string(path).unwrap(), expected);
}

#[test]
fn the_demo_writes_its_report() {
    let folder = tempfile::tempdir().unwrap();
    demo::run_into(folder.path(), Size { width: 32, height: 32 }).unwrap();
    assert_eq!(read_report(&folder.path().join("report.json")).table.len(), 8);
}

#[test]
fn usage_and_input_failures_are_told_apart() {
    let usage = |line: &str| match run_line(line) {
        Err(Failure::Usage(message)) => message,
        other => panic!("{line}: {other:?}"),
    };
    let input = |line: &str| match run_line(line) {
        Err(Failure::Input(error)) => format!("{error:#}"),
        other => panic!("{line}: {other:?}"),
    };
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().display();
    assert!(usage(&format!("render a.ply -o {out}/a.png --eye 0,0,0 --target 0,0,0")).contains("same point"));
    assert!(usage(&format!("footprints a.ply -o {out}/a.csv --engine exact")).contains("no footprints"));
    assert!(usage(&format!("render a.ply -o {out}/a.png --engine float --traversal box")).contains("no meaning"));
    assert!(input(&format!("render missing.ply -o {out}/a.png")).contains("missing.ply"));
    assert!(input(&format!("render a.ply -o {out}/no/such/a.png")).contains("does not exist"));
    assert!(input(&format!("render a.ply -o {out}")).contains("is a folder"));
    std::fs::write(folder.path().join("file"), "").unwrap();
    assert!(input(&format!("compare a.ply -o {out}/file")).contains("cannot create"));
}
