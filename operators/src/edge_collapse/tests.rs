//! Every metric with every kind of edge collapse: models of which the laws hold, prices that are up to date, errors that
//! mean something.

use super::*;
use crate::metric::{AnyMetric, LindstromTurk};
use mt_core::analysis::{Options, simplify};
use mt_core::{Explicit, Mesh, MultiTessellation, NodeId, check, generate};
use proptest::prelude::*;

fn operator() -> impl Strategy<Value = EdgeCollapse<AnyMetric>> {
    let kind = prop_oneof![Just(EdgeCollapse::FULL), Just(EdgeCollapse::HALF)];
    let boundary = prop_oneof![3 => Just(BoundaryRule::Weighted), 1 => Just(BoundaryRule::Locked)];
    (kind, boundary, prop::sample::select(AnyMetric::ALL))
        .prop_map(|(kind, boundary, metric)| EdgeCollapse { boundary, ..kind }.with(metric))
}

fn model_of<M: Metric>(mesh: &Mesh<3>, operator: &EdgeCollapse<M>) -> Explicit<3> {
    simplify(mesh, operator, &Options::default(), &mut |_| true).expect("generated meshes are manifolds").model
}

fn laws(model: &Explicit<3>, mesh: &Mesh<3>, seed: u64) -> Result<(), check::Breach> {
    let order = check::order_of(model)?;
    check::order_from_cells(model)?;
    check::cells(model)?;
    check::saturation(model)?;
    check::ends(model, mesh)?;
    let domain = check::conformity(model)?;
    let mut random = check::Random::new(seed);
    for _ in 0..4 {
        let front = check::random_front(&order, &mut random);
        let cells: Vec<_> = check::set_algebra(model, &front)?.into_iter().map(|cell| *model.corners(cell)).collect();
        check::crack_free(&cells, model.positions(), &domain, &domain.boundary_at(&front))?;
    }
    Ok(())
}

/// Six times the volume inside a closed mesh.
fn volume(draft: &Draft<3>) -> f64 {
    let corners = |cell: &[VertexId; 3]| cell.map(|v| draft.positions[v.index()].as_dvec3());
    draft.complex.cells().map(|(_, cell)| corners(cell)).map(|[a, b, c]| a.dot(b.cross(c))).sum()
}

type Look<'a, M> = &'a mut dyn FnMut(&Draft<3>, &Aux<<M as Metric>::State>, &Plan<3>, &[(f64, Edge)]);

/// Applies the cheapest legal collapse again and again, `steps` times, and hands each to `look`: the draft before, the
/// plan, and all prices that the operator would have asked for by then.
fn steps<M: Metric>(mesh: &Mesh<3>, operator: &EdgeCollapse<M>, steps: usize, look: Look<'_, M>) {
    let mut draft = Draft::new(mesh);
    let mut sites = Vec::new();
    let mut aux = operator.prepare(&draft, &mut sites).expect("generated meshes are manifolds");
    let mut priced: Vec<_> = sites.iter().filter_map(|&s| Some((operator.price(&draft, &aux, s)?, s))).collect();
    let (mut plan, mut again, mut slots) = (Plan::default(), Vec::new(), Vec::new());
    for _ in 0..steps {
        priced.retain(|(_, site)| !aux.is_stale(&draft, *site));
        priced.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let good = priced.iter().find(|(_, site)| {
            plan.clear();
            operator.plan(&draft, &aux, *site, &mut plan).is_ok()
        });
        if good.is_none() {
            return;
        }
        look(&draft, &aux, &plan, &priced);
        draft.apply(&plan, &mut slots);
        again.clear();
        operator.applied(&draft, &mut aux, &plan, &mut again);
        priced.extend(again.iter().filter_map(|&s| Some((operator.price(&draft, &aux, s)?, s))));
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, ..ProptestConfig::default() })]

    #[test]
    fn laws_hold_for_every_metric(mesh_seed in any::<u64>(), operator in operator(), seed in any::<u64>()) {
        let generate::Named { name, mesh } = generate::random_mesh(mesh_seed);
        let model = model_of(&mesh, &operator);
        prop_assert_eq!(laws(&model, &mesh, seed), Ok(()), "{}", name);
        prop_assert!((0..model.len()).all(|m| model.bound(NodeId(m)).error.is_finite()));
        // The same again, bit for bit.
        prop_assert_eq!(format!("{model:?}"), format!("{:?}", model_of(&mesh, &operator)));
    }

    #[test]
    fn every_edge_waits_at_its_present_price(mesh_seed in any::<u64>(), operator in operator()) {
        let mesh = generate::random_mesh(mesh_seed).mesh;
        prop_assume!(mesh.cell_count() < 400);
        let mut wrong = Vec::new();
        steps(&mesh, &operator, 30, &mut |draft, aux, _, priced| {
            let mut edges: Vec<_> =
                draft.complex.cells().flat_map(|(_, &[a, b, c])| [aux.edge(a, b), aux.edge(b, c), aux.edge(c, a)]).collect();
            edges.sort_unstable();
            edges.dedup();
            for edge in edges {
                let now = operator.price(draft, aux, edge);
                if !priced.iter().any(|(price, site)| *site == edge && Some(*price) == now) {
                    wrong.push(edge);
                }
            }
        });
        prop_assert!(wrong.is_empty(), "{wrong:?}");
    }

    #[test]
    fn errors_do_not_fall_along_vertices(mesh_seed in any::<u64>(), half in any::<bool>()) {
        let mesh = generate::random_mesh(mesh_seed).mesh;
        let kind = if half { EdgeCollapse::HALF } else { EdgeCollapse::FULL };
        for metric in ["lindstrom-turk", "edge-length"] {
            let mut errors = vec![0.0; mesh.positions.len()];
            let mut falls = 0;
            let metric: AnyMetric = metric.parse().expect("a name of a metric");
            steps(&mesh, &kind.with(metric), 200, &mut |_, _, plan, _| {
                let most = plan.retired.iter().chain(&plan.kept).map(|v| errors[v.index()]).fold(0.0, f32::max);
                falls += usize::from(plan.error < most);
                match plan.kept {
                    Some(kept) => errors[kept.index()] = plan.error,
                    None => errors.push(plan.error),
                }
            });
            prop_assert_eq!(falls, 0);
        }
    }
}

#[test]
fn lindstrom_and_turk_keep_the_volume_of_closed_meshes() {
    for mesh in [generate::bumpy_sphere(3, 0.3, 5), generate::torus(24, 12), generate::genus_surface(2, 4, 0.08, 3)] {
        let before = volume(&Draft::new(&mesh));
        let mut last = 0.0;
        let mut taken = 0;
        steps(
            &mesh,
            &EdgeCollapse::FULL.with(LindstromTurk::DEFAULT),
            mesh.vertex_count() * 2 / 3,
            &mut |draft, _, _, _| {
                last = volume(draft);
                taken += 1;
            },
        );
        assert!(taken > mesh.vertex_count() / 2, "{taken} of {}", mesh.vertex_count());
        // Positions are rounded to single precision, each step anew.
        assert!((last - before).abs() < 1e-5 * before.abs(), "{before} became {last}");
    }
}

#[test]
fn lindstrom_and_turk_keep_the_area_of_a_flat_patch() {
    let mesh = generate::annulus(40, 4);
    let area = |draft: &Draft<3>| -> f64 {
        let corners = |cell: &[VertexId; 3]| cell.map(|v| draft.positions[v.index()].as_dvec3());
        draft.complex.cells().map(|(_, cell)| mt_core::mesh::area_vector(corners(cell)).length() / 2.0).sum()
    };
    let before = area(&Draft::new(&mesh));
    let mut last = 0.0;
    steps(&mesh, &EdgeCollapse::FULL.with(LindstromTurk::DEFAULT), 100, &mut |draft, _, _, _| last = area(draft));
    assert!((last - before).abs() < 1e-4 * before, "{before} became {last}");
}

#[test]
fn an_edge_length_error_bounds_how_far_vertices_are() {
    let mesh = generate::bumpy_sphere(3, 0.2, 8);
    let options = Options { until_cells: Some(80), ..Options::default() };
    let operator = EdgeCollapse::FULL.with(crate::metric::EdgeLength);
    let model = simplify(&mesh, &operator, &options, &mut |_| true).expect("a sphere is a manifold").model;
    let stated = (0..model.len()).map(|m| model.bound(NodeId(m)).error).fold(0.0, f32::max);
    let base = mt_core::model::mesh_of(&model, &model.base());
    for p in &mesh.positions {
        let nearest = base.positions.iter().map(|q| q.distance(*p)).fold(f32::INFINITY, f32::min);
        assert!(nearest <= stated * 1.0001, "{nearest} > {stated}");
    }
}
