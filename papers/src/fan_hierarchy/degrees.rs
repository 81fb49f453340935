//! Figure 3: the largest and the mean degree of vertices along the simplification of the bunny, by fans and by edges.

use super::fans;
use crate::ledger::{BUNNY, Claim, Entry, Figure, LedgerError, Published, Workshop, edge_collapse};
use crate::plot::{Axis, Lines, Series};
use crate::table::Table;
use mt_core::{Replay, VertexId};
use operators::{AnyOperator, FanMerge};

/// Percentages of the vertices that are gone.
const GONE: [u32; 13] = [0, 10, 20, 30, 40, 50, 60, 70, 80, 85, 90, 95, 98];

/// Degrees at one of [`GONE`].
#[derive(Copy, Clone, Debug)]
struct At {
    gone: u32,
    most: usize,
    mean: f64,
}

/// The largest and the mean number of triangles at a vertex, at each of [`GONE`] that is reached.
fn degrees(replay: &Replay) -> Vec<At> {
    let leaves = f64::from(replay.leaf_count().max(1));
    let mut wanted = GONE.iter().copied().peekable();
    let mut found = Vec::new();
    replay.sweep(|_, view| {
        let left = f64::from(view.mesh.active.count()) / leaves;
        while let Some(&gone) = wanted.peek()
            && 1.0 - left >= f64::from(gone) / 100.0
        {
            wanted.next();
            let degree = |v: u32| view.mesh.faces.star(VertexId(v)).count();
            let all = view.mesh.active.iter().map(degree);
            let (most, sum, used) = all.fold((0, 0, 0usize), |(most, sum, used), degree| {
                (degree.max(most), sum + degree, used + usize::from(degree > 0))
            });
            found.push(At { gone, most, mean: sum as f64 / used.max(1) as f64 });
        }
    });
    found
}

/// The largest quotient of two curves after the start, and where.
fn worst(curve: &[At], other: &[At], value: impl Fn(&At) -> f64) -> (f64, u32) {
    let both = curve.iter().filter_map(|at| Some((at, other.iter().find(|other| other.gone == at.gone)?)));
    let quotients = both.filter(|(at, _)| at.gone > 0).map(|(at, other)| (value(at) / value(other), at.gone));
    quotients.fold((0.0, 0), |worst, next| if next.0 > worst.0 { next } else { worst })
}

pub(super) fn figure_3(workshop: &mut Workshop<'_>, _: &Published, entry: &mut Entry) -> Result<(), LedgerError> {
    let subject = workshop.subject(&BUNNY)?;
    entry.models.push(subject.told());
    let weighed = AnyOperator::FanMerge(FanMerge { weigh_degree: true, ..FanMerge::PARTIAL });
    let operators =
        [("fan-merge", fans()), ("fan-merge, weighed by degree", weighed), ("edge collapse", edge_collapse())];
    let mut curves = Vec::new();
    for (name, operator) in operators {
        curves.push((name, degrees(&workshop.sequence(&subject, &operator)?.replay)));
    }
    let headings: Vec<String> = std::iter::once("#vertices gone, %".to_owned())
        .chain(curves.iter().flat_map(|(name, _)| [format!("#{name}, most"), "#mean".to_owned()]))
        .collect();
    let mut table =
        Table::new("Measured: triangles at a vertex; vertices without one are left out.", &headings.join(" | "));
    for gone in GONE {
        let of = |curve: &[At]| {
            let at = curve.iter().find(|at| at.gone == gone);
            at.map_or([String::new(), String::new()], |at| [at.most.to_string(), format!("{:.2}", at.mean)])
        };
        table.row([gone.to_string()].into_iter().chain(curves.iter().flat_map(|(_, curve)| of(curve))));
    }
    entry.measured.push(table);
    claims(entry, [0, 1, 2].map(|i| curves[i].1.as_slice()));
    let series = |name: &str, curve: &[At], value: fn(&At) -> f64| Series {
        name: name.to_owned(),
        points: curve.iter().map(|at| [f64::from(at.gone), value(at)]).collect(),
    };
    let most = curves.iter().map(|(name, curve)| series(&format!("{name}, most"), curve, |at| at.most as f64));
    let mean = curves.iter().map(|(name, curve)| series(&format!("{name}, mean"), curve, |at| at.mean));
    let plot = Lines {
        title: "Degrees along the simplification".into(),
        x: Axis::linear("vertices gone, %"),
        y: Axis::logarithmic("triangles at a vertex"),
        series: most.chain(mean).collect(),
    };
    entry.figures.push(Figure {
        name: "fan-hierarchy-figure-3.svg".into(),
        caption:
            "Figure 3 remade: largest and mean degree against the share of vertices that are gone, by fans and by edges"
                .into(),
        bytes: plot.svg().into_bytes(),
    });
    Ok(())
}

fn claims(entry: &mut Entry, [fan, weighed, edge]: [&[At]; 3]) {
    let (most, at) = worst(fan, edge, |at| at.most as f64);
    entry.claims.push(Claim::check(
        "fan-merge does not make vertices of high degree; they are comparable to those of edge collapse",
        most <= 1.5,
        format!("the largest degree is up to {most:.1} times that of edge collapse, at {at} % gone"),
        "the centre of a fan takes over what is around its whole link, and the order of errors does not look at degrees",
    ));
    let sum = |curve: &[At]| curve.iter().filter(|at| at.gone > 0).map(|at| at.most as f64).sum::<f64>();
    let less = sum(weighed) / sum(fan);
    entry.claims.push(Claim::check(
        "one could reduce the degree by a weight according to the number of adjacent triangles",
        less < 0.95,
        format!("with it the largest degree is {less:.2} times what it is without, over all rows"),
        "at most places it makes no difference which of two fans of like error goes first",
    ));
    let (mean, at) = worst(fan, edge, |at| at.mean);
    entry.claims.push(Claim::check(
        "mean degrees are comparable",
        mean < 1.1,
        format!("up to {mean:.2} times, at {at} % gone: Euler's formula leaves little room"),
        "",
    ));
}
