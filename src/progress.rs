//! Progress bars, clocks and interruption for the command.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::time::{Duration, Instant};

/// A bar that shows itself when the work has taken half a second, on a terminal only.
pub struct Progress {
    bar: ProgressBar,
    begun: Instant,
    shown: bool,
}

/// Shorter work shows no bar.
const SILENT: Duration = Duration::from_millis(500);

impl Progress {
    /// A bar of `length` steps that hears of Ctrl-C as long as it lives.
    pub fn new(what: &'static str, length: u64) -> Self {
        LISTENING.fetch_add(1, Ordering::SeqCst);
        let bar = ProgressBar::with_draw_target(Some(length), ProgressDrawTarget::hidden());
        let style = ProgressStyle::with_template("{msg:12} [{bar:40}] {percent:>3} %  {eta} left")
            .expect("the template is constant");
        bar.set_style(style.progress_chars("=> "));
        bar.set_message(what);
        Self { bar, begun: Instant::now(), shown: false }
    }

    /// One step more begins; whether to go on.
    pub fn step(&mut self) -> bool {
        let at = self.bar.position();
        let go_on = self.at(at);
        self.bar.set_position(at + 1);
        go_on
    }

    /// Notes progress; whether to go on.
    pub fn at(&mut self, position: u64) -> bool {
        if !self.shown && self.begun.elapsed() > SILENT {
            self.shown = true;
            self.bar.set_draw_target(ProgressDrawTarget::stderr());
        }
        self.bar.set_position(position);
        !interrupted()
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        LISTENING.fetch_sub(1, Ordering::SeqCst);
        self.bar.finish_and_clear();
    }
}

/// Does work of which nobody knows how far it is, and shows that it goes on and for how long. Nothing of it listens, so
/// Ctrl-C ends it at once.
pub fn spinning<T>(what: &'static str, work: impl FnOnce() -> T) -> T {
    let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::hidden());
    bar.set_style(ProgressStyle::with_template("{msg:12} {spinner} {elapsed}").expect("the template is constant"));
    bar.set_message(what);
    let (done, hear) = std::sync::mpsc::channel::<()>();
    let shown = bar.clone();
    let show = std::thread::spawn(move || {
        // Work that is done by then shows nothing.
        if hear.recv_timeout(SILENT) == Err(std::sync::mpsc::RecvTimeoutError::Timeout) {
            shown.set_draw_target(ProgressDrawTarget::stderr());
            shown.enable_steady_tick(Duration::from_millis(200));
        }
    });
    let result = work();
    drop(done);
    // The thread only waits and shows; there is nothing in it that could fail.
    _ = show.join();
    bar.finish_and_clear();
    result
}

/// Whether somebody has pressed Ctrl-C.
static INTERRUPTED: AtomicBool = AtomicBool::new(false);
/// How many pieces of work look at it.
static LISTENING: AtomicU32 = AtomicU32::new(0);

/// Whether somebody has asked to stop: what was done since may be cut short, and is not to be written.
pub fn interrupted() -> bool {
    INTERRUPTED.load(Ordering::SeqCst)
}

/// From here on Ctrl-C leaves nothing half-written: work that listens stops by itself; other work ends at once, and so
/// does any after a second Ctrl-C.
pub fn hear_interruptions() {
    let heard = ctrlc::set_handler(|| {
        let again = INTERRUPTED.swap(true, Ordering::SeqCst);
        if again || LISTENING.load(Ordering::SeqCst) == 0 {
            let _no_other_begins = crate::files::discard_part();
            std::process::exit(130);
        }
    });
    // Without a handler Ctrl-C ends the process all the same.
    drop(heard);
}

/// Wall and CPU seconds of a piece of work.
#[derive(Clone, Copy)]
pub struct Clock {
    wall: Instant,
    cpu: f64,
}

impl Clock {
    /// Starts.
    pub fn start() -> Self {
        Self { wall: Instant::now(), cpu: cpu_seconds() }
    }

    /// Wall seconds since the start.
    pub fn wall(&self) -> f64 {
        self.wall.elapsed().as_secs_f64()
    }

    /// CPU seconds of all threads since the start.
    pub fn cpu(&self) -> f64 {
        cpu_seconds() - self.cpu
    }
}

#[cfg(unix)]
fn cpu_seconds() -> f64 {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    time.tv_sec as f64 + time.tv_nsec as f64 * 1e-9
}

#[cfg(not(unix))]
fn cpu_seconds() -> f64 {
    // Without a clock of the process the wall has to do.
    static BEGUN: std::sync::OnceLock<Instant> = std::sync::OnceLock::new();
    BEGUN.get_or_init(Instant::now).elapsed().as_secs_f64()
}
