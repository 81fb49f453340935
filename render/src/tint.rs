//! What the colours of a view's triangles tell: error, level, what steps did, what was forced, how far fans have come.

use crate::inspect::{Fan, Index, Inspect};
use crate::live::Placed;
use crate::ramp::{Ramp, Rgba};
use crate::scene::{Legend, Look, Overlay, Scene, encode};
use glam::{DVec3, Vec3};
use mt_core::mesh::area_vector;
use mt_core::{Cell, CellId, Front, Mesh, MultiTessellation, NodeId, Step};
use std::collections::HashMap;

/// What the triangles' colours tell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tint {
    /// Nothing: the material's own colour.
    #[default]
    Plain,
    /// The largest error of the coarse nodes that would refine a triangle, in model units.
    Error,
    /// The longest chain of needs down to the node that a triangle came with.
    Level,
    /// Its normal: coordinates as red, green and blue.
    Normals,
    /// What the last steps did, as in `[LivnySokolovskyElSana2006]`, Fig. 8: black by edges, dark grey by fans, light grey
    /// where nothing happened.
    Operations,
    /// Red where a triangle came with a node that nobody asked for, but others needed.
    Forced,
    /// Blue around vertices of whole fans, orange around those of partial ones.
    Fans,
}

const BY_FAN: Rgba = [118, 118, 120, 255];
const BY_EDGE: Rgba = [24, 24, 26, 255];
const UNTOUCHED: Rgba = [214, 214, 216, 255];
const FORCED: Rgba = [214, 76, 66, 255];
const ASKED: Rgba = [206, 214, 206, 255];
const WHOLE_FAN: Rgba = [86, 140, 200, 255];
const PARTIAL_FAN: Rgba = [232, 150, 60, 255];

impl Tint {
    /// All of them.
    pub const ALL: [Self; 7] =
        [Self::Plain, Self::Error, Self::Level, Self::Normals, Self::Operations, Self::Forced, Self::Fans];

    /// Its name in commands and windows.
    pub fn name(self) -> &'static str {
        match self {
            Self::Plain => "plain",
            Self::Error => "error",
            Self::Level => "level",
            Self::Normals => "normals",
            Self::Operations => "operations",
            Self::Forced => "forced",
            Self::Fans => "fans",
        }
    }
}

/// A view, and what besides its front some tints tell of.
pub struct Seen<'a, M: Inspect> {
    /// The model.
    pub model: &'a M,
    /// What its answers need.
    pub index: &'a Index<M>,
    /// The refined nodes.
    pub front: &'a Front,
    /// Whether a node is asked for.
    pub asks: &'a dyn Fn(NodeId) -> bool,
    /// The last steps.
    pub steps: &'a [Step],
}

/// The colour of any triangle of a view, and what the colours say.
pub struct Tinting<'a> {
    /// A bar for the colours, where they stand for numbers.
    pub legend: Option<Legend>,
    colour: Box<dyn Fn(Placed) -> Rgba + 'a>,
}

impl Tinting<'_> {
    /// The colour of a triangle of the view.
    pub fn colour(&self, placed: Placed) -> Rgba {
        (self.colour)(placed)
    }
}

impl<'a, M: Inspect> Seen<'a, M> {
    /// The colours of a tint; `triangles` are those of the view, by which numbers are scaled, and `plain` is the material's
    /// colour. O(triangles).
    pub fn tinting(&self, tint: Tint, triangles: impl Iterator<Item = Placed>, plain: Rgba) -> Tinting<'a> {
        let &Seen { model, index, front, asks, .. } = self;
        let nodes_with = move |placed: Placed| {
            placed.corners.map(|v| index.came_with(model, placed.cell, v, front)).into_iter().flatten()
        };
        let colour: Box<dyn Fn(Placed) -> Rgba + 'a> = match tint {
            Tint::Plain => Box::new(move |_| plain),
            Tint::Error => {
                let error = move |placed: Placed| {
                    let of = |v| model.refined_by(placed.cell, v, front).map_or(0.0, |m| model.bound(m).error);
                    placed.corners.map(of).into_iter().fold(0.0, f32::max)
                };
                return scaled(Ramp::Plasma, "error", triangles, error);
            }
            Tint::Level => {
                let levels = index.levels(model);
                let level =
                    move |placed: Placed| nodes_with(placed).map(|m| levels[m.index()]).max().unwrap_or(0) as f32;
                return scaled(Ramp::Viridis, "level", triangles, level);
            }
            Tint::Normals => {
                Box::new(move |placed| normal_colour(placed.corners.map(|v| model.positions()[v.index()])))
            }
            Tint::Operations => {
                let by_fan = by_fans(model, self.steps);
                let by: HashMap<NodeId, bool> = self.steps.iter().map(|step| step.node).zip(by_fan).collect();
                Box::new(move |placed| {
                    let coarse = placed.corners.map(|v| model.refined_by(placed.cell, v, front)).into_iter().flatten();
                    let met = nodes_with(placed).chain(coarse).filter_map(|m| by.get(&m));
                    // An edge shows where both met.
                    met.min().map_or(UNTOUCHED, |&by_fan| if by_fan { BY_FAN } else { BY_EDGE })
                })
            }
            Tint::Forced => Box::new(move |placed| if nodes_with(placed).all(asks) { ASKED } else { FORCED }),
            Tint::Fans => Box::new(move |placed| {
                let fans = placed.corners.map(|v| model.fan(v, front));
                let has = |fan| fans.contains(&fan);
                if has(Fan::Partial) {
                    PARTIAL_FAN
                } else if has(Fan::Whole) {
                    WHOLE_FAN
                } else {
                    UNTOUCHED
                }
            }),
        };
        Tinting { legend: None, colour }
    }
}

impl<M: Inspect> Seen<'_, M> {
    /// The view as a scene: these cells, with the colours of a tint. O(vertices of the model).
    pub fn encode(&self, tint: Tint, cells: &[(CellId, Cell<3>)], wireframe: bool) -> Scene {
        let placed = cells.iter().map(|&(cell, corners)| Placed { cell, corners });
        let material = Look::default().material;
        let tinting = self.tinting(tint, placed.clone(), material);
        let colours: Vec<Rgba> = placed.map(|placed| tinting.colour(placed)).collect();
        let cells = cells.iter().map(|(_, corners)| *corners).collect();
        let mesh = Mesh { positions: self.model.positions().to_vec(), cells }.compact();
        let look = Look { wireframe, overlay: Overlay::Colours(&colours), ..Look::default() };
        Scene { legend: tinting.legend, ..encode(&mesh, &look) }
    }
}

/// Colours by numbers from 0 to the largest, rounded up so that it does not change from frame to frame.
fn scaled<'a>(
    ramp: Ramp,
    caption: &'static str,
    triangles: impl Iterator<Item = Placed>,
    value: impl Fn(Placed) -> f32 + 'a,
) -> Tinting<'a> {
    let largest = triangles.map(&value).filter(|value| value.is_finite()).fold(0.0, f32::max);
    let legend = Legend { ramp, range: (0.0, rounded_up(largest)), caption };
    Tinting { legend: Some(legend), colour: Box::new(move |placed| legend.colour(value(placed))) }
}

/// The next of 1, 2, 5, 10, 20 .. of its size; 1 for 0.
fn rounded_up(value: f32) -> f32 {
    if value <= 0.0 || !value.is_finite() {
        return 1.0;
    }
    let power = 10f64.powf(f64::from(value).log10().floor());
    let steps = [1.0, 2.0, 5.0, 10.0].map(|factor| (factor * power) as f32);
    steps.into_iter().find(|&step| step >= value).unwrap_or(value)
}

/// The colour of a normal.
pub(crate) fn normal_colour(corners: [Vec3; 3]) -> Rgba {
    let normal: DVec3 = area_vector(corners.map(Vec3::as_dvec3)).normalize_or_zero();
    let [red, green, blue] = normal.to_array().map(|x| (127.5 + 110.0 * x) as u8);
    [red, green, blue, 255]
}

/// Of each step whether it came about by a fan: all of its run was changed one way.
pub fn by_fans<const N: usize, M: MultiTessellation<N>>(model: &M, steps: &[Step]) -> Vec<bool> {
    let key = |step: &Step| (*model.run(step.node).start(), step.refined);
    let mut counts = HashMap::new();
    steps.iter().for_each(|step| *counts.entry(key(step)).or_insert(0u32) += 1);
    let by_fan = |step: &Step| {
        let run = model.run(step.node);
        let length = run.end().0 - run.start().0 + 1;
        length > 1 && counts[&key(step)] == length
    };
    steps.iter().map(by_fan).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scales_are_round() {
        for (value, up) in
            [(0.0, 1.0), (0.7, 1.0), (1.0, 1.0), (1.2, 2.0), (31.0, 50.0), (0.0011, 0.002), (70.0, 100.0)]
        {
            assert_eq!(rounded_up(value), up, "{value}");
        }
        assert_eq!(rounded_up(f32::NAN), 1.0);
        assert!(rounded_up(f32::MIN_POSITIVE) >= f32::MIN_POSITIVE && rounded_up(f32::MAX) >= 1e38);
    }
}
