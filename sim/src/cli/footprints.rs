//! `splatline footprints`: where every splat lands, as CSV.
//!
//! One line per splat in the scene's order; a culled splat has its index and otherwise empty fields, so that lines can
//! be joined by number. Numbers are written with as many digits as it takes to read back the same double.

use super::args::{Engine, FootprintsOptions};
use super::drawing::FootprintLine;
use super::engines::{self, Task};
use super::output::{self, write};
use super::setup::View;
use super::{Failure, say, warn};
use crate::design::DesignChoice;
use crate::rules::Compositing;
use std::fmt::Write;

const HEADING: &str = "index,u,v,depth,conic_a,conic_b,conic_c,x0,y0,x1,y1,cutoff\n";

pub fn run(options: &FootprintsOptions) -> Result<(), Failure> {
    let mut inputs = options.view.inputs();
    inputs.extend(output::design_file(&options.design));
    output::check(&options.output, &["csv"], &inputs)?;
    if options.engine == Engine::Exact {
        let message =
            "--engine exact integrates along rays and has no footprints; use fixed or float";
        return Err(Failure::Usage(message.to_owned()));
    }
    let view = View::from_options(&options.view)?;
    let View {
        scene,
        camera,
        rules,
        ..
    } = &view;
    // Footprints do not depend on the order of blending.
    let compositing = Compositing::FrontToBack;
    let task = Task {
        scene,
        camera,
        rules,
        compositing,
    };
    let lines = match options.engine {
        Engine::Fixed => {
            let design = DesignChoice::load(&options.design.0)?;
            warn(&engines::warnings(&view, &design));
            engines::fixed_footprints(task, &design)
        }
        _ => {
            warn(&view.warnings);
            engines::float_footprints(task)
        }
    };
    write(&options.output, csv(&lines).as_bytes())?;
    let culled = lines.iter().filter(|line| line.is_none()).count();
    say(&format!(
        "{}: {} splats, {culled} culled\n",
        scene.name,
        lines.len()
    ))?;
    Ok(())
}

fn csv(lines: &[Option<FootprintLine>]) -> String {
    let mut text = String::from(HEADING);
    for (index, line) in lines.iter().enumerate() {
        // Writing to a String cannot fail.
        let _ = match line {
            None => writeln!(text, "{index},,,,,,,,,,,"),
            Some(FootprintLine {
                centre: [u, v],
                depth,
                conic: [a, b, c],
                bounds: [x0, y0, x1, y1],
                cutoff,
            }) => {
                writeln!(
                    text,
                    "{index},{u},{v},{depth},{a:e},{b:e},{c:e},{x0},{y0},{x1},{y1},{cutoff}"
                )
            }
        };
    }
    text
}
