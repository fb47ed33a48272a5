//! The small scene and camera that several tests of the reference share.

use splatline_reference::camera::Camera;
use splatline_reference::rules::Rules;
use splatline_reference::scene::{Scene, Splat};

/// A small camera in the origin that looks along z; its tiles are not all whole.
pub fn straight_camera() -> Camera {
    let straight =
        Camera::look_at([0.0; 3], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0], 60.0, 48, 40).unwrap();
    Camera {
        far: 7.0,
        ..straight
    }
}

/// A scene without harmonics.
pub fn scene_of(splats: Vec<Splat>) -> Scene {
    Scene::of_splats("test", Rules::GAUSSIAN_3D, splats)
}
