//! quick timing
use splatline_sim::{
    baseline, camera::Camera, design::DesignChoice, fast::lanes::Choice, fixed, metrics, rules::*,
    scene,
};
fn median(mut v: Vec<f64>) -> f64 {
    v.sort_by(f64::total_cmp);
    v[v.len() / 2]
}
fn cpu() -> f64 {
    let mut s = 0.0;
    for e in std::fs::read_dir("/proc/self/task").unwrap() {
        let p = e.unwrap().path().join("schedstat");
        s += std::fs::read_to_string(p)
            .unwrap()
            .split(' ')
            .next()
            .unwrap()
            .parse::<f64>()
            .unwrap()
            * 1e-9;
    }
    s
}
fn main() {
    let args: Vec<String> = std::env::args().collect();
    let reps: usize = args[2].parse().unwrap();
    rayon::ThreadPoolBuilder::new()
        .num_threads(args[3].parse().unwrap())
        .build_global()
        .unwrap();
    let (scene, camera) = match args[1].as_str() {
        "r10" => (
            scene::synthetic::random_gaussians(10_000, 1, 1.0),
            scene::synthetic::camera(512, 512),
        ),
        "r10x" => (
            scene::synthetic::random_gaussians(10_000, 1, 2.5),
            scene::synthetic::camera(512, 512),
        ),
        "r100" => (
            scene::synthetic::random_gaussians(100_000, 1, 1.0),
            scene::synthetic::camera(512, 512),
        ),
        "r100x" => (
            scene::synthetic::random_gaussians(100_000, 1, 2.5),
            scene::synthetic::camera(512, 512),
        ),
        "guitar" => (
            scene::load(
                std::path::Path::new("/work/shared/data/gaussians/guitar.ply"),
                &Default::default(),
            )
            .unwrap(),
            Camera::look_at(
                [5.5, -2.1, 0.2],
                [0.1, -2.1, 0.1],
                [0.0, -1.0, 0.0],
                50.0,
                512,
                512,
            )
            .unwrap(),
        ),
        "brain" => {
            let s = scene::load(
                std::path::Path::new("/work/shared/data/volumes/brainsmall.nhdr"),
                &Default::default(),
            )
            .unwrap();
            let c = s.default_camera(512, 512);
            (s, c)
        }
        _ => panic!(),
    };
    let rules = scene.natural_rules;
    let fs = baseline::FloatScene::new(&scene, &camera, &rules);
    let reference =
        splatline_sim::reference::float::draw(&scene, &camera, &rules, Compositing::FrontToBack)
            .picture;
    let q = fixed::QuantisedScene::new(&scene, &camera, &rules);
    let which = args.get(4).cloned().unwrap_or_default();
    let engines: Vec<(&str, fixed::Engine)> = vec![
        ("scalar", fixed::Engine::Scalar),
        ("eight", fixed::Engine::Vectors(Choice::Eight)),
        ("best", fixed::Engine::Vectors(Choice::Best)),
    ];
    let mut cpus: std::collections::BTreeMap<String, Vec<f64>> = Default::default();
    let mut t: std::collections::BTreeMap<String, Vec<fixed::Times>> = Default::default();
    for _ in 0..reps {
        if which.is_empty() || which == "a" {
            for (n, r) in [
                ("0 a", baseline::scene::Reach::Sigmas),
                ("1 a tight", baseline::scene::Reach::Cutoff),
            ] {
                let c = cpu();
                let d = baseline::boxes::draw(&fs, r);
                cpus.entry(n.to_string()).or_default().push(cpu() - c);
                t.entry(n.into()).or_default().push(d.times);
            }
        }
        for (n, e) in &engines {
            if which.is_empty() && *n == "scalar" {
                continue;
            }
            if !which.is_empty() && which != *n {
                continue;
            }
            for d in ["lean18", "standard24"] {
                let design = DesignChoice::named(d).unwrap();
                let o = fixed::Options {
                    rules: &rules,
                    compositing: Compositing::FrontToBack,
                    design: &design,
                    traversal: design.traversal,
                };
                let c = cpu();
                let (dr, _) = fixed::draw_quantised(&q, &camera, &o, *e);
                cpus.entry(format!("{n} {d}")).or_default().push(cpu() - c);
                if t.get(&format!("{n} {d}")).is_none() {
                    println!(
                        "{d} visited {} covered {} finished {} drawn {}",
                        dr.coverage.visited,
                        dr.coverage.covered,
                        dr.coverage.finished,
                        dr.splats - dr.culled.iter().sum::<usize>()
                    );
                    println!(
                        "{:?}",
                        metrics::compare(&dr.picture, &reference)
                            .unwrap()
                            .colour
                            .psnr_db
                    );
                }
                t.entry(format!("{n} {d}")).or_default().push(dr.times);
            }
        }
    }
    println!(
        "a: {:?}",
        metrics::compare(
            &baseline::boxes::draw(&fs, baseline::scene::Reach::Sigmas).picture(fs.viewport),
            &reference
        )
        .unwrap()
        .colour
        .psnr_db
    );
    let ta = t
        .get("0 a")
        .map(|v| median(v.iter().map(|t| t.setup + t.sort + t.raster).collect()))
        .unwrap_or(0.0);
    for (k, v) in &t {
        let m = |f: fn(&fixed::Times) -> f64| 1e3 * median(v.iter().map(f).collect());
        let total = median(v.iter().map(|t| t.setup + t.sort + t.raster).collect());
        println!(
            "{k:20} setup {:7.2} sort {:7.2} raster {:7.2} total {:7.2} ratio {:.2}",
            m(|t| t.setup),
            m(|t| t.sort),
            m(|t| t.raster),
            1e3 * total,
            ta / total
        );
    }
}
