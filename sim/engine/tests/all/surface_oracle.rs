//! Other ways to what surface splatting computes: rays cut with the tangent plane, and all samples of a pixel side by side.

use splatline_engine::camera::Camera;
use splatline_engine::scene::points::{SurfacePoint, SurfaceScene};
use splatline_engine::surface::Style;
use splatline_engine::vector::{self, Vector};
use splatline_reference::engines::surface::project;

/// d(tangent coordinates)/d(pixel) at the splat's centre: rays through the pixel and its neighbours, cut with the tangent
/// plane (SURF 4). Columns are the change per column and per row, in standard deviations; none for a plane seen edge-on.
pub fn inverse_jacobian(point: &SurfacePoint, camera: &Camera) -> Option<[[f64; 2]; 2]> {
    let centre = camera.to_camera(point.centre);
    let [s1, s2] = point
        .frame
        .map(|axis| vector::transform(&camera.rotation, axis));
    let normal = vector::cross(s1, s2);
    let distance = if camera.orthographic { 1.0 } else { centre[2] };
    let foot = [
        camera.fx * centre[0] / distance + camera.cx,
        camera.fy * centre[1] / distance + camera.cy,
    ];
    let towards = |u: f64, v: f64| -> (Vector, Vector) {
        let (x, y) = ((u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy);
        if camera.orthographic {
            ([x, y, 0.0], [0.0, 0.0, 1.0])
        } else {
            ([0.0; 3], [x, y, 1.0])
        }
    };
    let cut = |du: f64, dv: f64| -> Option<[f64; 2]> {
        let (start, direction) = towards(foot[0] + du, foot[1] + dv);
        let along = vector::dot(normal, direction);
        let distance = vector::dot(normal, vector::subtract(centre, start)) / along;
        let hit = vector::add(start, vector::scale(distance, direction));
        let offset = vector::subtract(hit, centre);
        let coordinate = |s: Vector| vector::dot(offset, s) / vector::dot(s, s);
        let found = [coordinate(s1), coordinate(s2)];
        found.iter().all(|c| c.is_finite()).then_some(found)
    };
    // Central differences of a smooth map: the error falls with the square of the step.
    let step = 1e-4;
    let difference = |du: f64, dv: f64| -> Option<[f64; 2]> {
        let (ahead, behind) = (cut(du, dv)?, cut(-du, -dv)?);
        Some([0, 1].map(|k: usize| (ahead[k] - behind[k]) / (2.0 * step)))
    };
    Some([difference(step, 0.0)?, difference(0.0, step)?])
}

/// Depth of the true tangent plane at a place of the screen, by the ray: what the affine depth approximates.
pub fn exact_depth(point: &SurfacePoint, camera: &Camera, place: [f64; 2]) -> f64 {
    let centre = camera.to_camera(point.centre);
    let normal = vector::transform(&camera.rotation, point.normal);
    let x = (place[0] - camera.cx) / camera.fx;
    let y = (place[1] - camera.cy) / camera.fy;
    if camera.orthographic {
        centre[2] - (normal[0] * (x - centre[0]) + normal[1] * (y - centre[1])) / normal[2]
    } else {
        vector::dot(normal, centre) / vector::dot(normal, [x, y, 1.0])
    }
}

/// Per pixel how many layers overlap: the largest number of its samples that are pairwise farther apart than the threshold.
///
/// No order of drawing can have more fragments open than that, because open fragments are that far apart.
pub fn overlapping_layers(scene: &SurfaceScene, camera: &Camera, style: &Style) -> Vec<usize> {
    let mut depths = vec![Vec::new(); camera.width * camera.height];
    for splat in scene
        .points
        .iter()
        .flat_map(|point| project(point, camera, style))
    {
        let ([a, b, c], [du, dv]) = (splat.conic, splat.gradient);
        for y in splat.bounds.y0..splat.bounds.y1 {
            for x in splat.bounds.x0..splat.bounds.x1 {
                let dx = x as f64 + 0.5 - splat.centre[0];
                let dy = y as f64 + 0.5 - splat.centre[1];
                if a * dx * dx + 2.0 * b * dx * dy + c * dy * dy < style.cutoff {
                    depths[y * camera.width + x].push(splat.depth + du * dx + dv * dy);
                }
            }
        }
    }
    let count = |mut depths: Vec<f64>| {
        depths.sort_by(f64::total_cmp);
        let mut last = f64::NEG_INFINITY;
        let apart = |depth: &f64| {
            let apart = *depth - last > style.threshold;
            last = if apart { *depth } else { last };
            apart
        };
        depths.iter().copied().filter(apart).count()
    };
    depths.into_iter().map(count).collect()
}
