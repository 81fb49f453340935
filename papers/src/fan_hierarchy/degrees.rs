//! Figure 3: the largest and the mean degree of vertices along the simplification of the bunny, by fans and by edges.

use super::{edges, fans};
use crate::ledger::{Claim, Entry, Figure, LedgerError, Published, Role, Size, Workshop};
use crate::plot::{Axis, Lines, Series};
use crate::table::Table;
use mt_core::generate::bumpy_sphere;
use mt_core::{Replay, VertexId};

const BUNNY: Role = Role {
    name: "Bunny",
    file: "surfaces/stanford-bunny.obj",
    part: None,
    stand_in: |size| bumpy_sphere(if size == Size::Small { 3 } else { 5 }, 0.15, 9),
};

/// Percentages of the vertices that are gone.
const GONE: [u32; 13] = [0, 10, 20, 30, 40, 50, 60, 70, 80, 85, 90, 95, 98];

/// The largest and the mean number of triangles at a vertex, at each of [`GONE`] that is reached.
fn degrees(replay: &Replay) -> Vec<(u32, usize, f64)> {
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
            found.push((gone, most, sum as f64 / used.max(1) as f64));
        }
    });
    found
}

pub(super) fn figure_3(workshop: &mut Workshop<'_>, _: &Published, entry: &mut Entry) -> Result<(), LedgerError> {
    let subject = workshop.subject(&BUNNY)?;
    entry.models.push(subject.told());
    let [fan, edge] =
        [fans(), edges()].map(|operator| workshop.sequence(&subject, &operator).map(|made| degrees(&made.replay)));
    let (fan, edge) = (fan?, edge?);
    let mut table = Table::new(
        "Measured: triangles at a vertex; vertices without one are left out.",
        &["#vertices gone, %", "#fan-merge, most", "#edge collapse, most", "#fan-merge, mean", "#edge collapse, mean"],
    );
    for gone in GONE {
        let [fan, edge] = [&fan, &edge].map(|all| all.iter().find(|(at, ..)| *at == gone));
        let most = |row: Option<&(u32, usize, f64)>| row.map_or(String::new(), |row| row.1.to_string());
        let mean = |row: Option<&(u32, usize, f64)>| row.map_or(String::new(), |row| format!("{:.2}", row.2));
        table.row([gone.to_string(), most(fan), most(edge), mean(fan), mean(edge)]);
    }
    entry.measured.push(table);
    let worst = fan.iter().filter_map(|&(gone, most, _)| {
        let edge = edge.iter().find(|(at, ..)| *at == gone)?;
        Some((most as f64 / edge.1 as f64, gone))
    });
    let (worst, at) = worst.fold((0.0, 0), |worst, next| if next.0 > worst.0 { next } else { worst });
    entry.claims.push(Claim::check(
        "fan-merge does not make vertices of high degree; they are comparable to those of edge collapse",
        worst <= 2.0,
        format!("the largest degree is at most {worst:.1} times that of edge collapse, at {at} % gone"),
        "the centre of a fan takes over what is around its whole link, and the order of errors does not look at degrees; the \
         paper's remedy, a weight by degree, is an option it leaves open",
    ));
    let mean = |all: &[(u32, usize, f64)]| all.iter().map(|row| row.2).fold(0.0, f64::max);
    entry.claims.push(Claim::check(
        "so are mean degrees",
        mean(&fan) < 1.15 * mean(&edge),
        format!("at most {:.2} by fans, {:.2} by edges: Euler's formula leaves no room", mean(&fan), mean(&edge)),
        "",
    ));
    let series = |name: &str, rows: &[(u32, usize, f64)], value: fn(&(u32, usize, f64)) -> f64| Series {
        name: name.to_owned(),
        points: rows.iter().map(|row| [f64::from(row.0), value(row)]).collect(),
    };
    let most = |row: &(u32, usize, f64)| row.1 as f64;
    let mean = |row: &(u32, usize, f64)| row.2;
    let plot = Lines {
        title: "Degrees along the simplification".into(),
        x: Axis::linear("vertices gone, %"),
        y: Axis::logarithmic("triangles at a vertex"),
        series: vec![
            series("fan-merge, most", &fan, most),
            series("edge collapse, most", &edge, most),
            series("fan-merge, mean", &fan, mean),
            series("edge collapse, mean", &edge, mean),
        ],
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
