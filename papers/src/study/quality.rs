//! Distances of extracted meshes to the input, by size.

use super::{Config, Quality, Results, Subject};
use crate::distance::{Sampling, Surface};
use mt_core::model::mesh_of;
use mt_core::{Explicit, MultiTessellation, NodeId};
use selective::{Limits, Strategy, UniformError, extract};

/// Shares of the input's triangles at which meshes are measured.
const SHARES: [f64; 5] = [0.5, 0.25, 0.1, 0.05, 0.01];

/// Measures a model at several sizes.
pub(super) fn measure(subject: &Subject, operator: &str, model: &Explicit<3>, config: &Config, results: &mut Results) {
    let diagonal = subject.mesh.diagonal().max(f64::MIN_POSITIVE);
    // A mesh without triangles has nothing to measure to.
    let Ok(input) = Surface::new(&subject.mesh) else { return };
    for share in SHARES {
        let cells = (subject.mesh.cell_count() as f64 * share) as u32;
        if (cells as usize) < model.base_cells().len() {
            continue;
        }
        let limits = Limits { cells: Some(cells), time: None };
        // Below 0, so that what costs no error fills the budget too.
        let (state, _) = extract(model, &UniformError { error_max: -1.0 }, &limits, Strategy::Priority, ());
        let mesh = mesh_of(model, &state.view.mesh);
        let Ok(surface) = Surface::new(&mesh) else { continue };
        let apart = surface.distance(&input, Sampling { count: config.samples, seed: 1 });
        let unrefined = (0..model.len()).map(NodeId).filter(|&m| !state.front().is_refined(m));
        let stated = unrefined.map(|m| model.bound(m).error).fold(0.0, f32::max);
        results.qualities.push(Quality {
            model: subject.name.clone(),
            operator: operator.to_owned(),
            triangles: state.cell_count(model),
            share,
            rms: apart.rms() / diagonal,
            max: apart.maximum() / diagonal,
            stated: f64::from(stated) / diagonal,
        });
    }
}
