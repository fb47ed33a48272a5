//! Options: what parses, what is refused with which message, and what the help promises.

use super::*;

#[test]
fn the_definition_is_consistent() {
    Cli::command().debug_assert();
}

#[test]
fn each_command_shows_examples_that_parse() {
    let command = Cli::command();
    let mut tried = 0;
    for of in command.get_subcommands().chain([&command]) {
        let text = of.get_after_help().unwrap().to_string();
        assert!(text.contains("Examples:"), "{}", of.get_name());
        let lines = text.lines();
        for line in lines.filter_map(|line| line.strip_prefix("  splatline")) {
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
    for (name, now, options) in [
        ("model", "simulate", "a.ply --set lanes=4 -o out"),
        ("needs", "profile", "a.ply --max-error 0.01"),
        ("explore", "sweep", "a.ply --space s.toml --no-error -o out"),
        (
            "--memory 100 explore",
            "--memory 100 optimize",
            "a.ply --fps=60 --max-error 0.004",
        ),
    ] {
        let parsed = [name, now].map(|name| parse(&format!("{name} {options}")).unwrap());
        let [earlier, now] = parsed.map(|cli| format!("{cli:?}"));
        assert_eq!(earlier, now);
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
