//! What is written of a view: the picture, and beside it all that makes it again.

use crate::pane::Pane;
use crate::viewer::Viewer;
use mt_core::Camera;
use papers::study::{CriterionKind, DependencyKind, StrategyKind};
use render::Tint;
use serde_json::{Value, json};

/// A file to be written: its ending, and its bytes.
pub type File = (&'static str, Vec<u8>);

/// Writes files that belong together under one new name, that tells of which model they are and what; `NAME.` in texts of JSON
/// becomes that name. Gives the name, or says why not.
pub type Save = Box<dyn FnMut(usize, &str, &[File]) -> Result<String, String>>;

/// What is beside a picture: model, question, camera, counts, and the command that makes it again where one does.
pub fn facts(viewer: &Viewer, pane: &Pane, camera: &Camera) -> Value {
    let subject = viewer.subject(pane);
    let [refined, nodes] = pane.view.nodes();
    let (log, ask) = (pane.view.log(), &viewer.ask);
    json!({
        "model": subject.name,
        "operator": pane.choice.operator.as_ref().unwrap_or(&subject.made_by),
        "dependency": pane.choice.dependency.name(),
        "criterion": ask.criterion.name(),
        "strategy": ask.strategy.name(),
        "error_px": ask.error_px,
        "error_share": ask.error_share,
        "budget": ask.cells,
        "shown": {
            "wireframe": viewer.shown.wire,
            "tint": viewer.shown.tint.name(),
            "boundary": viewer.shown.edges,
            "outline": viewer.shown.outline,
            "pieces": viewer.shown.pieces && pane.has_pieces(),
        },
        "frozen": viewer.frozen.is_some(),
        "camera": camera,
        "eye": viewer.frozen.unwrap_or(*camera),
        "triangles": pane.view.places().triangle_count(),
        "triangles_in": subject.extent.cells,
        "nodes_refined": refined,
        "nodes": nodes,
        "steps_taken": pane.view.at(),
        "steps_in_log": log.steps.len(),
        "log_is_whole": pane.view.is_log_whole(),
        "held": pane.is_held,
        "picked": pane.picked.as_ref().map(|picked| json!({
            "cell": picked.placed.cell,
            "corner": picked.corner,
            "came_with": picked.came_with.map(|node| node.node),
            "refined_by": picked.refined_by.map(|node| node.node),
            "chain": picked.chain_length,
        })),
        "command": command(viewer, pane),
    })
}

/// The files of a picture: pixels, facts, and the cameras as `mtess render` takes them.
pub fn picture(viewer: &Viewer, pane: &Pane, camera: &Camera, png: Vec<u8>) -> Vec<File> {
    let text = |value: &Value| format!("{value:#}\n").into_bytes();
    let mut files =
        vec![("png", png), ("json", text(&facts(viewer, pane, camera))), ("camera.json", text(&json!(camera)))];
    if let Some(eye) = &viewer.frozen {
        files.push(("eye.json", text(&json!(eye))));
    }
    files
}

/// The command that draws the picture again, with `NAME` for the name of its files. None where the mesh depends on what was
/// there before, or where no option asks for the same.
fn command(viewer: &Viewer, pane: &Pane) -> Option<String> {
    let (ask, shown) = (&viewer.ask, &viewer.shown);
    let is_static = match pane.choice.dependency {
        DependencyKind::Cells => true,
        DependencyKind::Scheme(scheme) => scheme.is_static(),
    };
    let goes_afresh = match ask.strategy {
        StrategyKind::TopDown => true,
        // All ways lead to the same front of a static order.
        StrategyKind::Incremental | StrategyKind::Priority => is_static,
        _ => false,
    };
    // The last steps are known to the window alone, and so is what was pointed at; cells know of no fans.
    let has_colours = match shown.tint {
        Tint::Operations => false,
        Tint::Fans => pane.choice.dependency != DependencyKind::Cells,
        _ => true,
    };
    let is_told = has_colours && pane.picked.is_none() && !pane.is_held;
    if ask.criterion != CriterionKind::Screen || !goes_afresh || !is_told {
        return None;
    }
    let mut words = vec![format!("mtess render {}", (viewer.subject(pane).words)(&pane.choice)?)];
    let eye = if viewer.frozen.is_some() { "eye" } else { "camera" };
    words.push(format!("--camera NAME.{eye}.json --pixels {}", ask.error_px));
    words.extend(viewer.frozen.map(|_| "--look-from NAME.camera.json --frustum".to_owned()));
    let has_pieces = shown.pieces && pane.has_pieces();
    let overlays = [
        (shown.wire && !has_pieces, "wireframe"),
        (shown.edges, "boundary"),
        (shown.outline, "outline"),
        (has_pieces, "pieces"),
        (shown.tint != Tint::Plain && !has_pieces, shown.tint.name()),
    ];
    words.extend(overlays.iter().filter(|(on, _)| *on).map(|(_, name)| format!("--overlay {name}")));
    words.push("-o NAME.again.png".into());
    Some(words.join(" "))
}
