//! `splatline footprints`: where every splat lands, as CSV.
//!
//! One line per splat in the scene's order; a culled splat has its index and otherwise empty fields, so that lines can
//! be joined by number. Numbers are written with as many digits as it takes to read back the same double.

use super::args::FootprintsOptions;
use super::output::{Outputs, write};
use super::resolve::PlanRequest;
use super::say::{print_result, usage, warn};
use crate::plan::{Engine, FootprintLine};
use anyhow::Result;

const HEADING: &str = "index,u,v,depth,conic_a,conic_b,conic_c,x0,y0,x1,y1,opacity,cutoff\n";

pub fn run(options: &FootprintsOptions) -> Result<()> {
    let outputs = Outputs::default().file(Some(&options.output), &["csv"])?;
    let no_exact =
        || usage("--engine exact integrates along rays and has no footprints; use fixed or float");
    if options.engine == Engine::Exact {
        return Err(no_exact());
    }
    let mut prepared = PlanRequest::by_design(&options.view, &options.design).prepare()?;
    outputs.spare_inputs()?;
    if options.view.from.is_none() {
        prepared.plan.engine = options.engine;
    }
    let lines = match prepared.plan.engine {
        Engine::Fixed => {
            warn(&prepared.setup_warnings()?);
            prepared.fixed_footprints(&prepared.plan.entry)?
        }
        Engine::Float => {
            warn(&prepared.warnings);
            prepared.float_footprints()?
        }
        Engine::Exact => return Err(no_exact()),
        format => {
            let name = format.name();
            return Err(usage(format!(
                "--engine {name} has no footprints of its own; use fixed or float"
            )));
        }
    };
    write(&options.output, csv(&lines))?;
    let culled = lines.iter().filter(|line| line.is_none()).count();
    let (name, count) = (prepared.scene.name(), lines.len());
    print_result(&format!("{name}: {count} splats, {culled} culled\n"))
}

fn csv(lines: &[Option<FootprintLine>]) -> String {
    let mut text = String::from(HEADING);
    for (index, line) in lines.iter().enumerate() {
        text += &match line {
            None => format!("{index},,,,,,,,,,,,\n"),
            Some(FootprintLine {
                centre: [u, v],
                depth,
                conic: [a, b, c],
                bounds: [x0, y0, x1, y1],
                opacity,
                cutoff,
            }) => {
                let opacity = opacity.map_or(String::new(), |opacity| opacity.to_string());
                format!(
                    "{index},{u},{v},{depth},{a:e},{b:e},{c:e},{x0},{y0},{x1},{y1},{opacity},{cutoff}\n"
                )
            }
        };
    }
    text
}
