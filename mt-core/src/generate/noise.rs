//! Fractal noise in space.

use crate::random::{Random, scramble};
use glam::{DVec3, IVec3};

/// A smooth step from 0 to 1 whose first two derivatives vanish at both ends.
pub(super) fn fade(t: f64) -> f64 {
    t * t * t * (t * (t * 6.0 - 15.0) + 10.0)
}

/// Fractal noise: octaves of lattice noise, each twice as fine as the one before and weaker by `persistence`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fractal {
    /// Lattice cells per unit length in the coarsest octave.
    pub(super) frequency: f64,
    /// How many octaves.
    pub(super) octaves: u32,
    /// Amplitude of an octave over that of the octave before.
    pub(super) persistence: f64,
    /// Which noise.
    pub(super) seed: u64,
}

impl Fractal {
    /// The noise at `p`, in [-1, 1].
    pub(super) fn at(&self, p: DVec3) -> f64 {
        let (mut sum, mut weight, mut total, mut frequency) = (0.0, 1.0, 0.0, self.frequency);
        let mut rng = Random::new(self.seed);
        for _ in 0..self.octaves {
            // A shift per octave, or the lattices of all octaves would line up and show.
            let shift = DVec3::new(rng.unit(), rng.unit(), rng.unit()) * 64.0;
            sum += weight * lattice_noise(p * frequency + shift, rng.bits());
            total += weight;
            weight *= self.persistence;
            frequency *= 2.0;
        }
        if total > 0.0 { sum / total } else { 0.0 }
    }
}

/// Random values on the integer lattice, blended smoothly in between; in [-1, 1].
fn lattice_noise(p: DVec3, seed: u64) -> f64 {
    let floor = p.floor();
    let corner = floor.as_ivec3();
    let t = p - floor;
    let (fx, fy, fz) = (fade(t.x), fade(t.y), fade(t.z));
    let at = |x, y, z| lattice_value(corner + IVec3::new(x, y, z), seed);
    let along_x = |y, z| blend(at(0, y, z), at(1, y, z), fx);
    let along_y = |z| blend(along_x(0, z), along_x(1, z), fy);
    blend(along_y(0), along_y(1), fz)
}

/// The value at a lattice point, in [-1, 1].
fn lattice_value(p: IVec3, seed: u64) -> f64 {
    let x = u64::from(p.x as u32).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let y = u64::from(p.y as u32).wrapping_mul(0xc2b2_ae3d_27d4_eb4f);
    let z = u64::from(p.z as u32).wrapping_mul(0x1656_67b1_9e37_79f9);
    let hash = scramble(seed ^ x.wrapping_add(y).wrapping_add(z));
    (hash >> 11) as f64 / (1u64 << 52) as f64 - 1.0
}

pub(super) fn blend(a: f64, b: f64, t: f64) -> f64 {
    a + (b - a) * t
}
