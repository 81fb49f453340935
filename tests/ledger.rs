//! The ledger: made anew on small generated models, it has the shape of the one that is checked in, and what must hold of
//! any model holds.

use papers::ledger::{self, Bare, Claim, Entry, Published, Size, Verdict, Workshop};
use std::sync::LazyLock;

/// What is checked in.
const LEDGER: &str = include_str!("../papers/LEDGER.md");

static SMALL: LazyLock<Vec<Entry>> = LazyLock::new(|| {
    let (mut bare, mut watch) = (Bare, |_: &str, _: f32| true);
    ledger::entries(&ledger::all(), &mut Workshop::new(Size::Small, &mut bare, &mut watch)).unwrap()
});

/// Headings, commands, names of models, headings of tables, printed tables whole, and what papers say: all that does not
/// depend on models and machines.
fn shape(text: &str) -> Vec<String> {
    let lines: Vec<&str> = text.lines().collect();
    let (mut shape, mut printed, mut claims) = (Vec::new(), false, false);
    for (i, line) in lines.iter().enumerate() {
        let is_heading_of_table =
            line.starts_with('|') && lines.get(i + 1).is_some_and(|next| next.starts_with("| ---"));
        if line.starts_with('#') || line.starts_with("`mtess") || is_heading_of_table {
            shape.push((*line).to_owned());
        }
        if is_heading_of_table {
            claims = line.starts_with("| the paper says") || line.starts_with("| noticed");
            printed = i >= 2 && lines[i - 2].starts_with("Published");
        } else if line.starts_with('|') && printed {
            shape.push((*line).to_owned());
        } else if line.starts_with('|') && claims {
            shape.extend(line.split(" | ").next().map(str::to_owned));
        } else if let Some((model, _)) = line.strip_prefix("- ").and_then(|rest| rest.split_once(':')) {
            shape.push(model.to_owned());
        }
        if line.is_empty() {
            (printed, claims) = (false, false);
        }
    }
    shape
}

#[test]
fn what_is_checked_in_has_the_shape_of_what_is_made() {
    let made = ledger::ledger(&SMALL, "").unwrap();
    let (made, kept) = (shape(&made), shape(LEDGER));
    assert!(made.len() > 200, "a shape of {} lines is none", made.len());
    for (made, kept) in made.iter().zip(&kept) {
        assert_eq!(made, kept, "papers/LEDGER.md is old: make it anew by `mtess paper --all`");
    }
    assert_eq!(made.len(), kept.len());
}

/// What does not depend on how large models are.
#[test]
fn what_must_hold_of_any_model_holds() {
    let must = [
        ("truly-selective", "table-2", "dual pieces always generate smaller meshes"),
        ("truly-selective", "table-2", "a split waits only for coinciding cut vertices"),
        ("truly-selective", "figure-2", "to split one vertex"),
        ("truly-selective", "figure-4", "the dual pieces of a mesh's vertices cover the input"),
        ("generalized", "implicit-ids", "read with the neighbours' parents"),
        ("generalized", "implicit-ids", "dependency lists are eliminated"),
        ("generalized", "factors", "the metric is a parameter"),
        ("multi-tessellation", "strategies", "both approaches return one and the same mesh"),
        ("multi-tessellation", "optimality", "the incremental approach returns the minimum"),
        ("multi-tessellation", "optimality", "without that it may be larger"),
        (
            "multi-tessellation",
            "optimality",
            "the top-down approach always returns the mesh of minimum size (by single cells)",
        ),
        ("multi-tessellation", "budget", "the engine keeps within the budget and comes to rest"),
        ("truly-selective", "table-1", "the earlier schemes keep entities"),
        ("generalized", "implicit-ids", "a vertex may split when its id is greater"),
    ];
    for (paper, id, says) in must {
        let entry = SMALL.iter().find(|entry| entry.paper == paper && entry.id == id).expect("an entry of this name");
        let claim = entry.claims.iter().find(|claim| claim.says.starts_with(says)).expect("a claim that says so");
        assert_eq!(claim.verdict, Verdict::Holds, "{paper} {id}: {} ({})", claim.says, claim.finds);
    }
}

/// What is wrong in the papers is refuted here too, and every number printed there that disagrees is found.
#[test]
fn what_cannot_hold_differs() {
    let differs = [
        ("generalized", "implicit-ids", "a pair may merge when its parent's id is less"),
        ("multi-tessellation", "optimality", "the top-down approach always returns the mesh of minimum size (by whole"),
    ];
    for (paper, id, says) in differs {
        let entry = SMALL.iter().find(|entry| entry.paper == paper && entry.id == id).expect("an entry of this name");
        let claim = entry.claims.iter().find(|claim| claim.says.starts_with(says)).expect("a claim that says so");
        assert_eq!(claim.verdict, Verdict::Differs, "{}", claim.finds);
    }
    for entry in SMALL.iter().filter(|entry| entry.id == "anomalies") {
        // Six children a fan are what the printed tables have, if one does not count the centre; and what small spheres and
        // fields do not show.
        let excepted = ["The depth of log6 n", "flips are left open", "contraction and expansion oscillate"];
        let is_denied = |claim: &&Claim| {
            claim.verdict == Verdict::Differs && !excepted.iter().any(|says| claim.says.starts_with(says))
        };
        let denied: Vec<_> = entry.claims.iter().filter(is_denied).collect();
        assert!(denied.is_empty(), "{}: {denied:?}", entry.paper);
    }
}

/// Anomalies are computed from the data file, not written down: a number mended is an anomaly gone.
#[test]
fn anomalies_come_from_the_data() {
    let slips = [
        ("truly-selective", "22105", "20105", "a mesh has more faces than twice its vertices"),
        (
            "truly-selective",
            "30284, 12049, 24094, 10870, 21736, 68",
            "30284, 12050, 24094, 10870, 21736, 68",
            "the columns of Cow and Horse",
        ),
        ("fan-hierarchy", "142500, 1.6", "142500, 1.56", "A saving factor is not"),
        ("fan-hierarchy", "1224, 142500", "800, 142500", "Table 2 has more internal nodes"),
        ("multi-tessellation", "868084", "1153600", "the totals of the T-DAG"),
    ];
    let (mut bare, mut watch) = (Bare, |_: &str, _: f32| true);
    let mut workshop = Workshop::new(Size::Small, &mut bare, &mut watch);
    for (name, printed, mended, says) in slips {
        let paper = ledger::paper(name).unwrap();
        assert!(paper.data.contains(printed), "{name} has {printed}");
        let published = Published::read(&paper.data.replace(printed, mended)).unwrap();
        let mut entry = Entry::default();
        (ledger::item(paper, "anomalies").unwrap().run)(&mut workshop, &published, &mut entry).unwrap();
        let claim = entry.claims.iter().find(|claim| claim.says.starts_with(says)).unwrap();
        assert_eq!(claim.verdict, Verdict::Differs, "{name}: {claim:?}");
    }
}

#[test]
fn every_figure_is_a_picture_of_its_kind() {
    let figures: Vec<_> = SMALL.iter().flat_map(|entry| &entry.figures).collect();
    assert!(figures.len() > 20);
    for figure in figures {
        let begins: &[u8] = if figure.name.ends_with(".svg") { b"<svg" } else { b"\x89PNG" };
        assert!(figure.bytes.starts_with(begins), "{}", figure.name);
    }
}
