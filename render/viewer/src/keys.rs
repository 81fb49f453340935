//! What can be done, and the keys for it: one table for keyboard, help and buttons.

use eframe::egui::Key;

/// Something that a key or a button does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Action {
    /// Shows or hides the keys.
    Help,
    /// Keeps the eye that the mesh is made for, and leaves with the camera; or comes back.
    Freeze,
    /// Orbit or fly.
    Flight,
    /// Sees the whole model.
    Fit,
    /// The triangles' edges.
    Wire,
    /// The next tint.
    NextTint,
    /// Boundary, edges of more than two triangles, cracks.
    Edges,
    /// The outline.
    Outline,
    /// Dual pieces over the input.
    Pieces,
    /// The next dependency scheme.
    NextScheme,
    /// The one before.
    LastScheme,
    /// The next operator.
    NextOperator,
    /// The next criterion.
    NextCriterion,
    /// The next strategy.
    NextStrategy,
    /// Asks for less error.
    Finer,
    /// Asks for more.
    Coarser,
    /// A second pane beside the first, or back to one.
    Split,
    /// What is chosen is for the other pane.
    OtherPane,
    /// One step back in the log.
    StepBack,
    /// One step forward.
    StepForward,
    /// One frame back.
    FrameBack,
    /// One frame forward.
    FrameForward,
    /// Plays the log, frame after frame, or stops.
    PlayLog,
    /// Back to the present.
    Now,
    /// Records the camera, or stops.
    Record,
    /// Follows the camera path, or stops.
    Follow,
    /// Points at what is in the middle.
    Pick,
    /// Points at nothing.
    Unpick,
    /// Writes the picture of the pane, with all that makes it again.
    SavePicture,
    /// Writes a picture of the window.
    SaveWindow,
    /// Writes the camera path.
    SavePath,
    /// Writes the log.
    SaveLog,
    /// Closes the window.
    Quit,
}

/// A key, whether with shift, what it does, and in words.
pub struct Binding {
    /// The key.
    pub key: Key,
    /// Whether shift is held.
    pub shift: bool,
    /// What it does.
    pub action: Action,
    /// In words.
    pub told: &'static str,
}

const fn bind(key: Key, shift: bool, action: Action, told: &'static str) -> Binding {
    Binding { key, shift, action, told }
}

/// All bindings, in the order of the help.
pub const BINDINGS: [Binding; 33] = [
    bind(Key::H, false, Action::Help, "this help (also ?)"),
    bind(Key::F, false, Action::Freeze, "freeze the front and leave it, or come back"),
    bind(Key::G, false, Action::Flight, "orbit or fly"),
    bind(Key::Home, false, Action::Fit, "see the whole model"),
    bind(Key::W, true, Action::Wire, "edges of the triangles"),
    bind(Key::T, false, Action::NextTint, "next colours: error, level, normals, operations, forced, fans"),
    bind(Key::B, false, Action::Edges, "boundary blue, edges of many triangles violet, cracks red"),
    bind(Key::O, false, Action::Outline, "outline"),
    bind(Key::U, false, Action::Pieces, "dual pieces over the input"),
    bind(Key::N, false, Action::NextScheme, "next dependency scheme"),
    bind(Key::N, true, Action::LastScheme, "the one before"),
    bind(Key::M, false, Action::NextOperator, "next operator"),
    bind(Key::C, false, Action::NextCriterion, "next criterion"),
    bind(Key::V, false, Action::NextStrategy, "next strategy"),
    bind(Key::CloseBracket, false, Action::Finer, "finer"),
    bind(Key::OpenBracket, false, Action::Coarser, "coarser"),
    bind(Key::Num2, false, Action::Split, "two panes, or one"),
    bind(Key::X, false, Action::OtherPane, "choose for the other pane"),
    bind(Key::Comma, false, Action::StepBack, "one modification back"),
    bind(Key::Period, false, Action::StepForward, "one modification forward"),
    bind(Key::PageUp, false, Action::FrameBack, "one frame back"),
    bind(Key::PageDown, false, Action::FrameForward, "one frame forward"),
    bind(Key::J, false, Action::PlayLog, "play the log, frame after frame, or stop"),
    bind(Key::Enter, false, Action::Now, "back to the present"),
    bind(Key::R, false, Action::Record, "record the camera's path, or stop"),
    bind(Key::Space, false, Action::Follow, "follow the path, or stop"),
    bind(Key::I, false, Action::Pick, "inspect what is in the middle (or click)"),
    bind(Key::Escape, false, Action::Unpick, "close this help, or inspect nothing"),
    bind(Key::P, false, Action::SavePicture, "save the picture, with what makes it again"),
    bind(Key::P, true, Action::SaveWindow, "save the whole window"),
    bind(Key::K, false, Action::SavePath, "save the path, as studies and movies take it"),
    bind(Key::L, false, Action::SaveLog, "save the log, as bisect takes it"),
    bind(Key::Q, true, Action::Quit, "quit"),
];

/// What is held down to move, for the help.
pub const HELD: [(&str, &str); 4] = [
    ("arrows, drag", "turn"),
    ("w a s d, e q, right drag", "move: forward, left, back, right, up, down"),
    ("+ -, wheel", "nearer, farther"),
    ("Ctrl + or -", "larger or smaller letters"),
];

/// The keys of an action, as written.
pub fn written(binding: &Binding) -> String {
    let name = binding.key.symbol_or_name();
    if binding.shift { format!("Shift {name}") } else { name.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    #[test]
    fn no_key_does_two_things_and_none_that_moves() {
        let keys: HashSet<_> = BINDINGS.iter().map(|b| (b.key, b.shift)).collect();
        assert_eq!(keys.len(), BINDINGS.len());
        let actions: HashSet<_> = BINDINGS.iter().map(|b| b.action).collect();
        assert_eq!(actions.len(), BINDINGS.len());
        let moving = [Key::W, Key::A, Key::S, Key::D, Key::E, Key::Q, Key::Plus, Key::Minus];
        assert!(BINDINGS.iter().all(|b| b.shift || !moving.contains(&b.key)));
    }
}
