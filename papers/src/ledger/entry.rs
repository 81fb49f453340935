//! An entry of the ledger: what a paper says, what comes out here, and whether the one is the other.

use crate::table::Table;

/// One table, figure or statement of a paper, reproduced.
#[derive(Clone, Debug, Default)]
pub struct Entry {
    /// The name of its paper.
    pub paper: String,
    /// Its own name, as in commands: `table-2`, `figure-10`.
    pub id: String,
    /// What it is about.
    pub title: String,
    /// As printed; nothing where the paper shows a picture.
    pub published: Option<Table>,
    /// What stands for the models of the paper, one line each.
    pub models: Vec<String>,
    /// What was measured here.
    pub measured: Vec<Table>,
    /// What the paper says, each held against what was measured.
    pub claims: Vec<Claim>,
    /// How ours differs from the paper's, and what else to know.
    pub notes: Vec<String>,
    /// Pictures and plots.
    pub figures: Vec<Figure>,
    /// Seconds that it took.
    pub seconds: f64,
}

/// A picture of an entry.
#[derive(Clone, Debug)]
pub struct Figure {
    /// File name.
    pub name: String,
    /// What it shows.
    pub caption: String,
    /// The bytes of the file, PNG or SVG by its ending.
    pub bytes: Vec<u8>,
}

/// How what was measured relates to what was said.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// It is so here too.
    Holds,
    /// It is not so here.
    Differs,
    /// What was said cannot be held against anything that is measured here.
    Open,
}

impl Verdict {
    /// In a word.
    pub fn name(self) -> &'static str {
        match self {
            Self::Holds => "holds",
            Self::Differs => "differs",
            Self::Open => "open",
        }
    }
}

/// A statement of a paper, and what became of it.
#[derive(Clone, Debug)]
pub struct Claim {
    /// What the paper says.
    pub says: String,
    /// What was found.
    pub finds: String,
    /// Whether that is the same.
    pub verdict: Verdict,
    /// Whether it is ours, and not the paper's.
    pub is_ours: bool,
}

impl Claim {
    /// A statement that measuring decides. `why` is told where it does not hold.
    pub fn check(says: &str, holds: bool, finds: impl Into<String>, why: &str) -> Self {
        let mut finds = finds.into();
        if ["NaN", "inf "].iter().any(|nothing| finds.contains(nothing)) {
            return Self::open(says, format!("{finds}: these models are too small to tell"));
        }
        if !holds {
            let why = if why.is_empty() { "we do not know" } else { why };
            finds = format!("{finds}. Why: {why}");
        }
        let verdict = if holds { Verdict::Holds } else { Verdict::Differs };
        Self { says: says.to_owned(), finds, verdict, is_ours: false }
    }

    /// A statement that is not decided here, and why not.
    pub fn open(says: &str, why: impl Into<String>) -> Self {
        Self { says: says.to_owned(), finds: why.into(), verdict: Verdict::Open, is_ours: false }
    }

    /// What anybody sees who reads the paper, and where.
    pub fn read(says: &str, at: &str) -> Self {
        Self {
            says: says.to_owned(),
            finds: format!("read in the text, {at}"),
            verdict: Verdict::Holds,
            is_ours: false,
        }
    }

    /// The same as a statement of ours.
    pub fn ours(self) -> Self {
        Self { is_ours: true, ..self }
    }
}

impl Entry {
    /// How many of its claims, ours or the paper's, have come to this.
    pub fn count(&self, verdict: Verdict, is_ours: bool) -> usize {
        self.claims.iter().filter(|claim| claim.verdict == verdict && claim.is_ours == is_ours).count()
    }

    /// Notes how ours differs.
    pub fn note(&mut self, text: impl Into<String>) -> &mut Self {
        self.notes.push(text.into());
        self
    }
}
