//! scratch
use splatline_sim::{camera::Camera, design::DesignChoice, fixed, reference, rules::*, scene};
use std::path::Path;
fn main() {
    let d = "../shared/data/";
    let cams = |e, t, u, f| Camera::look_at(e, t, u, f, 512, 512).unwrap();
    let up = [0.0, -1.0, 0.0];
    let only: Vec<String> = std::env::args().skip(1).collect();
    let list: Vec<(&str, String, Option<Camera>)> = vec![
        (
            "guitar",
            format!("{d}gaussians/guitar.ply"),
            Some(cams([2.2, -1.2, 0.5], [0.1, -1.2, 0.1], up, 50.0)),
        ),
        (
            "playbot",
            format!("{d}gaussians/playbot_lod4.ply"),
            Some(cams([2.2, -1.4, 2.2], [0.0, -0.45, 0.0], up, 45.0)),
        ),
        ("brainsmall", format!("{d}volumes/brainsmall.nhdr"), None),
        ("aneurism", format!("{d}volumes/aneurism.nhdr"), None),
        ("deep-stack", "deep-stack".into(), None),
    ];
    for (name, path, cam) in list {
        if !only.is_empty() && !only.iter().any(|o| o == name) {
            continue;
        }
        let t = std::time::Instant::now();
        let sc = scene::load(Path::new(&path), &Default::default()).unwrap();
        let cam = cam.unwrap_or_else(|| sc.default_camera(512, 512));
        let rules = sc.natural_rules;
        let tl = t.elapsed();
        let t = std::time::Instant::now();
        let fl = reference::float::draw(&sc, &cam, &rules, Compositing::FrontToBack);
        println!(
            "{name}: {} splats, load {tl:?}, float {:?} {:?}",
            sc.splats.len(),
            t.elapsed(),
            fl.counts
        );
        fl.picture
            .write_png(
                Path::new(&format!("out/{name}.png")),
                splatline_sim::picture::Depth::Eight,
            )
            .unwrap();
        for ch in DesignChoice::all() {
            for tr in [
                splatline::format::Traversal::Spans,
                splatline::format::Traversal::Box,
            ] {
                let o = fixed::Options {
                    rules: &rules,
                    compositing: Compositing::FrontToBack,
                    design: &ch,
                    traversal: tr,
                };
                let dr = fixed::draw(&sc, &cam, &o);
                let (mut se, mut mx, mut b, mut at) = (0.0, 0.0f64, 0.0, (0, 0));
                let mut big = 0;
                for (i, (p, q)) in dr.picture.pixels.iter().zip(&fl.picture.pixels).enumerate() {
                    let mut m = 0.0f64;
                    for c in 0..4 {
                        let e = p[c].min(1.0) - q[c].min(1.0);
                        se += e * e;
                        b += e;
                        m = m.max(e.abs());
                        if e.abs() > mx {
                            mx = e.abs();
                            at = (i % 512, i / 512);
                        }
                    }
                    if m > 1.0 / 255.0 {
                        big += 1;
                    }
                }
                let n = (dr.picture.pixels.len() * 4) as f64;
                println!(
                    "  {:10} {:?}: {:.1} dB max {:.2}/255 at {:?} ({} px >1/255) bias {:.1e}; v/c {:.3} visited {:.1}M; t {:.3} {:.3} {:.3}; culled {:?} clamped {}",
                    ch.name,
                    tr,
                    -10.0 * (se / n).log10(),
                    mx * 255.0,
                    at,
                    big,
                    b / n,
                    dr.coverage.visited as f64 / dr.coverage.covered as f64,
                    dr.coverage.visited as f64 / 1e6,
                    dr.times.setup,
                    dr.times.sort,
                    dr.times.raster,
                    dr.culled,
                    dr.clamped
                );
            }
        }
    }
}
