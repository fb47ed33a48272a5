//! Point clouds: what is read, what is made up and what is refused.

use super::*;
use crate::scene::damage_tests::{answers_at, assert_refused, rows};

fn ply(properties: &str, rows: &str) -> Result<SurfaceScene, Problem> {
    let count = rows.lines().count();
    let header = format!("ply\nformat ascii 1.0\nelement vertex {count}\n{properties}end_header\n");
    surface(
        "cloud.ply",
        parse((header + rows).as_bytes(), Path::new("cloud.ply"))?,
    )
}

fn xyz(text: &str) -> Result<SurfaceScene, Problem> {
    surface("cloud.xyz", parse(text.as_bytes(), Path::new("cloud.xyz"))?)
}

const PLACES: &str = "property float x\nproperty float y\nproperty float z\n";
const GRID: &str = "0 0 5\n1 0 5\n0 1 5\n1 1 5\n2 0 5\n2 1 5\n";

#[test]
fn a_ply_with_everything_is_taken_as_it_is() {
    let rest = "property float nx\nproperty float ny\nproperty float nz\nproperty uchar red\nproperty uchar green\n\
                property uchar blue\nproperty float radius\n";
    let row = "1 2 3 0 0 2 255 51 0 0.5\n";
    let scene = ply(&format!("{PLACES}{rest}"), &row.repeat(3)).unwrap();
    let point = scene.points[0];
    assert_eq!(point.centre, [1.0, 2.0, 3.0]);
    assert_eq!(point.normal, [0.0, 0.0, 1.0]);
    assert_eq!(point.colour, [1.0, 0.2, 0.0]);
    assert!((vector::length(point.frame[0]) - 0.5).abs() < 1e-15);
    assert!(vector::dot(point.frame[0], point.frame[1]).abs() < 1e-15);
    assert!(scene.notes.is_empty());
}

#[test]
fn what_is_missing_is_made_up_and_told() {
    let scene = ply(PLACES, GRID).unwrap();
    assert_eq!(scene.notes.len(), 3);
    for point in &scene.points {
        assert!((point.normal[2].abs() - 1.0).abs() < 1e-12, "{point:?}");
        assert!(vector::length(point.frame[0]) >= 1.0);
    }
}

#[test]
fn xyz_columns_are_told_apart() {
    let normals = xyz("# comment\n0 0 0 0 0 1\n1,0,0,0,0,1\n0;1;0;0;0;1\n").unwrap();
    assert_eq!(normals.points[1].normal, [0.0, 0.0, 1.0]);
    let colours = xyz("3\n0 0 0 255 0 0\n1 0 0 255 0 51\n0 1 0 0 0 0\n").unwrap();
    assert_eq!(colours.points[1].colour, [1.0, 0.0, 0.2]);
}

#[test]
fn errors_name_the_field_and_the_fix() {
    let message = |result: Result<SurfaceScene, Problem>| result.unwrap_err().to_string();
    let partial = ply(&format!("{PLACES}property float nx\n"), "0 0 0 1\n");
    assert_eq!(
        message(partial),
        "properties nx, ny, nz: only some of them are there; export all three or none"
    );
    assert_eq!(
        message(xyz("0 0 x\n")),
        "line 1, number 3: 'x' is no number; write a number such as 0.5"
    );
    assert!(message(xyz("0 0 0\n1 1\n")).starts_with("line 2: it has 2 numbers"));
    assert!(message(xyz("0 0 nan\n")).contains("only 0 of 1 are usable"));
    assert!(message(xyz("")).contains("only 0 of 0"));
    assert!(
        message(ply(
            &format!("{PLACES}property float scale_0\n"),
            "0 0 0 1\n"
        ))
        .contains("Gaussians")
    );
}

#[test]
fn stray_points_are_counted() {
    let scene = xyz("0 0 0 0 0 1\n1 0 0 0 0 1\n0 1 0 0 0 1\n1 1 0 0 0 0\ninf 0 0 0 0 1\n").unwrap();
    assert_eq!((scene.points.len(), scene.skipped), (3, 2));
}

/// Basis functions on a hexagonal grid sum to 1 everywhere, within the ripple that the cut-off leaves.
#[test]
fn the_share_of_area_makes_a_partition_of_unity() {
    let row_height = 3f64.sqrt() / 2.0;
    let sum = |x: f64, y: f64| {
        let mut sum = 0.0;
        for j in -6i32..=6 {
            for i in -6i32..=6 {
                let dx = f64::from(i) + 0.5 * f64::from(j.rem_euclid(2)) - x;
                let dy = f64::from(j) * row_height - y;
                let r = dx * dx + dy * dy;
                sum += if r < 2.0 {
                    share_of_area() * (-0.5 * r).exp()
                } else {
                    0.0
                };
            }
        }
        sum
    };
    let samples: Vec<f64> = (0..400)
        .map(|n| sum(f64::from(n % 20) / 20.0, f64::from(n / 20) / 20.0))
        .collect();
    let mean = samples.iter().sum::<f64>() / samples.len() as f64;
    assert!((mean - 1.0).abs() < 0.02, "{mean}");
    assert!(samples.iter().all(|s| (0.85..1.15).contains(s)));
}

fn obj(text: &str) -> Result<SurfaceScene, Problem> {
    surface("cloud.obj", parse(text.as_bytes(), Path::new("cloud.obj"))?)
}

#[test]
fn vertices_of_an_obj_have_colours_and_normals() {
    let rows = "# a cloud\nv 0 0 0 1 0 0\nv 1 0 0 1.0 0.2 0\nv 0 1 0 0 0 0\n";
    let normals = "vn 0 0 1\nvn 0 2 0\nvn 1 0 0\n";
    let cloud = obj(&format!("mtllib x.mtl\n{rows}{normals}")).unwrap();
    assert_eq!(cloud.points[1].normal, [0.0, 1.0, 0.0]);
    assert_eq!(cloud.points[1].colour, [1.0, 0.2, 0.0]);
    // A face gives its corners' normals, whatever their order; what it does not name has its neighbours' plane.
    let places = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nv 2 0 0\nv 2 1 0\n";
    let faced = obj(&format!(
        "{places}vn 1 0 0\nvn 0 1 0\nf 1//2 2/7/1 -4//-2\n"
    ))
    .unwrap();
    assert_eq!(faced.points[0].normal, [0.0, 1.0, 0.0]);
    assert_eq!(faced.points[1].normal, [1.0, 0.0, 0.0]);
    assert_eq!(faced.points[2].normal, [1.0, 0.0, 0.0]);
    assert!((faced.points[5].normal[2].abs() - 1.0).abs() < 1e-12);
    assert_eq!(
        faced.notes[0],
        "1 faces and lines are not drawn: only vertices are"
    );
}

/// A sphere as VTK writes it: places of radius 2, and a normal along each.
#[test]
fn a_sphere_of_vtk_is_read() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/files/sphere.obj");
    let scene = load(&file).unwrap();
    assert_eq!(scene.points.len(), 20);
    for point in &scene.points {
        assert!((vector::length(point.centre) - 2.0).abs() < 1e-5);
        assert!((vector::dot(point.centre, point.normal) - 2.0).abs() < 1e-4);
    }
}

#[test]
fn an_obj_that_is_damaged_is_refused_or_shorter() {
    let whole = "v 0 0 5\nv 1 0 5\nv 0 1 5\nv 1 1 5\nvn 0 0 1\nvn 0 0 1\nvn 0 0 1\nvn 0 0 1\nf 1//1 2//2 3//3\n";
    let load =
        |bytes: &[u8]| parse(bytes, Path::new("cloud.obj")).and_then(|cloud| surface("x", cloud));
    for place in 0..whole.len() {
        let _ = load(&whole.as_bytes()[..place]);
    }
    answers_at(whole.as_bytes(), 0..whole.len(), &load);
    let table = r"
        v 0 0\n => line 1: a vertex of 2 numbers; write x y z, or x y z r g b
        v 0 0 a\n => line 1: 'a' is no number; write a number such as 0.5
        v 0 0 0\nvn 1 0\n => line 2: a normal of 2 numbers; write three
        v 0 0 0\nf 1 2 3\n => line 2: the corner '2' names nothing above it; fetch
        v 0 0 0\nf 1//1\n => line 2: the corner '1//1' names nothing above it; fetch
        w 0 0 0\n => line 1: 'w' is no word of .obj; remove the line
        v 0 0 0\nv 0 0 1\nvn 0 0 1\n => vn: 1 normals for 2 vertices; write one normal per vertex
    ";
    for [text, expected] in rows(table) {
        assert_refused(&[(text, &*expected)], load);
    }
}
