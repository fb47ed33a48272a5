//! `splatline footprints`: where every splat lands, as CSV.
//!
//! One line per splat in the scene's order; a culled splat has its index and otherwise empty fields, so that lines can
//! be joined by number. Numbers are written with as many digits as it takes to read back the same double.

use super::args::{Engine, FootprintsOptions};
use super::drawing::FootprintLine;
use super::setup::{View, check_folder_of, write};
use super::{Failure, engines, say};
use std::fmt::Write;

const HEADING: &str = "index,u,v,depth,conic_a,conic_b,conic_c,x0,y0,x1,y1\n";

pub fn run(options: &FootprintsOptions) -> Result<(), Failure> {
    check_folder_of(&options.output)?;
    if options.engine == Engine::Exact {
        let message = "--engine exact integrates along rays and has no footprints; use fixed or float";
        return Err(Failure::Usage(message.to_owned()));
    }
    let View { scene, camera, rules } = View::from_options(&options.view)?;
    let lines = match options.engine {
        Engine::Fixed => engines::fixed_footprints(&scene, &camera, &rules, &engines::design(&options.design)?)?,
        _ => engines::float_footprints(&scene, &camera, &rules)?,
    };
    write(&options.output, csv(&lines).as_bytes())?;
    let culled = lines.iter().filter(|line| line.is_none()).count();
    say(&format!("{}: {} splats, {culled} culled\n", scene.name, lines.len()));
    Ok(())
}

fn csv(lines: &[Option<FootprintLine>]) -> String {
    let mut text = String::from(HEADING);
    for (index, line) in lines.iter().enumerate() {
        // Writing to a String cannot fail.
        let _ = match line {
            None => writeln!(text, "{index},,,,,,,,,,"),
            Some(FootprintLine { centre: [u, v], depth, conic: [a, b, c], bounds: [x0, y0, x1, y1] }) => {
                writeln!(text, "{index},{u},{v},{depth},{a:e},{b:e},{c:e},{x0},{y0},{x1},{y1}")
            }
        };
    }
    text
}
