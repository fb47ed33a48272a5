//! Options: what parses, what is refused with which message, and what the help promises.

use super::*;

#[test]
fn the_definition_is_consistent() {
    Cli::command().debug_assert();
}

#[test]
fn each_command_shows_examples() {
    let command = Cli::command();
    for sub in command.get_subcommands() {
        assert!(
            sub.get_after_help()
                .unwrap()
                .to_string()
                .contains("Examples:"),
            "{}",
            sub.get_name()
        );
    }
    assert!(
        command
            .get_after_help()
            .unwrap()
            .to_string()
            .contains("Examples:")
    );
}

#[test]
fn the_examples_of_the_help_parse() {
    let command = Cli::command();
    let texts = command
        .get_subcommands()
        .map(|sub| sub.get_after_help().unwrap().to_string());
    let mut tried = 0;
    for text in texts.chain([command.get_after_help().unwrap().to_string()]) {
        for line in text
            .lines()
            .filter_map(|line| line.strip_prefix("  splatline"))
        {
            let options = line.split("      ").next().unwrap();
            parse(options).unwrap_or_else(|error| panic!("{options}: {error}"));
            tried += 1;
        }
    }
    assert!(tried > command.get_subcommands().count());
}

/// Scripts keep working: earlier names run the same command with the same options, and the short list has the new ones
/// alone.
#[test]
fn earlier_names_of_commands_are_the_same_commands() {
    for (earlier, now) in [
        (
            "model a.ply --set lanes=4 -o out",
            "simulate a.ply --set lanes=4 -o out",
        ),
        (
            "needs a.ply --max-error 0.01",
            "profile a.ply --max-error 0.01",
        ),
        (
            "explore a.ply --space s.toml --no-error -o out",
            "sweep a.ply --space s.toml --no-error -o out",
        ),
        (
            "--memory 100 explore guitar.ply --fps=60 --max-error 0.004 --set lanes=4",
            "--memory 100 optimize guitar.ply --fps=60 --max-error 0.004 --set lanes=4",
        ),
    ] {
        let [earlier, now] = [earlier, now].map(|line| parse(line).unwrap());
        assert_eq!(format!("{earlier:?}"), format!("{now:?}"));
    }
    let help = Cli::command().render_help().to_string();
    for name in ["simulate", "profile", "sweep", "optimize"] {
        assert!(help.contains(&format!("\n  {name} ")), "{help}");
    }
    for name in ["model", "needs", "explore"] {
        assert!(!help.contains(&format!("\n  {name} ")), "{help}");
    }
    let refused = parse("optimize random:9 --part xc7a100t").unwrap_err();
    assert_eq!(refused.kind(), ErrorKind::MissingRequiredArgument);
}

#[test]
fn negative_coordinates_parse() {
    let cli = parse(
        "render a.ply -o a.png --eye -1,2,-3.5 --target 0,-0.5,1e1 --up 0,-1,0 --light -1,-1,0",
    )
    .unwrap();
    let Some(Command::Render(options)) = cli.command else {
        panic!("not render")
    };
    assert_eq!(options.view.camera.eye, Some([-1.0, 2.0, -3.5]));
    assert_eq!(options.view.camera.target, Some([0.0, -0.5, 10.0]));
    assert_eq!(options.view.camera.up, Some([0.0, -1.0, 0.0]));
    assert_eq!(options.view.splats.light, Some([-1.0, -1.0, 0.0]));
}

#[test]
fn defaults_are_those_of_the_help() {
    let Some(Command::Render(options)) = parse("render a.ply -o a.png").unwrap().command else {
        panic!("not render")
    };
    assert_eq!(options.drawing.engine, Engine::Fixed);
    let work = &options.drawing.work;
    assert_eq!(work.design, "standard24");
    assert_eq!(
        (options.drawing.depth, options.drawing.repeat),
        (Depth::Eight, 1)
    );
    assert_eq!(
        (work.traversal, work.compositing),
        (None, Compositing::FrontToBack)
    );
    assert!(options.view.splats.rules.is_none() && options.view.camera.size.is_none());
}

#[test]
fn values_that_make_no_sense_are_refused() {
    for options in [
        "--size 0x5",
        "--size 5x0",
        "--size 16385x1",
        "--size 5",
        "--size 5x-1",
        "--size x",
        "--size 1e3x2",
        "--eye 1,2 --target 0,0,0",
        "--eye 1,2,3,4 --target 0,0,0",
        "--eye 1,nan,3 --target 0,0,0",
        "--eye inf,0,0 --target 0,0,0",
        "--eye a,b,c --target 0,0,0",
        "--eye 1,2,3",
        "--target 1,2,3",
        "--orbit 30",
        "--orbit 30,90",
        "--zoom 0",
        "--background grey",
        "--background 1,1,2",
        "--alpha --background white",
        "--fov 0 --eye 1,2,3 --target 0,0,0",
        "--fov 180 --eye 1,2,3 --target 0,0,0",
        "--camera c.json --eye 1,2,3 --target 0,0,0",
        "--camera c.json --fov 40",
        "--camera c.json --orbit 30,0",
        "--rules gl",
        "--engine gpu",
        "--design fancy",
        "--depth 12",
        "--threads 0",
        "--repeat 0",
        "--threads -1",
        "--threads 99999",
        "--traversal zigzag",
        "--compositing sideways",
    ] {
        let error = parse(&format!("render a.ply -o a.png {options}")).expect_err(options);
        assert_eq!(error.exit_code(), 2, "{options}");
    }
    assert_eq!(
        parse("render a.ply").unwrap_err().kind(),
        ErrorKind::MissingRequiredArgument
    );
    assert_eq!(
        parse("modell a.ply").unwrap_err().kind(),
        ErrorKind::InvalidSubcommand
    );
}

#[test]
fn every_cause_is_named_once() {
    let cause = std::io::Error::other("disk full");
    let quoting = anyhow::Error::new(cause)
        .context("cannot write 'a': disk full")
        .context("render failed");
    assert_eq!(
        explain(&quoting),
        "render failed: cannot write 'a': disk full"
    );
    let plain = anyhow::anyhow!("disk full").context("cannot write 'a'");
    assert_eq!(explain(&plain), "cannot write 'a': disk full");
}

#[test]
fn usage_and_input_failures_are_told_apart() {
    let folder = Folder::new();
    let input = |line: &str| match folder.attempt(line) {
        Err(error) if !error.is::<UsageError>() => explain(&error),
        other => panic!("{line}: {other:?}"),
    };
    for (line, expected) in [
        (
            "render random:9 -o ./a.png --eye 0,0,0 --target 0,0,0",
            "--eye",
        ),
        (
            "footprints a.ply -o ./a.csv --engine exact",
            "no footprints",
        ),
        (
            "render a.ply -o ./a.png --engine float --traversal box",
            "no meaning",
        ),
    ] {
        let message = folder.usage(line);
        assert!(message.contains(expected), "{message}");
    }
    folder.write("file", "");
    for (line, expected) in [
        ("render missing.ply -o ./a.png", "missing.ply"),
        ("render a.ply -o ./no/such/a.png", "does not exist"),
        ("render a.ply -o ./", "is a folder"),
        ("compare a.ply -o ./file", "it is a file; name a folder"),
    ] {
        let message = input(line);
        assert!(message.contains(expected), "{message}");
    }
}

#[test]
fn surface_options_that_make_no_sense_are_refused() {
    let folder = Folder::new();
    let rules = folder.usage("render a.ply --as surface --rules ewa -o a.png");
    assert!(rules.starts_with("--rules has no meaning"), "{rules}");
    let exact = folder.usage("render a.ply --as surface --engine exact -o a.png");
    assert!(exact.contains("use fixed or float"), "{exact}");
    for line in [
        "--layers 2",
        "--edges",
        "--as surface --layers 5",
        "--as surface --z-threshold 0",
    ] {
        assert!(
            parse(&format!("render a.ply {line} -o a.png")).is_err(),
            "{line}"
        );
    }
}

/// Whoever reads the help of a command with many options finds them in groups that fit a screen.
#[test]
fn long_help_is_grouped_by_headings() {
    let mut grouped = 0;
    for command in Cli::command().get_subcommands() {
        let mut groups = std::collections::BTreeMap::<&str, usize>::new();
        for option in command.get_opts() {
            let heading = option.get_help_heading().unwrap_or("Options");
            *groups.entry(heading).or_default() += 1;
        }
        let largest = groups.values().copied().max().unwrap_or(0);
        assert!(largest <= 12, "{}: {groups:?}", command.get_name());
        if command.get_opts().count() > 12 {
            grouped += 1;
            assert!(groups.len() >= 3, "{}: {groups:?}", command.get_name());
        }
    }
    assert!(grouped >= 5, "{grouped} commands have many options");
}
