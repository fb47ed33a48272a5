//! Opens a page and keeps screenshots of it:
//! `splatline-browser PAGE.html PREFIX [WIDTHxHEIGHT[d]...] [--eval EXPRESSION]`.

use anyhow::{Context, Result};
use splatline_browser::Browser;
use std::path::Path;

fn main() -> Result<()> {
    let mut arguments = std::env::args().skip(1);
    let page = arguments.next().context("which page?")?;
    let prefix = arguments
        .next()
        .context("how do screenshots' names begin?")?;
    let folder = std::env::temp_dir().join(format!("splatline-browser-{}", std::process::id()));
    std::fs::create_dir_all(&folder)?;
    let mut browser = Browser::start(&folder)?;
    browser.screen(1300, 900, false)?;
    browser.open(
        Path::new(&page),
        "document.readyState === 'complete' && (!window.splatline || document.body.dataset.ready)",
    )?;
    while let Some(argument) = arguments.next() {
        if argument == "--eval" {
            let expression = arguments.next().context("--eval needs an expression")?;
            let before = browser.processor_seconds()?;
            println!("{}", browser.evaluate(&expression)?);
            println!("  {:.2} s", browser.processor_seconds()? - before);
            continue;
        }
        let (size, dark) = match argument.strip_suffix('d') {
            Some(size) => (size, true),
            None => (argument.as_str(), false),
        };
        let (width, height) = size.split_once('x').context("sizes are WIDTHxHEIGHT")?;
        browser.screen(width.parse()?, height.parse()?, dark)?;
        std::thread::sleep(std::time::Duration::from_millis(700));
        browser.screenshot(Path::new(&format!("{prefix}{argument}.png")))?;
    }
    for complaint in &browser.complaints {
        println!("complaint: {complaint}");
    }
    drop(browser);
    let _ = std::fs::remove_dir_all(&folder);
    Ok(())
}
