//! What a view asks for: a criterion of any kind, made of a few small numbers.

use glam::Vec3;
use mt_core::{Bound, Camera};
use selective::{
    Facing, FeaturePoints, Frustum, InRegion, InView, Limits, Measure, Moving, NormalChange, Path, Reading, Region,
    ScreenError, Silhouette, Transfer, UniformError, VisualError, Wish,
};
use std::time::Duration;

/// What has been chosen for a view.
#[derive(Clone, Copy, Debug, Default)]
pub struct Asking {
    /// Kind of criterion.
    pub kind: u8,
    /// How strict, and a hair to either side of a tie.
    pub level: (u8, i8),
    /// Where the camera is.
    pub camera: (u8, u8),
    /// Margin of hysteresis.
    pub margin: Option<u8>,
    /// Path of runs.
    pub path: Option<u8>,
    /// Share of the cells of the input, in 255ths.
    pub cells: Option<u8>,
    /// Whether there is no time at all.
    pub hurried: bool,
}

/// Where a model is, and which errors it knows.
#[derive(Clone, Debug)]
pub struct Scene {
    low: Vec3,
    high: Vec3,
    positions: Vec<Vec3>,
    /// Ascending, each once.
    errors: Vec<f32>,
    cells: u32,
}

impl Scene {
    /// The scene of an input and of the bounds of its model.
    pub fn new(positions: &[Vec3], cells: usize, bounds: impl Iterator<Item = Bound>) -> Self {
        let low = positions.iter().copied().reduce(Vec3::min).unwrap_or_default();
        let high = positions.iter().copied().reduce(Vec3::max).unwrap_or_default();
        let mut errors: Vec<f32> = bounds.map(|bound| bound.error).collect();
        errors.sort_by(f32::total_cmp);
        errors.dedup();
        Self { low, high, positions: positions.to_vec(), errors, cells: cells as u32 }
    }

    fn camera(&self, (turn, distance): (u8, u8)) -> Camera {
        let turn = f32::from(turn) / 32.0 * std::f32::consts::TAU;
        let around = Camera::around(self.low, self.high, Vec3::new(turn.sin(), 0.3, turn.cos()));
        let nearer = (around.target - around.eye) * (0.15 * f32::from(distance));
        let near = around.near * 0.1;
        Camera { eye: around.eye + nearer, target: around.target + nearer, near, fov_y_degrees: 30.0, ..around }
    }

    /// An error of the model, or a hair beside it.
    fn error(&self, (level, hair): (u8, i8)) -> f32 {
        let error = self.errors.get(usize::from(level) % self.errors.len().max(1)).copied().unwrap_or(0.0);
        match hair {
            0 => error,
            1.. => error.next_up(),
            _ => error.next_down(),
        }
    }

    /// The criterion without memory and path.
    pub fn wish(&self, asking: &Asking) -> Wish {
        let (camera, error_max) = (self.camera(asking.camera), self.error(asking.level));
        let (eye, size) = (camera.eye, self.high - self.low);
        let uniform = Wish::Uniform(UniformError { error_max });
        let pixels = 0.05 * 1.5f32.powi(i32::from(asking.level.0 % 24));
        let screen = |factor: f32| Wish::Screen(Box::new(ScreenError::new(&camera, pixels * factor)));
        let visual = |reading, scale| VisualError { eye, light: Vec3::Y, epsilon: 0.1, scale, error_min: 0.0, reading };
        let apart = eye.distance((self.low + self.high) * 0.5);
        let knots = |a: f32, b: f32| vec![(apart * 0.5, a), (apart, error_max.max(0.0)), (apart * 1.5, b)];
        let per_pixel = Measure::SizePx { pixels_per_unit: camera.pixels_per_unit(), near: camera.near };
        let most = error_max.max(0.0) * 2.0 + 1e-3;
        let region = Region { low: self.low, high: self.low + size * (f32::from(asking.camera.0) / 32.0) };
        let within = InRegion { region, error_max };
        match asking.kind % 13 {
            0 => uniform,
            1 => Wish::Region(within),
            2 => screen(1.0),
            3 => Wish::Transfer(Box::new(Transfer::new(eye, Measure::Distance, knots(0.0, most)).expect("monotone"))),
            4 => {
                let sizes = vec![(10.0, most), (100.0, error_max.max(0.0)), (500.0, 0.0)];
                Wish::Transfer(Box::new(Transfer::new(eye, per_pixel, sizes).expect("monotone")))
            }
            5 => Wish::Visual(Box::new(visual(Reading::Tolerance, 0.01 * pixels))),
            6 => Wish::Visual(Box::new(visual(Reading::Error, 0.001 * pixels))),
            7 => {
                Wish::Features(Box::new(FeaturePoints::pick(&self.positions, |i| i % 7 == 3, -1.0, error_max.max(0.0))))
            }
            8 => Wish::Normals(NormalChange { angle_max: 0.05 * f32::from(asking.level.0 % 64) }),
            9 => Wish::InView(Box::new(InView { frustum: Frustum::new(&camera), criterion: uniform })),
            10 => Wish::Facing(Box::new(Facing { eye, criterion: uniform })),
            11 => Wish::Silhouette(Box::new(Silhouette { eye, outline: uniform, elsewhere: screen(4.0) })),
            _ => {
                let moving = Moving::new(screen(1.0), 5.0, 0.1 * apart, apart);
                Wish::Any(vec![Wish::Moving(Box::new(moving)), Wish::Region(within)])
            }
        }
    }

    /// The path that runs take.
    pub fn path(&self, asking: &Asking) -> Option<Path> {
        let eye = self.camera(asking.camera).eye;
        let beyond = eye.distance((self.low + self.high) * 0.5);
        asking
            .path
            .map(|path| [Path::Fine, Path::Difference, Path::Distance { eye, beyond }, Path::Coarse][path as usize % 4])
    }

    /// What the engine may use.
    pub fn limits(&self, asking: &Asking) -> Limits {
        let share = |share: u8| (u64::from(self.cells) * u64::from(share) / 255) as u32;
        Limits { cells: asking.cells.map(share), time: asking.hurried.then_some(Duration::ZERO) }
    }
}
