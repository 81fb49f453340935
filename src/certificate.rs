//! Certificates as files: what was asked for, and why each node of the front is refined. Whoever has the model can check
//! one without the engine that made it.

use crate::files::{self, FileError};
use glam::Vec3;
use mt_core::check::{Breach, Certificate, Law, is_least};
use mt_core::{Bound, Camera, Front, MultiTessellation, NodeId, Rule};
use selective::{Criterion, InRegion, Region, ScreenError, UniformError, Wish, certify};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// A certificate with what it is of.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Document {
    /// Version of the format.
    certificate: u32,
    /// Number of modifications of the model.
    nodes: u32,
    wish: Asked,
    entries: Certificate,
}

/// What was asked for, in numbers.
#[derive(Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum Asked {
    /// An error everywhere.
    Uniform { error_max: f32 },
    /// An error within a box.
    Region { low: Vec3, high: Vec3, error_max: f32 },
    /// An error on a screen.
    Screen { camera: Camera, error_px: f32 },
}

impl Asked {
    /// As a criterion.
    pub fn wish(&self) -> Wish {
        match *self {
            Asked::Uniform { error_max } => Wish::Uniform(UniformError { error_max }),
            Asked::Region { low, high, error_max } => {
                Wish::Region(InRegion { region: Region { low, high }, error_max })
            }
            Asked::Screen { camera, error_px } => Wish::Screen(Box::new(ScreenError::new(&camera, error_px))),
        }
    }
}

/// The certificate of a front that was extracted for a wish without limits.
pub fn of_front(
    model: &impl MultiTessellation<3, Bound = Bound>,
    wish: Asked,
    front: &Front,
) -> Result<Document, Breach> {
    check_static(model)?;
    let criterion = wish.wish();
    let asked = |m: NodeId| criterion.asks(&model.bound(m), false);
    let entries = certify(&mt_core::check::order_of(model)?, &asked, front)?;
    Ok(Document { certificate: 1, nodes: model.len(), wish, entries })
}

/// A certificate speaks of an order, and a dynamic rule has none.
fn check_static<M: MultiTessellation<3>>(_: &M) -> Result<(), Breach> {
    let what = "what steps wait for depends on the mesh here, so there is no least front to certify";
    match M::RULE {
        Rule::Static => Ok(()),
        Rule::Dynamic => Err(Breach { law: Law::Minimality, node: None, what: what.into() }),
    }
}

/// Writes a certificate as JSON.
pub fn write(path: &Path, document: &Document) -> Result<(), FileError> {
    let text = serde_json::to_vec(document).map_err(|error| FileError::new(path, error))?;
    files::write_bytes(path, &text)
}

/// Reads a certificate and judges it by the order and the wish alone. Gives the number of nodes that it is of.
pub fn check(path: &Path, model: &impl MultiTessellation<3, Bound = Bound>) -> Result<usize, FileError> {
    let document: Document = files::load_json(path)?;
    let wrong = |what: String| FileError::new(path, what);
    if document.certificate != 1 {
        return Err(wrong(format!("version {} of certificates is not known, only 1", document.certificate)));
    }
    if document.nodes != model.len() {
        let (told, found) = (document.nodes, model.len());
        return Err(wrong(format!("it is a certificate of a model of {told} modifications, not of {found}")));
    }
    if let Asked::Screen { camera, .. } = &document.wish {
        camera.check().map_err(|error| wrong(error.to_string()))?;
    }
    let order = check_static(model).and_then(|()| mt_core::check::order_of(model));
    let order = order.map_err(|breach| wrong(breach.what))?;
    let criterion = document.wish.wish();
    let asked = |m: NodeId| criterion.asks(&model.bound(m), false);
    is_least(&order, &asked, &document.entries)
        .map_err(|breach| wrong(format!("it proves nothing: {}", breach.what)))?;
    Ok(document.entries.entries.len())
}
