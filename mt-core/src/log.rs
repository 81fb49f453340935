//! Logs of a view: the steps that it took, frame by frame, as text; and walking along them, both ways.
//!
//! The first line says of how many modifications the model is, and each other is a frame: `+12` refines node 12, `-7`
//! coarsens node 7, in this order, from the base mesh on. A frame in which nothing happens is an empty line.
//!
//! ```text
//! {"log":1,"nodes":17254}
//! +17253 +17250 +16999
//! -16999 +17251
//! ```

use crate::id::NodeId;
use crate::model::{Coarsen, MultiTessellation, Sink, Step, View, take};
use serde::{Deserialize, Serialize};
use std::io::{BufRead, Write};

/// The steps of a view from the base mesh on. Since every step has an inverse, it leads both ways.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Log {
    /// Number of modifications of the model.
    pub node_count: u32,
    /// All steps, in order.
    pub steps: Vec<Step>,
    /// Where each frame ends in `steps`; ascending, the last at the end.
    pub frame_ends: Vec<usize>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Head {
    log: u32,
    nodes: u32,
}

/// Text that is no log, or one that a model cannot follow.
#[derive(Debug, thiserror::Error)]
pub enum LogError {
    /// A line cannot be read or understood.
    #[error("line {line}: {what}")]
    Line {
        /// Counted from 1.
        line: usize,
        /// What is wrong.
        what: String,
    },
    /// It is one of another model.
    #[error("it is a log of a model of {told} modifications, not of {found}")]
    OtherModel {
        /// Modifications that the log speaks of.
        told: u32,
        /// Modifications of the model.
        found: u32,
    },
    /// A step is not legal where it is taken.
    #[error("step {at} {why}")]
    Illegal {
        /// Counted from 0.
        at: usize,
        /// What stands in its way.
        why: String,
    },
}

impl Log {
    /// No step yet, of a model of so many modifications.
    pub fn new(node_count: u32) -> Self {
        Self { node_count, ..Self::default() }
    }

    /// Appends a frame.
    pub fn push(&mut self, steps: &[Step]) {
        self.steps.extend_from_slice(steps);
        self.frame_ends.push(self.steps.len());
    }

    /// The frame that a step belongs to, counted from 0.
    pub fn frame_of(&self, step: usize) -> usize {
        self.frame_ends.partition_point(|&end| end <= step)
    }

    /// Writes the log as text.
    pub fn write(&self, out: &mut impl Write) -> std::io::Result<()> {
        serde_json::to_writer(&mut *out, &Head { log: 1, nodes: self.node_count })?;
        out.write_all(b"\n")?;
        let mut from = 0;
        for &end in &self.frame_ends {
            let sign = |step: &Step| if step.refined { '+' } else { '-' };
            let words: Vec<String> =
                self.steps[from..end].iter().map(|step| format!("{}{}", sign(step), step.node)).collect();
            writeln!(out, "{}", words.join(" "))?;
            from = end;
        }
        Ok(())
    }

    /// Reads a log. That it can be followed is for [`Log::follow`] to say. O(text).
    pub fn read(text: impl BufRead) -> Result<Self, LogError> {
        let mut log: Option<Self> = None;
        for (i, line) in text.lines().enumerate() {
            let wrong = |what: String| LogError::Line { line: i + 1, what };
            let line = line.map_err(|error| wrong(error.to_string()))?;
            let Some(log) = &mut log else {
                let head: Head = serde_json::from_str(&line)
                    .map_err(|error| wrong(format!("the first line must say what the log is of: {error}")))?;
                if head.log != 1 {
                    return Err(wrong(format!("version {} of logs is not known, only 1", head.log)));
                }
                log = Some(Self::new(head.nodes));
                continue;
            };
            for word in line.split_ascii_whitespace() {
                log.steps.push(step_of(word, log.node_count).map_err(wrong)?);
            }
            log.frame_ends.push(log.steps.len());
        }
        log.ok_or_else(|| LogError::Line { line: 1, what: "the log is empty".into() })
    }

    /// Follows the log once from the base mesh and sees that every step is legal where it is taken. O(steps × needs).
    pub fn follow<const N: usize, M: MultiTessellation<N>>(&self, model: &M) -> Result<(), LogError> {
        if self.node_count != model.len() {
            return Err(LogError::OtherModel { told: self.node_count, found: model.len() });
        }
        let mut view = model.base_view();
        let mut out = Vec::new();
        for (at, &step) in self.steps.iter().enumerate() {
            let m = step.node;
            let illegal = |why: String| LogError::Illegal { at, why };
            if view.front.is_refined(m) == step.refined {
                let state = if step.refined { "refined" } else { "coarse" };
                return Err(illegal(format!("is for node {m}, which is {state} already")));
            }
            out.clear();
            let free = if step.refined {
                model.prerequisites(m, &view, &mut out);
                out.is_empty()
            } else {
                model.obstacles(m, &view, &mut out) == Coarsen::Now
            };
            if !free {
                let what = if step.refined { "refines" } else { "coarsens" };
                return Err(illegal(format!("{what} node {m}, but {out:?} must go before it")));
            }
            take(model, step, &mut view, &mut ());
        }
        Ok(())
    }
}

fn step_of(word: &str, node_count: u32) -> Result<Step, String> {
    let (sign, number) = word.split_at_checked(1).unwrap_or(("", word));
    let node: u32 = number.parse().map_err(|_| format!("`{word}` is no step, such as +12 or -7"))?;
    if node >= node_count {
        return Err(format!("`{word}` is of a node that the model does not have"));
    }
    match sign {
        "+" => Ok(Step::refine(NodeId(node))),
        "-" => Ok(Step::coarsen(NodeId(node))),
        _ => Err(format!("`{word}` says neither + nor -")),
    }
}

/// A place in a log: the view after the first [`Timeline::at`] steps.
#[derive(Debug)]
pub struct Timeline<'a, const N: usize, M: MultiTessellation<N>> {
    model: &'a M,
    steps: &'a [Step],
    at: usize,
    view: View<M::Mesh>,
}

impl<'a, const N: usize, M: MultiTessellation<N>> Timeline<'a, N, M> {
    /// The beginning of a log. Requires: steps that are legal one after the other from the base mesh, see [`Log::follow`].
    pub fn new(model: &'a M, steps: &'a [Step]) -> Self {
        Self { model, steps, at: 0, view: model.base_view() }
    }

    /// How many steps were taken.
    pub fn at(&self) -> usize {
        self.at
    }

    /// Front and mesh there.
    pub fn view(&self) -> &View<M::Mesh> {
        &self.view
    }

    /// Front and mesh there, for checkers that go on a little and come back.
    pub fn view_mut(&mut self) -> &mut View<M::Mesh> {
        &mut self.view
    }

    /// Goes to where `at` steps have been taken, forward or back; `sink` hears of it. O(steps in between).
    pub fn seek(&mut self, at: usize, sink: &mut impl Sink<N>) {
        let at = at.min(self.steps.len());
        while self.at < at {
            take(self.model, self.steps[self.at], &mut self.view, sink);
            self.at += 1;
        }
        while self.at > at {
            self.at -= 1;
            take(self.model, self.steps[self.at].inverse(), &mut self.view, sink);
        }
    }
}

/// The first of `0..=last` at which something does not hold, by halving: exact where it never holds again afterwards, else
/// some place at which it holds no longer. `None` where it holds at `last`. O(log last) looks.
pub fn bisect(first: usize, last: usize, mut holds: impl FnMut(usize) -> bool) -> Option<usize> {
    if holds(last) {
        return None;
    }
    let (mut good, mut bad) = (first, last);
    if !holds(good) {
        return Some(good);
    }
    while good + 1 < bad {
        let middle = good + (bad - good) / 2;
        if holds(middle) { good = middle } else { bad = middle }
    }
    Some(bad)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_comes_back_as_it_was() {
        let mut log = Log::new(9);
        log.push(&[Step::refine(NodeId(8)), Step::refine(NodeId(3))]);
        log.push(&[]);
        log.push(&[Step::coarsen(NodeId(3))]);
        let mut text = Vec::new();
        log.write(&mut text).unwrap();
        assert_eq!(String::from_utf8_lossy(&text), "{\"log\":1,\"nodes\":9}\n+8 +3\n\n-3\n");
        assert_eq!(Log::read(text.as_slice()).unwrap(), log);
        assert_eq!([0, 1, 2].map(|step| log.frame_of(step)), [0, 0, 2]);
    }

    #[test]
    fn what_is_no_log_is_refused_by_line() {
        for (text, says) in [
            ("", "line 1: the log is empty"),
            ("+1", "line 1: the first line"),
            ("{\"log\":2,\"nodes\":1}", "version 2"),
            ("{\"log\":1,\"nodes\":4}\n+4", "line 2: `+4` is of a node"),
            ("{\"log\":1,\"nodes\":4}\n+1 2", "line 2: `2` is no step"),
            ("{\"log\":1,\"nodes\":4}\n=2", "neither"),
            ("{\"log\":1,\"nodes\":4}\né2", "no step"),
            ("{\"log\":1,\"nodes\":4}\n+99999999999", "no step"),
        ] {
            let told = Log::read(text.as_bytes()).unwrap_err().to_string();
            assert!(told.contains(says), "{text}: {told}");
        }
    }

    #[test]
    fn halving_finds_the_first() {
        for last in 0..40 {
            for first_bad in 0..=last {
                assert_eq!(bisect(0, last, |at| at < first_bad), Some(first_bad));
            }
            assert_eq!(bisect(0, last, |_| true), None);
        }
    }

    /// A strip of four triangles becomes one in two steps that chew off its ear: 1 needs none, 0 needs 1.
    fn chain() -> crate::Explicit<3> {
        let mesh = crate::generate::strip(4);
        let mut recorder = crate::Recorder::new(&mesh).unwrap();
        for (error, kills, makes) in [(0.0, [0, 1], mesh.cells[2]), (1.0, [2, 4], mesh.cells[3])] {
            kills.iter().for_each(|&cell| recorder.kill(crate::CellId(cell)).unwrap());
            recorder.make(makes).unwrap();
            recorder.end(error).unwrap();
        }
        recorder.finish(Default::default()).unwrap()
    }

    #[test]
    fn what_is_not_legal_is_not_followed() {
        let model = chain();
        assert_eq!(model.len(), 2);
        let [up, down] = [0, 1].map(NodeId);
        let told = |steps: &[Step]| {
            let mut log = Log::new(2);
            log.push(steps);
            log.follow(&model).map_err(|error| error.to_string())
        };
        assert_eq!(told(&[Step::refine(down), Step::refine(up), Step::coarsen(up), Step::coarsen(down)]), Ok(()));
        for (steps, says) in [
            (vec![Step::refine(up)], "must go before it"),
            (vec![Step::coarsen(up)], "coarse already"),
            (vec![Step::refine(down), Step::refine(down)], "refined already"),
            (vec![Step::refine(down), Step::refine(up), Step::coarsen(down)], "must go before it"),
        ] {
            let error = told(&steps).unwrap_err();
            assert!(error.contains(says), "{steps:?}: {error}");
        }
        assert!(matches!(Log::new(3).follow(&model), Err(LogError::OtherModel { told: 3, found: 2 })));
    }

    #[test]
    fn a_timeline_goes_where_it_is_told_and_says_so() {
        let model = chain();
        let steps = [Step::refine(NodeId(1)), Step::refine(NodeId(0)), Step::coarsen(NodeId(0))];
        let mut timeline = Timeline::new(&model, &steps);
        let fronts: [&[u32]; 4] = [&[], &[1], &[0, 1], &[1]];
        for at in [1, 0, 2, 3, 1, 3, 0, 9] {
            timeline.seek(at, &mut ());
            let at = at.min(3);
            assert_eq!(timeline.at(), at);
            let front: Vec<u32> = timeline.view().front.finest_first().map(|m| m.0).collect();
            assert_eq!(front, fronts[at], "after {at} steps");
        }
    }
}
