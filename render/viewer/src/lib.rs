//! A window on multi-tessellations: fly around, freeze the front and leave it, go back in time, ask what a step needs, and take
//! the picture home.
//!
//! ```text
//! keys, mouse ─▶ window ─ actions ─▶ Viewer { pilot, ask, panes { Play } } ─ frame ─▶ steps ─▶ Places ─▶ Stage ─▶ texture
//!                   ▲                                                      ─ scene ─▶ lines, colours ────────┘      │
//!                   └────────────────────────────────────────────────────────────────────────────────────────────┘
//! ```
//!
//! All but `window`, `panels` and `graph` knows neither window nor device. No file is opened here: whoever opens the window
//! makes models and writes files.
//!
//! | room | what is there |
//! |---|---|
//! | `ask` | what is asked of every frame |
//! | `play` | a view whose model nobody needs to know, with its log |
//! | `pane`, `viewer` | panes, what they show and what can be done to them |
//! | `pilot`, `pick`, `marks` | the camera; what lies under a pixel; lines that tell of it |
//! | `keys` | actions and their keys |
//! | `saved` | what is written of a picture |
//! | `window`, `panels`, `graph` | egui, winit and the device |

mod ask;
mod graph;
mod keys;
mod marks;
mod pane;
mod panels;
mod pick;
mod pilot;
mod play;
mod saved;
mod viewer;
mod window;

pub use ask::{Ask, Asked, Extent};
pub use keys::{Action, BINDINGS, Binding};
pub use pane::{Choice, Make, Pane, Subject};
pub use pick::{Hit, pick};
pub use pilot::{Flight, Pilot};
pub use play::{NodeFacts, Picked, Play, PlayFrom, play};
pub use saved::{File, Save};
pub use viewer::{Record, Shown, Viewer};

use eframe::egui;
use eframe::egui_wgpu::{WgpuConfiguration, WgpuSetup, WgpuSetupCreateNew};
use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::rc::Rc;
use std::sync::Arc;
use window::{App, Held, Shelf, Watched};

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

/// Devices that may be lost before we give up.
const LOSSES_MAX: u32 = 3;

/// Opens the window and shows it until it is closed. A device that is lost is replaced, with another window; models and logs
/// stay. Call it on the main thread, which some systems insist on.
///
/// `lose_after` destroys the device after so many frames, to see what comes of it.
pub fn open(viewer: Viewer, save: Save, lose_after: Option<u32>) -> Result<Viewer, ViewError> {
    let shelf: Shelf = Rc::new(Cell::new(Some(Box::new(Held { viewer, save }))));
    let mut destroy_after = lose_after;
    for losses in 0.. {
        let watched = Watched::default();
        let (taken, device, destroy) = (Rc::clone(&shelf), watched.clone(), destroy_after.take());
        let made = Box::new(move |context: &eframe::CreationContext<'_>| {
            App::new(context, &taken, &device, destroy).map(|app| Box::new(app) as Box<dyn eframe::App>)
        });
        // What draws the window may panic on a device that is gone, before it hears that it is.
        let closed = catch_unwind(AssertUnwindSafe(|| eframe::run_native("mtess", options(), made)));
        if !watched.is_lost() {
            let closed = closed.unwrap_or_else(|panic| resume_unwind(panic));
            closed.map_err(|error| ViewError::NoWindow(plainly(&error)))?;
            break;
        }
        if losses >= LOSSES_MAX {
            return Err(ViewError::Lost(losses + 1));
        }
    }
    let held = shelf.take();
    held.map(|held| held.viewer).ok_or_else(|| ViewError::NoWindow("it ended before it began".into()))
}

fn options() -> eframe::NativeOptions {
    let setup = WgpuSetupCreateNew {
        device_descriptor: Arc::new(render::Stage::wish),
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
