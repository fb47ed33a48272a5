//! The live page, the report and the sweep's page in Chromium: they are used as a reader uses them, and must complain
//! of nothing and load nothing.
//!
//! Pages are written by the `splatline` that lies beside the tests (`cargo build -p splatline-sim` makes it).
//! Screenshots of all of them, wide and narrow, light and dark, are left in `target/tmp/pages` for people to look at.

mod chromium;

use anyhow::{Context, Result, ensure};
use chromium::Browser;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::process::Command;

const READY: &str = "document.body && document.body.dataset.ready";

/// Screens of the screenshots.
const SCREENS: [(u32, u32, bool); 4] = [
    (1300, 900, false),
    (1300, 900, true),
    (420, 860, false),
    (420, 860, true),
];

/// Runs `splatline`.
fn splatline(line: &str, output: &Path) -> Result<()> {
    let tests = std::env::current_exe()?;
    let folder = tests.ancestors().nth(2).context("no target folder")?;
    let program = folder.join("splatline");
    ensure!(
        program.is_file(),
        "{} is missing: run `cargo build -p splatline-sim` first",
        program.display()
    );
    let done = Command::new(&program)
        .args(line.split(' '))
        .arg("-o")
        .arg(output)
        .output()?;
    let said = String::from_utf8_lossy(&done.stderr);
    ensure!(done.status.success(), "{line}: {said}");
    Ok(())
}

/// A browser with an empty profile, which goes when the test does.
fn browser() -> Result<(Browser, tempfile::TempDir)> {
    let folder = tempfile::tempdir()?;
    let mut browser = Browser::start(&folder.path().join("profile"))?;
    browser.screen(1300, 900, false)?;
    Ok((browser, folder))
}

/// Screenshots of the open page, and a check on every screen that nothing is wider than it.
fn look(browser: &mut Browser, name: &str) -> Result<()> {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("pages");
    std::fs::create_dir_all(&folder)?;
    for (width, height, dark) in SCREENS {
        browser.screen(width, height, dark)?;
        std::thread::sleep(std::time::Duration::from_millis(400));
        let tone = if dark { "dark" } else { "light" };
        browser.screenshot(&folder.join(format!("{name}-{width}-{tone}.png")))?;
        let wide = browser.number("document.documentElement.scrollWidth")?;
        ensure!(
            wide <= f64::from(width),
            "{name} is {wide} pixels wide on a screen of {width}"
        );
        // A table may be wider than the screen only inside of something that scrolls.
        let clipped = browser.number(
            "[...document.querySelectorAll('table')].filter(t => t.scrollWidth > innerWidth && !t.closest('.scroll')).length",
        )?;
        ensure!(clipped == 0.0, "{name}: {clipped} tables are clipped");
    }
    browser.screen(1300, 900, false)
}

fn no_complaints(browser: &Browser) -> Result<()> {
    ensure!(browser.complaints.is_empty(), "{:#?}", browser.complaints);
    Ok(())
}

#[test]
#[cfg_attr(
    not(has_chromium),
    ignore = "needs chromium (Debian: apt-get install chromium)"
)]
fn the_live_page_draws_the_hosts_bits_by_every_design() -> Result<()> {
    let (mut browser, folder) = browser()?;
    let page = folder.path().join("page.html");
    for design in ["classic8", "micro16", "lean18", "standard24", "deep32"] {
        for traversal in ["box", "spans"] {
            let by = format!("--design {design} --traversal {traversal}");
            splatline(&format!("page random:800:3 --size 200x150 {by}"), &page)?;
            browser.open(&page, READY)?;
            let same = browser.text("document.body.dataset.same")?;
            ensure!(same == "yes", "{design} by {traversal}: other bits");
        }
    }
    // Normalised kernels, and a scene cut off at a radial index.
    let deep = "page deep-stack --size 150x150 --rules ewa --kernel cubic";
    splatline(deep, &page)?;
    browser.open(&page, READY)?;
    let same = browser.text("document.body.dataset.same")?;
    ensure!(same == "yes", "deep-stack by ewa: other bits");
    no_complaints(&browser)
}

#[test]
#[cfg_attr(
    not(has_chromium),
    ignore = "needs chromium (Debian: apt-get install chromium)"
)]
fn the_live_page_answers() -> Result<()> {
    let (mut browser, folder) = browser()?;
    let page = folder.path().join("page.html");
    let scene = "random:2000 --size 256x256 --design lean18";
    splatline(&format!("page {scene}"), &page)?;
    browser.open(&page, READY)?;

    // Figures are those of the host's own comparison.
    let compared = folder.path().join("compared");
    splatline(&format!("compare {scene} --only"), &compared)?;
    let report = std::fs::read_to_string(compared.join("report.json"))?;
    let report: Value = serde_json::from_str(&report)?;
    let of_host = |field: &str| report["error"]["rgb"][field].as_f64().context("no figure");
    let before = browser.number("splatline.figures().psnr")?;
    let psnr = of_host("psnr_db")?;
    // The page's numbers of the scene are single precision: a few pixels at footprints' rims fall on the other side.
    ensure!(
        (before - psnr).abs() < 0.1,
        "page {before} dB, host {psnr} dB"
    );
    let visited = browser.number("splatline.figures().visited")?;
    let of_host = report["pixels"]["visited"].as_f64().context("no pixels")?;
    ensure!(
        (visited / of_host - 1.0).abs() < 1e-4,
        "page visits {visited}, host {of_host}"
    );

    // A slider dragged to the left makes the picture worse.
    let [x, y] = browser.middle("#width-alpha")?;
    let shown = browser.said("#width-alpha + output")?;
    browser.drag(&[[x, y], [x - 20.0, y], [x - 60.0, y]])?;
    let after = "Number(document.querySelector('#width-alpha + output').textContent)";
    let bits = browser.number(after)?;
    ensure!(bits < shown.parse::<f64>()?, "{bits} bits after {shown}");
    browser.wait(&format!("splatline.figures().psnr < {}", before - 6.0))?;
    let text = browser.number("Number(document.querySelector('#psnr').textContent)")?;
    ensure!(text < before - 6.0, "the page still says {text} dB");

    // Truncation darkens.
    browser.evaluate("splatline.choose('lean18')")?;
    browser.choose("#rounding", "1", "change")?;
    browser.wait("splatline.figures().bias < -1e-7")?;

    // Widths that exclude each other are refused in words.
    browser.evaluate("splatline.choose('standard24')")?;
    browser.choose("#rounding", "2", "change")?;
    browser.wait("document.querySelector('#times').textContent.startsWith('not drawn: ')")?;
    browser.evaluate("splatline.choose('lean18')")?;
    browser.wait("!document.querySelector('#times').textContent.startsWith('not drawn: ')")?;

    // A pixel is read, and the packet of its splat, every field of it.
    let [x, y] = browser.middle("#fixed")?;
    browser.mouse("mouseMoved", [x + 3.0, y + 5.0], false)?;
    browser.wait("document.querySelectorAll('#values tr').length === 4")?;
    let place = browser.said("#values th")?;
    let red = browser.said("#values tr:nth-child(2) td")?;
    let value = browser.text(&format!(
        "splatline.value(0, 0, ...'{place}'.match(/\\d+/g).map(Number)).toFixed(9)"
    ))?;
    ensure!(red == value, "{place}: shown {red}, drawn {value}");
    let fields = browser.count("#packet tr")?;
    ensure!(fields == 21.0, "{fields} lines of 20 fields and a heading");
    let bits = "[...document.querySelectorAll('#packet .bits')].map(e => e.textContent.replace(/[^01]/g, '').length).reduce((a, b) => a + b)";
    let bits = browser.number(bits)?;
    let said = browser.said("#picked")?;
    ensure!(said.contains(&format!("{bits} bits in")), "{bits}: {said}");

    // Dragging turns the scene, and the first view comes back bit for bit.
    browser.evaluate("splatline.choose('lean18')")?;
    let first = browser.text("splatline.settings.checksum")?;
    browser.wait(&format!("splatline.checksum() === '{first}'"))?;
    browser.drag(&[[x, y], [x + 30.0, y + 10.0], [x + 60.0, y + 20.0]])?;
    browser.wait(&format!("splatline.checksum() !== '{first}'"))?;
    browser.click("#home")?;
    browser.wait(&format!("splatline.checksum() === '{first}'"))?;
    browser.evaluate("document.querySelector('#fixed').dispatchEvent(new WheelEvent('wheel', {deltaY: -100, cancelable: true}))")?;
    browser.wait(&format!("splatline.checksum() !== '{first}'"))?;
    look(&mut browser, "live")?;
    no_complaints(&browser)
}

#[test]
#[cfg_attr(
    not(has_chromium),
    ignore = "needs chromium (Debian: apt-get install chromium)"
)]
fn the_report_answers() -> Result<()> {
    let (mut browser, folder) = browser()?;
    let out = folder.path().join("out");
    splatline("compare random:1500 --size 200x160 --design lean18", &out)?;
    browser.open(&out.join("report.html"), READY)?;

    // The pixel under the pointer, by each engine.
    let [x, y] = browser.middle("[data-layer=fixed]")?;
    browser.mouse("mouseMoved", [x, y], false)?;
    browser.wait("document.querySelectorAll('#pixel tr').length === 4")?;
    let read = "(() => { const n = [...document.querySelectorAll('#pixel tr')].map(r => [...r.cells].map(c => c.textContent)); \
        const [x, y] = n[0][0].match(/\\d+/g).map(Number); const v = report.values(); const at = y * 200 + x; \
        return n[1][1] === v.fixed[0][at].toFixed(5) && Math.abs(Number(n[1][1]) - Number(n[2][1]) - Number(n[3][1])) < 2e-5; })()";
    ensure!(browser.evaluate(read)? == json!(true), "a pixel's numbers");
    // They are those of the picture's file: 8 bits of it.
    let same = "(() => { const image = document.querySelector('[data-layer=fixed] img'); const c = document.createElement('canvas'); \
        [c.width, c.height] = [200, 160]; const g = c.getContext('2d'); g.drawImage(image, 0, 0); const d = g.getImageData(0, 0, 200, 160).data; \
        const v = report.values().fixed; return Math.max(...Array.from(v[1], (f, i) => Math.abs(f * 255 - d[4 * i + 1]))); })()";
    let apart = browser.number(same)?;
    ensure!(apart <= 0.51, "values and picture are {apart} steps apart");

    // Zoomed in step.
    browser.click("#nearer")?;
    let transforms = "[...document.querySelectorAll('#side .view')].map(v => v.firstElementChild.style.transform)";
    let transforms = browser.evaluate(transforms)?;
    ensure!(
        transforms[0] == transforms[1] && transforms[1] == transforms[2],
        "{transforms}"
    );
    ensure!(
        transforms[0]
            .as_str()
            .is_some_and(|t| t.contains("scale(1.6)")),
        "{transforms}"
    );
    browser.click("#farther")?;

    // Slider and flicker.
    browser.click("[data-mode=slider]")?;
    let [x, y] = browser.middle("#divide")?;
    browser.drag(&[[x, y], [x + 80.0, y]])?;
    let clip = browser.text("document.querySelector('#over span').style.clipPath")?;
    let divide = browser.number("Number(document.querySelector('#divide').value)")?;
    ensure!(
        divide > 52.0 && clip.contains(&format!("{divide}%")),
        "{divide}: {clip}"
    );
    browser.click("[data-mode=flicker]")?;
    for seen in ["hidden", "visible"] {
        browser.wait(&format!(
            "document.querySelector('#over span').style.visibility === '{seen}'"
        ))?;
    }
    browser.click("[data-mode=side]")?;

    // The scale by percentile: at 100 nothing lies beyond, and the largest error is the report's.
    browser.choose("#percentile", "e.max", "input")?;
    let said = browser.said("#outliers")?;
    ensure!(said.contains("; 0 beyond"), "{said}");
    let scale = browser.number("report.scaleAt(100).limit")?;
    let report = std::fs::read_to_string(out.join("report.json"))?;
    let report: Value = serde_json::from_str(&report)?;
    let largest = report["error"]["rgb"]["max_abs"]
        .as_f64()
        .context("no error")?;
    ensure!((scale / largest - 1.0).abs() < 0.005, "{scale}, {largest}");
    // At the percentile of the page's own text the sentence counts what the report counts.
    browser.choose("#percentile", "5", "input")?;
    let said = browser.said("#outliers")?;
    let said = said.replace('\u{202f}', "");
    let counted = &report["error_map"]["outliers"];
    ensure!(said.starts_with("99.9 %"), "{said}");
    ensure!(
        said.contains(&format!("; {counted} beyond")),
        "{said}: {counted}"
    );

    // Every point of both plots and its row: the nearest point is meant where places overlap, as they do where two
    // designs take the same time and here in any case.
    browser.evaluate("(() => { const [a, b] = document.querySelectorAll('.wide .place'); b.setAttribute('cx', a.cx.baseVal.value + 4); b.setAttribute('cy', a.cy.baseVal.value); })()")?;
    browser.evaluate("document.querySelectorAll('.wide .place').forEach((place, number) => { place.dataset.number = number; })")?;
    let places = browser.count(".wide .place")?;
    ensure!(places >= 8.0, "{places} places");
    for number in 0..places as usize {
        let [x, y] = browser.middle(&format!(".wide .place[data-number='{number}']"))?;
        browser.mouse("mouseMoved", [x, y], false)?;
        browser.wait("!document.querySelector('#tip').hidden && document.querySelectorAll('tr.lit').length === 1")?;
        let apart = browser.number(&format!(
            "(() => {{ const of = document.querySelector(\".wide .place[data-number='{number}']\"); \
            const lit = of.closest('svg').querySelector('.lit'); \
            return Math.hypot(lit.cx.baseVal.value - of.cx.baseVal.value, lit.cy.baseVal.value - of.cy.baseVal.value); }})()"
        ))?;
        ensure!(apart < 0.5, "place {number} lights another, {apart} away");
        let tip = browser.said("#tip")?;
        let row = browser.said("tr.lit td")?;
        ensure!(tip.contains(&row) && tip.contains("PSNR"), "{tip}: {row}");
        browser.mouse("mouseMoved", [1.0, 1.0], false)?;
        browser.wait("document.querySelector('#tip').hidden && !document.querySelector('.lit')")?;
    }
    look(&mut browser, "report")?;

    // One design: no plot of a single dot.
    splatline("compare random:200 --size 64x64 --only", &out)?;
    browser.open(&out.join("report.html"), READY)?;
    ensure!(browser.count(".plot")? == 0.0, "a plot of one dot");
    no_complaints(&browser)
}

#[test]
#[cfg_attr(
    not(has_chromium),
    ignore = "needs chromium (Debian: apt-get install chromium)"
)]
fn the_sweeps_page_answers() -> Result<()> {
    let (mut browser, folder) = browser()?;
    let space = folder.path().join("space.toml");
    std::fs::write(
        &space,
        "sample = \"grid\"\n[design]\nmantissa = [14, 18, 24]\nalpha = [8, 14, 20]\n[machine]\nlanes = [1, 4, 8]\n",
    )?;
    let out = folder.path().join("out");
    let space = space.display();
    let sweep = format!("explore random:800 --size 128x96 --space {space}");
    splatline(&sweep, &out)?;
    browser.open(&out.join("front.html"), READY)?;

    let cells = |column: &str| {
        format!(
            "(() => {{ const i = [...document.querySelectorAll('#table th')].findIndex(h => h.textContent === '{column}'); \
            return [...document.querySelectorAll('#table tbody tr')].map(r => Number(r.cells[i].textContent)); }})()"
        )
    };
    let sort = "[...document.querySelectorAll('#table button')].find(b => b.textContent === 'area').click()";
    for ascending in [true, false] {
        browser.evaluate(sort)?;
        let areas: Vec<f64> = serde_json::from_value(browser.evaluate(&cells("area"))?)?;
        let sorted = areas.windows(2).all(|pair| {
            if ascending {
                pair[0] <= pair[1]
            } else {
                pair[0] >= pair[1]
            }
        });
        ensure!(areas.len() > 1 && sorted, "{areas:?}");
    }
    let points = browser.count("#scatter circle")?;
    ensure!(points == 27.0, "{points} of 27 points");
    let psnr: Vec<f64> = serde_json::from_value(browser.evaluate(&cells("psnr_db"))?)?;
    let middle = psnr.iter().sum::<f64>() / psnr.len() as f64;
    browser.choose("#least-psnr", &middle.to_string(), "input")?;
    let kept: Vec<f64> = serde_json::from_value(browser.evaluate(&cells("psnr_db"))?)?;
    let expected = psnr.iter().filter(|value| **value >= middle).count();
    ensure!(
        kept.len() == expected && expected < psnr.len(),
        "{kept:?} of {psnr:?} from {middle}"
    );
    browser.choose("#least-psnr", "''", "input")?;

    // Better is up: the scatter's highest point has the largest PSNR. Axes may be chosen.
    let highest = "(() => { const c = [...document.querySelectorAll('#scatter circle')].sort((a, b) => a.cy.baseVal.value - b.cy.baseVal.value)[0]; \
        return Number(c.textContent.match(/psnr_db (\\S+)/)[1]); })()";
    let most = psnr.iter().copied().fold(0.0, f64::max);
    ensure!(
        browser.number(highest)? >= most,
        "the highest point is not the best"
    );
    browser.choose(
        "#across",
        "[...e.options].find(o => o.text === 'area').value",
        "change",
    )?;
    browser.wait(
        "[...document.querySelectorAll('#scatter text')].some(t => t.textContent === 'area')",
    )?;
    let lines = browser.count("#parallel polyline")?;
    ensure!(lines == 27.0, "{lines} lines of 27 points");
    // Both charts have numbers on both axes.
    let ticks = browser.number("Math.min(...[...document.querySelectorAll('.still svg')].map(s => s.querySelectorAll('text').length))")?;
    ensure!(ticks >= 8.0, "{ticks} texts on a chart");
    look(&mut browser, "front")?;
    no_complaints(&browser)
}

/// Prints frames a second of the live page; the bar is 10 for 20,000 splats at 512x512 on one core. Not asserted,
/// because other work on the machine decides too.
#[test]
#[cfg_attr(
    not(has_chromium),
    ignore = "needs chromium (Debian: apt-get install chromium)"
)]
fn frames_a_second() -> Result<()> {
    const FRAMES: f64 = 20.0;
    let (mut browser, folder) = browser()?;
    let page = folder.path().join("page.html");
    splatline("page random:20000 --size 512x512", &page)?;
    browser.open(&page, READY)?;
    println!("live page, 20,000 splats at 512x512, one core, frames a second:");
    let kinds = [
        ("kernel alone", "['fixed']"),
        ("kernel, reference and error", "splatline.layers"),
    ];
    for (name, layers) in kinds {
        // The first frames are drawn by code that is not yet optimised.
        browser.evaluate(&format!("splatline.bench(5, {layers})"))?;
        let bench = browser.evaluate(&format!("splatline.bench({FRAMES}, {layers})"))?;
        let clock = bench["whole"].as_f64().context("no time")?;
        println!("{name}: {:.1} ({clock:.0} ms); parts {bench}", 1e3 / clock);
    }
    no_complaints(&browser)
}
