//! Every criterion without memory is monotone in the bound: what contains another bound asks for at least as much.

use super::*;
use glam::Vec3;
use mt_core::{Bound, Camera, Cone};
use proptest::prelude::*;
use std::sync::Arc;

/// A bound with every normal.
pub(super) fn ball(center: Vec3, radius: f32, error: f32) -> Bound {
    Bound { center, radius, error, cone: Cone::ALL }
}

/// A bound with an error of 1 and normals about `normal`.
pub(super) fn patch(center: Vec3, radius: f32, normal: Vec3, angle: f32) -> Bound {
    Bound { center, radius, error: 1.0, cone: Cone::new(normal, angle) }
}

pub(super) fn point() -> impl Strategy<Value = Vec3> {
    prop::array::uniform3(-10f32..10.0).prop_map(Vec3::from)
}

fn direction() -> impl Strategy<Value = Vec3> {
    prop::array::uniform3(-1f32..1.0).prop_filter_map("no direction", |v| Vec3::from(v).try_normalize())
}

/// Bounds of all sizes, most of them small, so that containment decides; some without normals.
fn bound() -> impl Strategy<Value = Bound> {
    let radius = (-8f32..1.5).prop_map(|power| 10f32.powf(power));
    let cone = prop_oneof![
        8 => (direction(), 0f32..1.6).prop_map(|(axis, angle)| Cone::new(axis, angle)),
        1 => Just(Cone::ALL),
        1 => Just(Cone::EMPTY),
    ];
    (point(), radius, 0f32..2.0, cone).prop_map(|(center, radius, error, cone)| Bound { center, radius, error, cone })
}

/// A bound close to another, as those of one patch are.
fn pair() -> impl Strategy<Value = (Bound, Bound)> {
    let near = (bound(), bound(), 0f32..3.0, any::<bool>()).prop_map(|(a, b, share, same)| {
        let center = a.center + (b.center - a.center).normalize_or_zero() * a.radius * share;
        (a, Bound { center, cone: if same { a.cone } else { b.cone }, ..b })
    });
    prop_oneof![(bound(), bound()), near]
}

fn camera() -> impl Strategy<Value = Camera> {
    (point(), direction(), 5f32..120.0).prop_map(|(eye, way, fov_y_degrees)| Camera {
        eye,
        target: eye + way,
        up: way.any_orthonormal_vector(),
        fov_y_degrees,
        near: 0.01,
        far: 15.0,
        width_px: 640,
        height_px: 480,
    })
}

fn transfer(eye: Vec3, pixels_per_unit: f32, mut at: Vec<f32>, mut to: Vec<f32>, by_size: bool) -> Transfer {
    at.sort_by(f32::total_cmp);
    at.dedup();
    to.sort_by(f32::total_cmp);
    if by_size {
        to.reverse();
    }
    let measure = if by_size { Measure::SizePx { pixels_per_unit, near: 0.01 } } else { Measure::Distance };
    let scale = if by_size { 100.0 } else { 1.0 };
    Transfer::new(eye, measure, at.into_iter().map(|at| at * scale).zip(to).collect()).unwrap()
}

fn simple(camera: Camera) -> impl Strategy<Value = Wish> {
    let eye = camera.eye;
    let pixels = camera.pixels_per_unit();
    let visual = (direction(), 0f32..0.9, 0.01f32..3.0, 0f32..0.1, any::<bool>()).prop_map(
        move |(light, epsilon, scale, error_min, as_error)| {
            let reading = if as_error { Reading::Error } else { Reading::Tolerance };
            Wish::Visual(Box::new(VisualError { eye, light, epsilon, scale, error_min, reading }))
        },
    );
    let knots = (prop::collection::vec(0f32..20.0, 5), prop::collection::vec(0f32..1.0, 5), any::<bool>());
    let features =
        (prop::collection::vec(point(), 0..20), 0f32..1.0, 0f32..1.0).prop_map(|(points, error_at, more)| {
            let points = Arc::new(PointIndex::new(points));
            Wish::Features(Box::new(FeaturePoints { points, error_at, error_max: error_at + more }))
        });
    prop_oneof![
        (0f32..2.0).prop_map(|error_max| Wish::Uniform(UniformError { error_max })),
        (point(), point(), 0f32..2.0).prop_map(|(a, b, error_max)| {
            Wish::Region(InRegion { region: Region { low: a.min(b), high: a.max(b) }, error_max })
        }),
        (0f32..500.0).prop_map(move |error| Wish::Screen(Box::new(ScreenError::new(&camera, error)))),
        knots.prop_map(move |(at, to, by_size)| Wish::Transfer(Box::new(transfer(eye, pixels, at, to, by_size)))),
        visual,
        features,
        (0f32..3.2).prop_map(|angle_max| Wish::Normals(NormalChange { angle_max })),
    ]
}

fn wish() -> impl Strategy<Value = Wish> {
    camera().prop_flat_map(|camera| {
        let eye = camera.eye;
        let frustum = Frustum::new(&camera);
        prop_oneof![
            4 => simple(camera),
            1 => simple(camera).prop_map(move |criterion| Wish::InView(Box::new(InView { frustum, criterion }))),
            2 => simple(camera).prop_map(move |criterion| Wish::Facing(Box::new(Facing { eye, criterion }))),
            2 => (simple(camera), simple(camera)).prop_map(move |(outline, elsewhere)| {
                Wish::Silhouette(Box::new(Silhouette { eye, outline, elsewhere }))
            }),
            1 => (simple(camera), 0f32..2.0)
                .prop_map(|(criterion, speed)| Wish::Moving(Box::new(Moving::new(criterion, 2.0, speed, 4.0)))),
            1 => prop::collection::vec(simple(camera), 0..3).prop_map(Wish::Any),
        ]
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 20_000, ..ProptestConfig::default() })]

    #[test]
    fn what_contains_another_asks_for_at_least_as_much((a, b) in pair(), wish in wish()) {
        let mut both = a;
        both.include(&b);
        for part in [a, b] {
            let (whole, part) = (wish.excess(&both, false), wish.excess(&part, false));
            prop_assert!(whole >= part, "{}: {whole} of {both:?}, {part} of a part", wish.name());
        }
    }

    #[test]
    fn a_larger_tolerance_asks_for_no_more(bound in bound(), wish in wish(), by in 1f32..9.0) {
        let mut relaxed = wish.clone();
        relaxed.relax(by);
        prop_assert!(relaxed.excess(&bound, false) <= wish.excess(&bound, false), "{}", wish.name());
    }

    #[test]
    fn whether_it_asks_is_whether_it_exceeds(bound in bound(), wish in wish(), margin in 0f32..1.0) {
        for refined in [false, true] {
            prop_assert_eq!(wish.asks(&bound, refined), wish.excess(&bound, refined) > 0.0, "{}", wish.name());
            let hesitant = Hysteresis { criterion: &wish, margin };
            prop_assert_eq!(hesitant.asks(&bound, refined), hesitant.excess(&bound, refined) > 0.0);
        }
    }

    #[test]
    fn hysteresis_keeps_a_margin(bound in bound(), wish in wish(), margin in 0f32..1.0) {
        let plain = wish.excess(&bound, false);
        let hesitant = Hysteresis { criterion: wish, margin };
        prop_assert_eq!(hesitant.excess(&bound, false), plain);
        prop_assert_eq!(hesitant.asks(&bound, true), plain + margin > 0.0);
    }
}

#[test]
fn relaxing_a_negative_tolerance_still_asks_for_everything() {
    let mut everything = UniformError { error_max: -1.0 };
    everything.relax(4.0);
    assert!(everything.asks(&ball(Vec3::ZERO, 1.0, 0.0), false));
}
