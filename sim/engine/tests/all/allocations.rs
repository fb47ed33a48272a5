//! Frames of a renderer allocate nothing once their memory is there, whatever paints them.

use rayon::ThreadPoolBuilder;
use splatline::format::Traversal;
use splatline_engine::camera::Camera;
use splatline_engine::design::{DesignChoice, NAMES};
use splatline_engine::fast::lanes::VectorLevel;
use splatline_engine::fixed::PaintEngine;
use splatline_engine::fixed::surface::{SurfaceOptions, SurfaceRenderer};
use splatline_engine::picture::Picture;
use splatline_engine::renderer::{Renderer, Settings};
use splatline_engine::rules::Rules;
use splatline_engine::scene::points::synthetic::{Paint, sphere};
use splatline_engine::scene::{points, synthetic};
use splatline_engine::surface::Style;
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

thread_local! {
    /// Allocations of this thread: other tests run at the same time.
    static COUNT: Cell<usize> = const { Cell::new(0) };
}

/// The system's allocator, which counts.
struct Counting;

// SAFETY: everything is left to the system's allocator.
#[allow(unsafe_code)]
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        let _ = COUNT.try_with(|count| count.set(count.get() + 1));
        // SAFETY: as the caller promises.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, memory: *mut u8, layout: Layout) {
        // SAFETY: as the caller promises.
        unsafe { System.dealloc(memory, layout) }
    }

    unsafe fn realloc(&self, memory: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        let _ = COUNT.try_with(|count| count.set(count.get() + 1));
        // SAFETY: as the caller promises.
        unsafe { System.realloc(memory, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

#[test]
fn frames_after_the_first_walk_along_a_path_allocate_nothing() {
    let scene = synthetic::random_gaussians(5_000, 1, 2.0);
    let cameras = [1.0, 1.3, 1.1].map(|zoom| synthetic::camera(301, 203).zoomed(zoom).unwrap());
    let pool = ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    for (design, choice) in NAMES
        .iter()
        .flat_map(|name| [VectorLevel::Best, VectorLevel::Avx2].map(|choice| (*name, choice)))
    {
        let settings = Settings {
            design: DesignChoice::named(design).unwrap(),
            engine: PaintEngine::Vectors(choice),
            ..Settings::new(Rules::GAUSSIAN_3D)
        };
        let mut renderer = Renderer::new(&scene, &cameras[0], settings);
        let mut frame = vec![[0.0f32; 4]; 301 * 203];
        let mut walk = || {
            for camera in &cameras {
                renderer.set_camera(camera);
                renderer.draw_floats(&mut frame, &|_, _| true).unwrap();
            }
            COUNT.get()
        };
        // Both walks by the pool's thread, so that it counts all of them.
        let [first, second] = pool.install(|| [walk(), walk()]);
        assert_eq!(second - first, 0, "{design} on {choice:?}");
    }
}

#[test]
fn surfaces_frames_after_the_first_allocate_nothing() {
    let ball = sphere(
        [0.0; 3],
        0.8,
        6_000,
        Paint {
            colour: [0.9, 0.4, 0.2],
            opacity: 0.6,
            material: 0,
        },
    );
    let scene = points::synthetic::scene("ball", ball);
    let eye = [0.5, -3.0, 1.0];
    let camera = Camera::look_at(eye, [0.0; 3], [0.0, 0.0, 1.0], 45.0, 301, 203).unwrap();
    let pool = ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let styles = [Style::opaque(0.1), Style::layered(0.1, 4)];
    for (name, style) in NAMES
        .iter()
        .flat_map(|name| styles.iter().map(move |style| (name, style)))
    {
        let options = SurfaceOptions {
            style,
            design: &DesignChoice::named(name).unwrap(),
            traversal: Traversal::Spans,
            engine: PaintEngine::Vectors(VectorLevel::Best),
            counts: true,
        };
        let mut renderer = SurfaceRenderer::new(&scene, &camera, &options);
        let mut picture = Picture::new(0, 0);
        let mut frame = || {
            let facts = renderer.draw_picture(&mut picture);
            assert!(facts.coverage.covered > 10_000);
            COUNT.get()
        };
        let [first, second] = pool.install(|| [frame(), frame()]);
        assert_eq!(second - first, 0, "{name}, {:?}", style.buffer);
    }
}

#[test]
fn a_cancelled_frame_is_an_error_and_the_next_one_is_whole() {
    let scene = synthetic::random_gaussians(3_000, 1, 2.0);
    let camera = synthetic::camera(301, 203);
    let settings = Settings::new(Rules::GAUSSIAN_3D);
    let mut renderer = Renderer::new(&scene, &camera, settings)
        .with_threads(2)
        .unwrap();
    let mut expected = vec![[0.0f32; 4]; 301 * 203];
    renderer.draw_floats(&mut expected, &|_, _| true).unwrap();
    let mut frame = vec![[0.0f32; 4]; 301 * 203];
    let cancelled = renderer.draw_floats(&mut frame, &|done, _| done < 3);
    assert_eq!(cancelled.unwrap_err().to_string(), "drawing was cancelled");
    assert!(frame.iter().all(|pixel| *pixel == [0.0; 4]));
    renderer.draw_floats(&mut frame, &|_, _| true).unwrap();
    assert!(frame == expected);
    let short = renderer.draw_floats(&mut frame[1..], &|_, _| true);
    let message = short.unwrap_err().to_string();
    assert!(message.contains("301 x 203"), "{message}");
}
