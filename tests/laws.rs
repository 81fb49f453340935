//! Every law on generated meshes of every kind, for every operator: conformity, cells, crack-freeness, inverse,
//! front-determines-mesh, ends, determinism, order, closure, minimality, saturation.

use mt_core::analysis::{Draft, Operator, Options, Stopped, simplify};
use mt_core::generate::{self, Named};
use mt_core::{ErrorKind, Mesh, MultiTessellation, Refusal, check};
use mt_tests::model_of;
use multi_tessellation::verify;
use operators::EdgeCollapse;
use operators::edge_collapse::BoundaryRule;
use proptest::prelude::*;

fn operator() -> impl Strategy<Value = EdgeCollapse> {
    let kind = prop_oneof![Just(EdgeCollapse::FULL), Just(EdgeCollapse::HALF)];
    let boundary = prop_oneof![4 => Just(BoundaryRule::Weighted), 1 => Just(BoundaryRule::Locked)];
    (kind, boundary).prop_map(|(kind, boundary)| EdgeCollapse { boundary, ..kind })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 96, ..ProptestConfig::default() })]

    #[test]
    fn every_law_holds(mesh_seed in any::<u64>(), operator in operator(), measured in any::<bool>(), seed in any::<u64>()) {
        let Named { name, mesh } = generate::random_mesh(mesh_seed);
        let error_kind = if measured { ErrorKind::Measured } else { ErrorKind::Estimate };
        let options = Options { error_kind, ..Options::default() };
        let model = simplify(&mesh, &operator, &options, &mut |_| true).expect("generated meshes are manifolds").model;
        prop_assert!(check::ends(&model, &mesh).is_ok(), "{name}: the full front is not the input");
        let verdict = verify::explicit(&model, &verify::Options { fronts: 12, seed, ..verify::Options::default() }, &mut |_| true);
        if let Err(found) = verdict {
            prop_assert!(false, "{name}: {} at a front of {} nodes", found.breach, found.front.len());
        }
    }

    #[test]
    fn the_same_input_gives_the_same_model(mesh_seed in any::<u64>(), operator in operator()) {
        let mesh = generate::random_mesh(mesh_seed).mesh;
        prop_assert_eq!(verify::determinism(&mesh, &operator), Ok(()));
    }

    #[test]
    fn wishes_stop_analysis_where_they_say(mesh_seed in any::<u64>(), share in 0.0f64..1.0) {
        let mesh = generate::random_mesh(mesh_seed).mesh;
        let all = model_of(&mesh, &EdgeCollapse::FULL);
        let wanted = (mesh.cell_count() as f64 * share) as u32;
        let options = Options { until_cells: Some(wanted), ..Options::default() };
        let part = simplify(&mesh, &EdgeCollapse::FULL, &options, &mut |_| true).unwrap();
        if part.stopped == Stopped::Cells {
            // A collapse takes one triangle or two.
            prop_assert!(part.model.base_cells().len() as u32 <= wanted);
            prop_assert!(part.model.is_empty() || part.model.base_cells().len() as u32 + 2 > wanted);
        } else {
            prop_assert_eq!(part.model.base_cells().len(), all.base_cells().len());
        }
    }

    #[test]
    fn no_error_beyond_the_wish(mesh_seed in any::<u64>(), share in 0.0f32..0.1) {
        let mesh = generate::random_mesh(mesh_seed).mesh;
        let most = mesh.diagonal() as f32 * share;
        let options = Options { until_error: Some(most), ..Options::default() };
        let model = simplify(&mesh, &EdgeCollapse::FULL, &options, &mut |_| true).unwrap().model;
        for m in 0..model.len() {
            prop_assert!(model.bound(mt_core::NodeId(m)).error <= most);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 32, ..ProptestConfig::default() })]

    #[test]
    fn a_locked_boundary_stays_vertex_by_vertex(mesh_seed in any::<u64>(), half in any::<bool>()) {
        let mesh = generate::random_mesh(mesh_seed).mesh;
        let kind = if half { EdgeCollapse::HALF } else { EdgeCollapse::FULL };
        let model = model_of(&mesh, &EdgeCollapse { boundary: BoundaryRule::Locked, ..kind });
        prop_assert!(check::conformity(&model).unwrap().boundary_fixed);
    }
}

#[test]
fn closed_surfaces_reach_a_handful_of_triangles() {
    for (mesh, most) in [
        (generate::sphere(3), 4),
        (generate::bumpy_sphere(4, 0.1, 3), 4),
        // Seven vertices and fourteen triangles are the least for a torus.
        (generate::torus(24, 16), 40),
    ] {
        let model = model_of(&mesh, &EdgeCollapse::FULL);
        assert!(
            model.base_cells().len() <= most,
            "{} triangles are left of {}",
            model.base_cells().len(),
            mesh.cell_count()
        );
    }
}

#[test]
fn nothing_is_left_to_do_on_the_smallest_meshes() {
    for mesh in [generate::tetrahedron(), generate::triangle()] {
        let model = model_of(&mesh, &EdgeCollapse::FULL);
        assert_eq!((model.len(), model.base_cells().len()), (0, mesh.cell_count()));
        verify::explicit(&model, &verify::Options { fronts: 3, seed: 1, ..verify::Options::default() }, &mut |_| true)
            .expect("laws hold without nodes");
    }
    let model = model_of(&generate::octahedron(), &EdgeCollapse::FULL);
    assert_eq!(model.base_cells().len(), 4);
}

#[test]
fn a_mesh_without_cells_is_a_model_without_nodes() {
    let model = model_of(&Mesh::default(), &EdgeCollapse::FULL);
    assert!(model.is_empty());
    verify::explicit(&model, &verify::Options { fronts: 2, seed: 1, ..verify::Options::default() }, &mut |_| true)
        .expect("laws hold on nothing");
}

#[test]
fn non_manifolds_are_refused_with_counts_and_places() {
    for (mesh, what) in [(generate::hourglass(), "1 vertices"), (generate::fan3(), "1 edges")] {
        let error = simplify(&mesh, &EdgeCollapse::FULL, &Options::default(), &mut |_| true).unwrap_err().to_string();
        assert!(error.contains(what), "{error}");
    }
}

#[test]
fn measured_errors_bound_the_distance_of_input_vertices() {
    // The oracle looks at every triangle of the coarse mesh, not at those that the modification made.
    let mesh = generate::bumpy_sphere(3, 0.15, 5);
    let options = Options { error_kind: ErrorKind::Measured, until_cells: Some(60), ..Options::default() };
    let model = simplify(&mesh, &EdgeCollapse::FULL, &options, &mut |_| true).unwrap().model;
    let stated = (0..model.len()).map(|m| model.bound(mt_core::NodeId(m)).error).fold(0.0, f32::max);
    let base = mt_core::model::mesh_of(&model, &model.base());
    for p in &mesh.positions {
        let nearest = base
            .cells
            .iter()
            .map(|cell| distance(*p, cell.map(|v| base.positions[v.index()])))
            .fold(f64::INFINITY, f64::min);
        assert!(nearest <= f64::from(stated), "{nearest} > {stated}");
    }
}

/// Distance from a point to a triangle by ternary search over barycentric coordinates: slow, and another way than ours.
fn distance(p: glam::Vec3, triangle: [glam::Vec3; 3]) -> f64 {
    let [p, a, b, c] = [p, triangle[0], triangle[1], triangle[2]].map(|v| v.as_dvec3());
    let along = |s: f64| {
        let (from, to) = (a.lerp(b, s), a.lerp(c, s));
        least(|t| p.distance(from.lerp(to, t)))
    };
    least(along)
}

fn least(value: impl Fn(f64) -> f64) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..60 {
        let third = (high - low) / 3.0;
        if value(low + third) < value(high - third) { high -= third } else { low += third }
    }
    value((low + high) * 0.5)
}

#[test]
fn coordinates_too_large_for_a_sphere_are_refused() {
    let mut mesh = generate::octahedron();
    mesh.positions.iter_mut().for_each(|p| *p *= 3.0e38);
    let error = simplify(&mesh, &EdgeCollapse::FULL, &Options::default(), &mut |_| true).unwrap_err().to_string();
    assert!(error.contains("not finite"), "{error}");
}

#[test]
fn a_hub_of_thousands_of_triangles_takes_no_forever() {
    // A closed fan whose rim is locked: every site is refused, each beside a vertex of degree 4,000.
    let rim = (0..4000).map(|i| (i as f32 / 4000.0 * std::f32::consts::TAU).sin_cos());
    let mut positions: Vec<_> = rim.map(|(y, x)| glam::Vec3::new(x, y, 0.0)).collect();
    positions.push(glam::Vec3::ZERO);
    let cells: Vec<_> = (0..4000).map(|i| [i, (i + 1) % 4000, 4000]).collect();
    let fan = Mesh::from_indices(positions, &cells);
    for boundary in [BoundaryRule::Locked, BoundaryRule::Weighted] {
        let begun = std::time::Instant::now();
        model_of(&fan, &EdgeCollapse { boundary, ..EdgeCollapse::FULL });
        assert!(begun.elapsed().as_secs() < 20, "{boundary:?} took {:?}", begun.elapsed());
    }
}

#[test]
fn flat_parts_go_before_edges_do() {
    // Each face of a cube is flat: next to nothing of it is needed for no error at all.
    let cube = generate::sharp_box(16);
    for operator in [EdgeCollapse::FULL, EdgeCollapse::HALF] {
        let model = model_of(&cube, &operator);
        let wish = selective::UniformError { error_max: cube.diagonal() as f32 * 1e-5 };
        let (state, _) = selective::extract(&model, &wish, &selective::Limits::NONE, selective::Strategy::TopDown, ());
        assert!(state.cell_count(&model) <= 60, "{} of {} triangles", state.cell_count(&model), cube.cell_count());
    }
}

#[test]
fn a_second_choice_is_taken_at_its_own_price() {
    // It is never cheaper than the first, or it would be done before its time and tear what is sharp.
    let mesh = generate::bumpy_sphere(3, 0.2, 5);
    let draft = Draft::new(&mesh);
    for operator in [EdgeCollapse::FULL, EdgeCollapse::HALF] {
        let mut sites = Vec::new();
        let aux = operator.prepare(&draft, &mut sites).unwrap();
        let mut dearer = 0;
        for site in sites {
            let second = operator.alternative(site, Refusal::FoldOver).expect("a first choice has a second");
            assert_eq!(operator.alternative(second, Refusal::FoldOver), None);
            let [first, second] = [site, second].map(|site| operator.price(&draft, &aux, site).unwrap());
            assert!(second >= first * 0.999_999, "{second} < {first}");
            dearer += u32::from(second > first * 1.01);
        }
        assert!(dearer > 100, "only {dearer} second choices cost more");
    }
}
