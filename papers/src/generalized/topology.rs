//! Virtual edges, and what pairs of vertices do to an assembly that edges cannot.

use super::ASSEMBLIES;
use crate::distance::{Sampling, Surface};
use crate::ledger::{Brush, Claim, Entry, LedgerError, Published, Subject, Workshop, close_up, edge_collapse};
use crate::table::Table;
use glam::Vec3;
use mt_core::model::mesh_of;
use mt_core::{Front, Hierarchy, Mesh, NodeId, Replay, VertexId};
use operators::AnyOperator;
use operators::metric::{AnyMetric, Quadrics};
use operators::order::Stored;
use operators::vertex_pair::{Preference, VertexPair, VirtualEdges, virtual_edges as find};
use render::{Look, encode};
use selective::{State, approach};
use std::sync::Arc;
use std::time::Instant;

pub(super) fn virtual_edges(workshop: &mut Workshop<'_>, _: &Published, entry: &mut Entry) -> Result<(), LedgerError> {
    let headings = "model | #threshold, rad | #longest, % of diagonal | #edges | #virtual edges | #pieces by edges | #pieces with virtual edges | #s";
    let mut table = Table::new("Measured: a piece is what edges connect.", headings);
    let (mut fewer, mut pieces_of) = (true, Vec::new());
    for role in &ASSEMBLIES {
        let subject = workshop.subject_unsplit(role)?;
        workshop.go_on(role.name)?;
        entry.models.push(subject.told());
        let real = edges_of(&subject.mesh);
        let alone = pieces(&subject.mesh, &real);
        let mut counts = Vec::new();
        for (threshold, distance) in [(0.1, 0.05), (0.5, 0.05), (1.0, 0.05), (0.5, 0.01)] {
            let begun = Instant::now();
            let found = find(&subject.mesh, &VirtualEdges { normal_threshold: threshold, distance });
            let seconds = begun.elapsed().as_secs_f64();
            let together = pieces(&subject.mesh, &[real.as_slice(), &found].concat());
            counts.push((found.len(), together));
            table.row([
                subject.name.to_owned(),
                format!("{threshold}"),
                format!("{}", 100.0 * distance),
                format!("{}", real.len()),
                format!("{}", found.len()),
                format!("{alone}"),
                format!("{together}"),
                format!("{seconds:.2}"),
            ]);
        }
        fewer &= counts[0].0 >= counts[1].0 && counts[1].0 >= counts[2].0;
        pieces_of.push((subject.name, alone, counts[1].1));
    }
    entry.measured.push(table);
    let larger = "larger thresholds, fewer virtual edges: only vertices on boundaries of patches are joined";
    let why = "with fewer vertices a Gabriel graph has fewer edges, but fewer of them are edges of triangles as well, which do \
               not count as virtual";
    entry.claims.push(Claim::check(larger, fewer, "the numbers of each model are in the table", why).ours());
    let told: Vec<String> = pieces_of
        .iter()
        .map(|(name, alone, with)| format!("{name}: {alone} pieces by edges, {with} with virtual edges"))
        .collect();
    entry.claims.push(Claim::check(
        "virtual edges connect different objects",
        pieces_of.iter().all(|(_, alone, with)| with < alone),
        told.join("; "),
        "",
    ));
    entry.note("Edges of a Gabriel graph up to a length, which is a part of the Delaunay triangulation of the slide: all nearest neighbours are in it, and it needs no exact predicates.");
    Ok(())
}

fn edges_of(mesh: &Mesh<3>) -> Vec<[VertexId; 2]> {
    let sides = mesh.cells.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
    let mut edges: Vec<_> = sides.map(|[a, b]| [a.min(b), a.max(b)]).collect();
    edges.sort_unstable();
    edges.dedup();
    edges
}

/// How many pieces edges connect the vertices of triangles to.
fn pieces(mesh: &Mesh<3>, edges: &[[VertexId; 2]]) -> usize {
    let mut above: Vec<usize> = (0..mesh.positions.len()).collect();
    fn root(above: &mut [usize], mut v: usize) -> usize {
        while above[v] != v {
            above[v] = above[above[v]];
            v = above[v];
        }
        v
    }
    for &[a, b] in edges {
        let (a, b) = (root(&mut above, a.index()), root(&mut above, b.index()));
        above[a] = b;
    }
    let mut roots: Vec<usize> = mesh.cells.iter().flatten().map(|v| root(&mut above, v.index())).collect();
    roots.sort_unstable();
    roots.dedup();
    roots.len()
}

const SHARES: [f64; 4] = [0.5, 0.1, 0.05, 0.01];

/// An operator on an assembly: how far it goes, and what its meshes are like on the way.
struct Coarsened {
    name: &'static str,
    base: usize,
    /// At each share: triangles, pieces and mean distance from the input as a share of the diagonal.
    at: Vec<Option<(usize, usize, f64)>>,
    /// The mesh that is shown.
    mesh: Mesh<3>,
}

fn operators() -> [(&'static str, AnyOperator); 3] {
    let pair = |preference| {
        let pair = VertexPair { preference, ..VertexPair::default() };
        AnyOperator::VertexPair(pair.with(AnyMetric::Quadric(Quadrics)))
    };
    [
        ("edge-collapse", edge_collapse()),
        ("vertex-pair, geometry first", pair(Preference::GeometryFirst)),
        ("vertex-pair, equal", pair(Preference::Equal)),
    ]
}

fn coarsen(
    workshop: &mut Workshop<'_>,
    subject: &Subject,
    input: &Mesh<3>,
    name: &'static str,
    operator: &AnyOperator,
    shown: Option<usize>,
) -> Result<Coarsened, LedgerError> {
    let replay = workshop.sequence(subject, operator)?.replay;
    let model = Hierarchy { dependency: Stored::explicit(&replay), replay: Arc::clone(&replay) };
    let mut state = State::new(&model, ());
    let base = state.cell_count(&model) as usize;
    let whole = replay.cells().len();
    let surface = Surface::new(input).map_err(|error| LedgerError::Model(subject.name.into(), error.to_string()))?;
    let diagonal = input.diagonal();
    let mut at = Vec::new();
    for share in SHARES {
        workshop.go_on(name)?;
        let wanted = (whole as f64 * share) as usize;
        if base > wanted {
            at.push(None);
            continue;
        }
        approach(&model, &prefix(&replay, base, wanted), &mut state);
        let mesh = mesh_of(&model, &state.view.mesh);
        let sampling = Sampling { count: workshop.pick(10_000, 500), seed: 1 };
        let apart = Surface::new(&mesh).map(|coarse| coarse.distance(&surface, sampling));
        let rms = apart.map_or(f64::NAN, |apart| apart.rms() / diagonal);
        at.push(Some((mesh.cell_count(), pieces(&mesh, &edges_of(&mesh)), rms)));
    }
    approach(&model, &prefix(&replay, base, shown.unwrap_or(base)), &mut state);
    let mesh = mesh_of(&model, &state.view.mesh);
    Ok(Coarsened { name, base, at, mesh })
}

/// The front of the last merges, as many as give so many triangles.
fn prefix(replay: &Replay, base: usize, wanted: usize) -> Front {
    let mut front = Front::base(replay.len());
    let mut triangles = base;
    for m in (0..replay.len()).rev().map(NodeId) {
        triangles += replay.born(m).len();
        if triangles > wanted {
            break;
        }
        front.set(m, true);
    }
    front
}

pub(super) fn topology(workshop: &mut Workshop<'_>, _: &Published, entry: &mut Entry) -> Result<(), LedgerError> {
    let mut headings = vec!["model".to_owned(), "operator".to_owned(), "#base triangles".to_owned()];
    for share in SHARES {
        let percent = 100.0 * share;
        headings.extend([format!("#pieces at {percent} %"), format!("#RMS at {percent} %, 1e-3")]);
    }
    let mut table = Table::new(
        "Measured: pieces that edges connect, and distances from the input as shares of its diagonal; nothing where an operator does not come so far.",
        &headings.join(" | "),
    );
    let brush = Brush::new()?;
    let (mut bases, mut connected) = (Vec::new(), Vec::new());
    for role in &ASSEMBLIES {
        let whole = workshop.subject_unsplit(role)?;
        let split = workshop.subject(role)?;
        entry.models.push(whole.told());
        let before = pieces(&whole.mesh, &edges_of(&whole.mesh));
        let mut all = Vec::new();
        for (name, operator) in operators() {
            let subject = if operator.coarsens_topology() { &whole } else { &split };
            // The base mesh of the first, which goes least far, says at how many triangles all are shown.
            let shown = all.first().map(|first: &Coarsened| first.base);
            let coarsened = coarsen(workshop, subject, &whole.mesh, name, &operator, shown)?;
            let mut row = vec![role.name.to_owned(), name.to_owned(), coarsened.base.to_string()];
            for at in &coarsened.at {
                row.extend(at.map_or([String::new(), String::new()], |(_, pieces, rms)| {
                    [pieces.to_string(), format!("{:.2}", rms * 1e3)]
                }));
            }
            table.rows.push(row);
            all.push(coarsened);
        }
        bases.push([0, 1, 2].map(|i| all[i].base));
        connected.push([before, at_half(&all[1]), at_half(&all[2])]);
        for coarsened in &all {
            picture(entry, &brush, role.name, coarsened, &whole.mesh)?;
        }
    }
    entry.measured.push(table);
    entry.claims.push(Claim::check(
        "aggressive simplification: pairs go further than edges, which keep the topology",
        bases.iter().all(|[edges, first, equal]| first < edges && equal < edges),
        format!("base meshes of edges, of pairs with geometry first, and with an equal preference: {}", told(&bases)),
        "",
    ));
    entry.claims.push(Claim::check(
        "different objects are connected",
        connected.iter().all(|[before, _, after]| after < before),
        format!(
            "pieces of the input, and at half the triangles with geometry first and with an equal preference: {}",
            told(&connected)
        ),
        "",
    ));
    entry.claims.push(Claim::check(
        "with geometry first, topology is simplified after what keeps it",
        connected.iter().all(|[before, first, equal]| first > equal && 10 * first >= 9 * before),
        "at half the triangles nearly all pieces are there, and with an equal preference fewer (the numbers above)",
        "",
    ));
    entry.note("Edge collapse takes manifolds: its input has its sheets separated first, which is why it begins with more pieces.");
    Ok(())
}

/// Pieces at half the triangles.
fn at_half(coarsened: &Coarsened) -> usize {
    coarsened.at[0].map_or(0, |(_, pieces, _)| pieces)
}

fn told(models: &[[usize; 3]]) -> String {
    models.iter().map(|counts| counts.map(|count| count.to_string()).join(", ")).collect::<Vec<_>>().join("; ")
}

fn picture(
    entry: &mut Entry,
    brush: &Brush,
    model: &str,
    coarsened: &Coarsened,
    input: &Mesh<3>,
) -> Result<(), LedgerError> {
    let camera = close_up(input, Vec3::new(0.6, 0.45, 1.0), Vec3::Y);
    let scene = encode(&coarsened.mesh, &Look { wireframe: true, ..Look::default() });
    let name =
        format!("generalized-topology-{model}-{}.png", coarsened.name.replace([',', ' '], "-").replace("--", "-"));
    let caption = format!("{model} by {}: {} triangles", coarsened.name, coarsened.mesh.cell_count());
    entry.figures.push(brush.paint(&name, &caption, &scene, &camera)?);
    Ok(())
}
