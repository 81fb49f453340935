//! A window on multi-tessellations: fly around, freeze the front and leave it, go back in time, ask what a step needs, and take
//! the picture home.
//!
//! ```text
//! keys, mouse ─▶ window ─ actions ─▶ Viewer { pilot, ask, panes { AnyView } } ─ frame ─▶ steps ─▶ Places ─▶ Stage ─▶ texture
//!                   ▲                                                      ─ scene ─▶ lines, colours ────────┘      │
//!                   └────────────────────────────────────────────────────────────────────────────────────────────┘
//! ```
//!
//! All but `window`, `panels` and `graph` knows neither window nor device (`keys` has the names of keys). No file is opened here: whoever opens the window
//! makes models and writes files.
//!
//! | room | what is there |
//! |---|---|
//! | `ask` | what is asked of every frame |
//! | `any_view` | a view whose model nobody needs to know, with its log |
//! | `pane`, `viewer` | panes, what they show and what can be done to them |
//! | `pilot`, `pick`, `marks` | the camera; what lies under a pixel; lines that tell of it |
//! | `keys` | actions and their keys |
//! | `saved` | what is written of a picture |
//! | `window`, `panels`, `graph` | egui, winit and the device |

mod any_view;
mod ask;
mod graph;
mod keys;
mod marks;
mod pane;
mod panels;
mod pick;
mod pilot;
mod saved;
mod viewer;
mod window;

pub use any_view::{AnyView, NodeFacts, Picked, ViewFrom, view_of};
pub use ask::{Ask, Asked, Extent};
pub use keys::{Action, BINDINGS, Binding};
pub use pane::{Choice, FrameFacts, Make, Pane, Subject, Version, Words};
pub use pick::{Hit, pick};
pub use pilot::{Flight, Pilot};
pub use saved::{File, Save};
pub use viewer::{Chore, Record, Shown, Viewer};

use eframe::egui;
use eframe::egui_wgpu::{WgpuConfiguration, WgpuSetup, WgpuSetupCreateNew};
use std::cell::RefCell;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::rc::Rc;
use std::sync::Arc;
use std::time::{Duration, Instant};
use window::{App, Held, Watched};

/// Why there is no window.
#[derive(Debug, thiserror::Error)]
pub enum ViewError {
    /// No display, no adapter, or the system would not open one.
    #[error("no window can be opened: {0}")]
    NoWindow(String),
    /// The device was lost again and again.
    #[error("the device was lost {0} times; the last picture is gone")]
    Lost(u32),
}

/// Devices that may be lost one shortly after the other before we give up.
const LOSSES_MAX: u32 = 3;
/// A window that lasts longer makes up for the losses before.
const LASTING: Duration = Duration::from_secs(20);

/// What is to become of a window.
pub struct Opening {
    /// Writes what is saved.
    pub save: Save,
    /// Whether it is to be closed, as on Ctrl-C; asked from frame to frame.
    pub is_to_close: fn() -> bool,
    /// Destroys the device after so many frames, to see what comes of it.
    pub lose_after: Option<u32>,
}

/// Opens the window and shows it until it is closed. A device that is lost is replaced, with another window; models and logs
/// stay. Call it on the main thread, which some systems insist on.
pub fn open(viewer: Viewer, opening: Opening) -> Result<Viewer, ViewError> {
    let Opening { save, is_to_close, mut lose_after } = opening;
    let held = Rc::new(RefCell::new(Held { viewer, save, is_to_close }));
    let mut losses = 0;
    loop {
        let (watched, begun) = (Watched::default(), Instant::now());
        let (shown, device, destroy) = (Rc::clone(&held), watched.clone(), lose_after.take());
        let made = Box::new(move |context: &eframe::CreationContext<'_>| {
            App::new(context, shown, device, destroy).map(|app| Box::new(app) as Box<dyn eframe::App>)
        });
        // What draws the window may panic on a device that is gone, before it hears that it is.
        let closed = catch_unwind(AssertUnwindSafe(|| eframe::run_native("mtess", options(), made)));
        if !watched.is_lost() {
            let closed = closed.unwrap_or_else(|panic| resume_unwind(panic));
            closed.map_err(|error| ViewError::NoWindow(plainly(&error)))?;
            break;
        }
        losses = if begun.elapsed() > LASTING { 1 } else { losses + 1 };
        if losses > LOSSES_MAX {
            return Err(ViewError::Lost(losses));
        }
    }
    let held = Rc::try_unwrap(held).map_err(|_| ViewError::NoWindow("it was closed, but not given back".into()))?;
    Ok(held.into_inner().viewer)
}

fn options() -> eframe::NativeOptions {
    let setup = WgpuSetupCreateNew {
        device_descriptor: Arc::new(render::Stage::device_descriptor),
        ..WgpuSetupCreateNew::without_display_handle()
    };
    eframe::NativeOptions {
        viewport: egui::ViewportBuilder::default()
            .with_title("mtess view")
            .with_inner_size([1280.0, 820.0])
            .with_min_inner_size([480.0, 320.0]),
        wgpu_options: WgpuConfiguration { wgpu_setup: WgpuSetup::CreateNew(setup), ..WgpuConfiguration::default() },
        persist_window: true,
        centered: true,
        ..eframe::NativeOptions::default()
    }
}

/// One line, and what to do next where that is known.
fn plainly(error: &eframe::Error) -> String {
    let text = error.to_string().replace('\n', " ");
    // Where in whose source it was noticed helps nobody here.
    let text = text.rsplit(".rs:").next().unwrap_or(&text).trim_start_matches(|c: char| c.is_ascii_digit() || c == ':');
    let text = text.trim().trim_end_matches('.');
    match error {
        eframe::Error::Winit(_) | eframe::Error::WinitEventLoop(_) => format!("{text} (is there a display?)"),
        eframe::Error::Wgpu(_) => format!("{text} (is there a driver for Vulkan or OpenGL?)"),
        _ => text.to_owned(),
    }
}
