//! Texture coefficients against naive sums, and textured surfaces in fixed point against the reference.

use super::shell::{Shell, holds};
use splatline_sim::camera::Camera;
use splatline_sim::design::DesignChoice;
use splatline_sim::metrics::compare;
use splatline_sim::scene::points::height_field::HeightField;
use splatline_sim::surface::Style;
use splatline_sim::texture::Texture;
use splatline_sim::texture::coefficients::{Method, SamplePoint, coefficients};
use splatline_sim::texture::drape::{drape, sample_points};
use splatline_sim::{fixed, reference};

const CUTOFF: f64 = 2.0;

/// Numbers between 0 and 1 (Knuth's MMIX generator).
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f64 / f64::from(1 << 24)
    }
}

/// Points on a jittered grid of 6 x 6 with slanted, unequal axes, over a texture of 36 x 36.
fn scattered(random: &mut Random) -> Vec<SamplePoint> {
    let point = |index: usize| {
        let mut offset = || 2.0 * (random.next() - 0.5);
        SamplePoint {
            place: [
                6.0 * (index % 6) as f64 + 3.0 + offset(),
                6.0 * (index / 6) as f64 + 3.0 + offset(),
            ],
            axes: [[5.0 + offset(), offset()], [offset(), 5.0 + offset()]],
        }
    };
    (0..36).map(point).collect()
}

fn pattern(random: &mut Random) -> Texture {
    let noise: Vec<f64> = (0..36 * 36).map(|_| random.next()).collect();
    Texture::from_pattern(36, 36, |u, v| {
        let step = if u + 0.3 * v > 20.0 { 0.7 } else { 0.3 };
        let grain = noise[v as usize * 36 + u as usize];
        [step, 1.0 - step, 0.9 * step + 0.1 * grain]
    })
}

/// The continuous texture function of \[SURF\] eq. 2, summed in the plainest way: what a surface splatted with given
/// coefficients looks like on its own texture, without screen, low-pass filter and depth. It is the function that the
/// optimised coefficients fit, and the limit of a drawing under ever greater magnification (\[HYBRID\] 3).
///
/// f(u) = sum_k w_k g_k(u) / sum_k g_k(u) with g_k = exp(-r_k / 2) inside `cutoff`; none where no function reaches.
fn texture_function(
    points: &[SamplePoint],
    colours: &[[f64; 3]],
    cutoff: f64,
    place: [f64; 2],
) -> Option<[f64; 3]> {
    let (mut sum, mut colour) = (0.0, [0.0; 3]);
    for (point, coefficient) in points.iter().zip(colours) {
        let index = radial_index(point, place);
        if index < cutoff {
            let height = (-0.5 * index).exp();
            sum += height;
            for (total, channel) in colour.iter_mut().zip(coefficient) {
                *total += height * channel;
            }
        }
    }
    (sum > 0.0).then(|| colour.map(|total| total / sum))
}

/// Squared length of the place in the point's own axes: the two axes' coordinates by Cramer's rule.
fn radial_index(point: &SamplePoint, place: [f64; 2]) -> f64 {
    let [a, b] = point.axes;
    let [x, y] = [place[0] - point.place[0], place[1] - point.place[1]];
    let area = a[0] * b[1] - a[1] * b[0];
    let along = [(x * b[1] - y * b[0]) / area, (a[0] * y - a[1] * x) / area];
    along[0] * along[0] + along[1] * along[1]
}

/// Sum over the texels of the squared difference of function and texture.
fn residual(texture: &Texture, points: &[SamplePoint], colours: &[[f64; 3]]) -> f64 {
    let texels = texture.texels.iter().enumerate();
    let differences = texels.filter_map(|(index, texel)| {
        let place = [
            (index % texture.width) as f64 + 0.5,
            (index / texture.width) as f64 + 0.5,
        ];
        let found = texture_function(points, colours, CUTOFF, place)?;
        Some((0..3).map(|c| (found[c] - texel[c]).powi(2)).sum::<f64>())
    });
    differences.sum()
}

#[test]
fn optimised_coefficients_have_the_least_residual() {
    let mut random = Random(7);
    let points = scattered(&mut random);
    let texture = pattern(&mut random);
    let [plain, prefiltered, optimised] = Method::ALL.map(|method| {
        let found = coefficients(&texture, &points, method, CUTOFF).unwrap();
        residual(&texture, &points, &found)
    });
    assert!(
        optimised < 0.7 * plain && optimised < 0.7 * prefiltered,
        "{optimised} {plain} {prefiltered}"
    );
    // No step in any direction does better: it is the minimum, up to the damping's share.
    let best = coefficients(&texture, &points, Method::Optimised, CUTOFF).unwrap();
    for _ in 0..20 {
        let mut moved = best.clone();
        for channel in moved.iter_mut().flatten() {
            *channel += 0.05 * (random.next() - 0.5);
        }
        assert!(residual(&texture, &points, &moved) > optimised);
    }
}

#[test]
fn every_method_reproduces_a_constant_texture() {
    let points = scattered(&mut Random(3));
    let texture = Texture::from_pattern(36, 36, |_, _| [0.25, 0.5, 0.75]);
    for method in Method::ALL {
        let found = coefficients(&texture, &points, method, CUTOFF).unwrap();
        for colour in found {
            for (found, expected) in colour.into_iter().zip([0.25, 0.5, 0.75]) {
                assert!((found - expected).abs() < 1e-7, "{} {found}", method.name());
            }
        }
    }
}

#[test]
fn the_prefilter_is_the_naive_weighted_mean() {
    let mut random = Random(11);
    let points = scattered(&mut random);
    let texture = pattern(&mut random);
    let found = coefficients(&texture, &points, Method::Prefiltered, CUTOFF).unwrap();
    for (point, colour) in points.iter().zip(found) {
        let [[a0, a1], [b0, b1]] = point.axes;
        let (xx, xy, yy) = (
            a0 * a0 + b0 * b0 + 1.0,
            a0 * a1 + b0 * b1,
            a1 * a1 + b1 * b1 + 1.0,
        );
        let (mut sum, mut total) = (0.0, 0.0);
        for (index, texel) in texture.texels.iter().enumerate() {
            let dx = (index % 36) as f64 + 0.5 - point.place[0];
            let dy = (index / 36) as f64 + 0.5 - point.place[1];
            let r = (yy * dx * dx - 2.0 * xy * dx * dy + xx * dy * dy) / (xx * yy - xy * xy);
            if r < 9.0 {
                sum += (-0.5 * r).exp();
                total += (-0.5 * r).exp() * texel[0];
            }
        }
        assert!((colour[0] - total / sum).abs() < 1e-12);
    }
}

#[test]
fn points_without_texels_keep_their_plain_colour() {
    let texture = Texture::from_pattern(8, 8, |u, _| [u / 8.0; 3]);
    let far = SamplePoint {
        place: [100.0, 4.0],
        axes: [[1.0, 0.0], [0.0, 1.0]],
    };
    let flat = SamplePoint {
        place: [2.0, 2.0],
        axes: [[1.0, 0.0], [2.0, 0.0]],
    };
    for method in [Method::Plain, Method::Optimised] {
        let found = coefficients(&texture, &[far, flat], method, CUTOFF).unwrap();
        assert_eq!(found, [far, flat].map(|point| texture.sample(point.place)));
    }
}

/// A hill with a checkerboard of 0.3 and 0.7.
fn hill() -> (HeightField, Texture) {
    let field = HeightField::from_heights(25, 25, 0.1, |x, y| {
        let [x, y] = [x, y].map(|c| (c as f64 - 12.0) / 8.0);
        0.6 * (-x * x - y * y).exp()
    });
    let texture = Texture::from_pattern(144, 144, |u, v| {
        let is_odd = ((u / 24.0) as i32 + (v / 24.0) as i32) & 1 == 1;
        [if is_odd { 0.7 } else { 0.3 }; 3]
    });
    (field, texture)
}

/// Under magnification a drawing is the texture function: north is up, the first row of heights is the southernmost.
#[test]
fn a_magnified_drawing_converges_to_the_texture_function() {
    let (field, texture) = hill();
    let flat = HeightField {
        heights: vec![0.0; field.heights.len()],
        ..field
    };
    let mut texture = texture;
    texture.texels[..20 * 144].fill([0.9, 0.3, 0.3]);
    let points = sample_points(&flat, &texture);
    let scene = drape(&flat, "flat", &texture, Method::Optimised, CUTOFF).unwrap();
    let colours: Vec<[f64; 3]> = scene.points.iter().map(|point| point.colour).collect();
    let worst = |pixels_per_unit: f64| {
        let (eye, target) = ([0.33, 0.7, 9.0], [0.33, 0.7, 0.0]);
        let camera = Camera::look_at(eye, target, [0.0, 1.0, 0.0], 45.0, 64, 64);
        let mut camera = camera.unwrap();
        (camera.orthographic, camera.fx, camera.fy) = (true, pixels_per_unit, pixels_per_unit);
        let picture = reference::surface::draw(&scene, &camera, &Style::opaque(1.0)).picture;
        let mut sum = 0.0;
        for (index, pixel) in picture.pixels.iter().enumerate() {
            let x = 0.33 + ((index % 64) as f64 + 0.5 - 32.0) / pixels_per_unit;
            let y = 0.7 - ((index / 64) as f64 + 0.5 - 32.0) / pixels_per_unit;
            let place = [(x + 1.2) / 2.4 * 144.0, (1.2 - y) / 2.4 * 144.0];
            let expected = texture_function(&points, &colours, CUTOFF, place).unwrap();
            sum += (0..3)
                .map(|c| (pixel[c] - expected[c]).powi(2))
                .sum::<f64>();
        }
        (sum / (3.0 * 4096.0)).sqrt()
    };
    let (coarse, fine) = (worst(80.0), worst(640.0));
    assert!(fine < 0.012 && fine < 0.5 * coarse, "{coarse} {fine}");
}

#[test]
fn a_textured_height_field_agrees_in_fixed_point() {
    let (field, texture) = hill();
    let (eye, target) = ([0.4, -2.5, 1.8], [0.0, 0.0, 0.1]);
    let camera = Camera::look_at(eye, target, [0.0, 0.0, 1.0], 45.0, 96, 72).unwrap();
    let design = DesignChoice::named("standard24").unwrap();
    for method in Method::ALL {
        let scene = drape(&field, "hill", &texture, method, CUTOFF).unwrap();
        let style = Style::opaque(scene.usual_threshold());
        let drawn = fixed::surface::draw(&scene, &camera, &style, &design, design.traversal);
        let float = reference::surface::draw(&scene, &camera, &style);
        let errors = compare(&drawn.picture, &float.picture).unwrap();
        for group in [errors.colour, errors.alpha] {
            assert!(
                group.psnr_db >= 60.0 && group.bias.abs() <= 5e-4,
                "{group:?}"
            );
        }
        assert!(drawn.facts.coverage.covered > 10_000);
    }
}

#[test]
#[cfg_attr(
    not(has_data),
    ignore = "the shared data were not beside the project when this was built"
)]
fn the_real_height_field_and_photograph_load_and_register() {
    let data = concat!(env!("CARGO_MANIFEST_DIR"), "/../../shared/data/terrain");
    let path = std::path::Path::new(data).join("vtkjs_dem.csv");
    let field = HeightField::load(&path, 0.1).unwrap();
    assert_eq!((field.columns, field.rows), (256, 256));
    let texture = Texture::load(&path.with_extension("jpg")).unwrap();
    assert_eq!((texture.width, texture.height), (2048, 2048));
    let draped = drape(&field, "dem", &texture, Method::Plain, CUTOFF).unwrap();
    assert_eq!(draped.notes, ["colours: plain coefficients"]);
    // High and low places differ in colour: far more so with the rows flipped than without.
    let flipped = |index: usize| (255 - index / 256) * 256 + index % 256;
    let [right, wrong] = [false, true].map(|flip| {
        let place = |index: usize| if flip { flipped(index) } else { index };
        let heights = (0..field.heights.len()).map(|index| field.heights[place(index)]);
        correlation(heights, draped.points.iter().map(|point| point.colour[1])).abs()
    });
    assert!(right > 1.5 * wrong, "{right} {wrong}");
}

fn correlation(a: impl Iterator<Item = f64>, b: impl Iterator<Item = f64>) -> f64 {
    let (a, b): (Vec<f64>, Vec<f64>) = (a.collect(), b.collect());
    let mean = |v: &[f64]| v.iter().sum::<f64>() / v.len() as f64;
    let (ma, mb) = (mean(&a), mean(&b));
    let product = |v: &[f64], mv: f64, w: &[f64], mw: f64| -> f64 {
        v.iter().zip(w).map(|(x, y)| (x - mv) * (y - mw)).sum()
    };
    product(&a, ma, &b, mb) / (product(&a, ma, &a, ma) * product(&b, mb, &b, mb)).sqrt()
}

#[test]
fn the_command_line_drapes_a_photograph_and_names_what_is_wrong() {
    let shell = Shell::new();
    let rows = (0..12).map(|y| {
        let row: Vec<String> = (0..12)
            .map(|x| format!("{}", 0.1 * f64::from(x * y % 5)))
            .collect();
        row.join(",")
    });
    shell.write("hill.csv", rows.collect::<Vec<_>>().join("\n"));
    let photo = image::RgbImage::from_fn(48, 48, |x, _| {
        image::Rgb([if x < 24 { 250 } else { 10 }; 3])
    });
    photo.save(shell.path("hill.png")).unwrap();
    let hill = "render hill.csv --as surface --size 48x48 -o out.png";
    shell.results(hill);
    let draped = format!("{hill} --texture hill.png --coefficients");
    for method in ["plain", "prefiltered", "optimised"] {
        let said = shell.run(&format!("{draped} {method}"));
        assert_eq!(said.code, Some(0), "{}", said.stderr);
        holds(&said.stderr, &[&format!("{method} coefficients")]);
        let drawn = splatline_sim::picture::Picture::read_png(&shell.path("out.png")).unwrap();
        let [left, right] = [16, 32].map(|x| drawn.pixels[24 * 48 + x]);
        assert!(
            left[0] > 0.8 && right[0] < 0.2 && left[3] == 1.0,
            "{left:?} {right:?}"
        );
    }
    let said = shell.refused(1, &format!("{hill} --texture hill.csv"), "hill.csv");
    holds(&said, &[".jpg"]);
    shell.write("hill.csv", "1,2\n3,high\n");
    shell.write("cloud.xyz", "0 0 0\n1 0 0\n0 1 0\n1 1 0\n");
    shell.refuses(&format!(
        "2 {draped} best => plain, prefiltered, optimised
         1 {hill} => hill.csv: line 2, height 2: 'high'
         2 render cloud.xyz --as surface --texture hill.png -o out.png => --texture needs a height field"
    ));
}
