//! Faults planted in a replay, each seen by the law that is there for it.

use super::replay::Born;
use super::{Dependency, Hierarchy, Replay, Sequence, VertexMesh};
use crate::check::{self, Law};
use crate::front::Front;
use crate::id::{CellId, NodeId, VertexId};
use crate::mesh::Mesh;
use crate::model::{Coarsen, MultiTessellation, Rule, Step, View, take};
use crate::{Bits, generate};
use glam::Vec3;
use std::sync::Arc;

/// An icosahedron after two edge collapses, the second at the vertex that the first made.
fn sample() -> (Mesh<3>, Replay) {
    let mesh = generate::icosahedron();
    let mut sequence = Sequence::new(&mesh);
    let [a, b, _] = mesh.cells[0];
    let merged = sequence.push(a, [b], [0.1], mesh.positions[a.index()].midpoint(mesh.positions[b.index()]), false);
    let around = |v: VertexId| mesh.cells.iter().filter(move |cell| cell.contains(&v)).flatten().copied();
    let next = around(a).find(|w| *w != a && *w != b && !around(b).any(|x| x == *w)).expect("a neighbour of one end");
    sequence.push(merged, [next], [0.2], Vec3::ZERO, false);
    let replay = Replay::new(&mesh, &[], &sequence).expect("a sequence");
    (mesh, replay)
}

/// Whether the mesh of each front that steps reach is the quotient.
fn is_quotient(replay: &Replay) -> bool {
    let mut mesh = replay.reference_mesh();
    let mut front = Front::reference(replay.len());
    let mut good = true;
    for m in (0..replay.len()).map(NodeId) {
        replay.coarsen(m, &mut mesh, &mut ());
        front.set(m, false);
    }
    for m in (0..replay.len()).rev().map(NodeId) {
        replay.refine(m, &mut mesh, &mut ());
        front.set(m, true);
        let cells: Vec<_> = mesh.faces.cells().map(|(slot, corners)| (CellId(slot), *corners)).collect();
        good &= cells == check::quotient(replay, &front);
    }
    good
}

#[test]
fn a_good_replay_is_good() {
    let (mesh, replay) = sample();
    assert!(is_quotient(&replay) && replay.is_manifold() && replay.reference() == mesh);
    assert_eq!(check::patch_bounds(&replay), Ok(()));
    assert_eq!(check::dual_pieces(&replay, &Front::base(replay.len())), Ok(()));
}

#[test]
fn swapped_ranks_are_seen_by_the_quotient() {
    let (mesh, mut replay) = sample();
    let [a, b, _] = mesh.cells[0].map(|v| v.index());
    replay.ranks.swap(a, b);
    assert!(!is_quotient(&replay));
}

#[test]
fn a_piece_that_is_not_where_it_should_be_is_seen_by_the_partition() {
    let (_, mut replay) = sample();
    replay.merges[1].span.first += 1;
    let breach = check::dual_pieces(&replay, &Front::base(replay.len())).unwrap_err();
    assert_eq!(breach.law, Law::Partition);
}

#[test]
fn a_triangle_of_the_wrong_node_is_seen_by_the_quotient() {
    let (_, mut replay) = sample();
    let Born::Pairs(pairs) = &mut replay.born else { panic!("edge collapses of a manifold") };
    let other = (0..20).map(CellId).find(|cell| !pairs.iter().flatten().any(|c| c == cell)).expect("twenty triangles");
    // Coarsening takes away what it should not, and refining would bring it back: only the coarse mesh is wrong.
    pairs[1][0] = other;
    let mut mesh = replay.reference_mesh();
    replay.coarsen(NodeId(0), &mut mesh, &mut ());
    replay.coarsen(NodeId(1), &mut mesh, &mut ());
    let cells: Vec<_> = mesh.faces.cells().map(|(slot, corners)| (CellId(slot), *corners)).collect();
    assert_ne!(cells, check::quotient(&replay, &Front::base(replay.len())));
}

#[test]
fn spheres_and_cones_that_are_too_small_are_seen() {
    let (_, mut replay) = sample();
    replay.nodes[1].radius = 0.5;
    assert_eq!(check::patch_bounds(&replay).unwrap_err().law, Law::Saturation);
    let (_, mut replay) = sample();
    replay.nodes[0].cone = crate::Cone::new(Vec3::X, 0.0);
    assert_eq!(check::patch_bounds(&replay).unwrap_err().law, Law::Saturation);
}

#[test]
fn what_sews_is_known() {
    // Two triangles side by side, merged at opposite corners: no edge of theirs, and no umbrella afterwards.
    let mesh = generate::components(&[generate::triangle(), generate::triangle()]);
    let mut sequence = Sequence::new(&mesh);
    sequence.push(VertexId(0), [VertexId(3)], [0.0], Vec3::ZERO, false);
    let replay = Replay::new(&mesh, &[], &sequence).unwrap();
    assert_eq!(replay.sewn(), [NodeId(0)]);
}

/// What sews, by looking at the umbrella and the neighbours of every merge.
fn sewn_by_looking(replay: &Replay) -> Vec<NodeId> {
    let mut mesh = replay.reference_mesh();
    let mut links = super::umbrellas::Links::default();
    let mut edges = Vec::new();
    let neighbours = |mesh: &VertexMesh, v| {
        let mut around = Vec::new();
        mesh.faces.neighbours(v, &mut around);
        std::collections::BTreeSet::from_iter(around)
    };
    let sews = |m: &NodeId| {
        let [near, also_near] = replay.ends(*m).map(|end| neighbours(&mesh, end));
        let shared = near.intersection(&also_near).count();
        let ends = replay.ends(*m);
        let on_border = |v: VertexId| neighbours(&mesh, v).iter().any(|&w| mesh.faces.edge_degree(v, w) == 1);
        let pinches = mesh.faces.edge_degree(ends[0], ends[1]) == 2 && ends.into_iter().all(on_border);
        replay.coarsen(*m, &mut mesh, &mut ());
        mesh.faces.link_edges(replay.vertex(*m), &mut edges);
        pinches || shared != replay.born(*m).len() || links.fan(&edges) == super::umbrellas::Fan::Other
    };
    (0..replay.len()).map(NodeId).filter(sews).collect()
}

/// Merges along edges of the input, whatever the links say about it; some with a third vertex, as fans have.
fn careless_merges(mesh: &Mesh<3>, seed: u64) -> Sequence {
    let mut random = check::Random::new(seed);
    let mut sequence = Sequence::new(mesh);
    let mut name: Vec<VertexId> = (0..mesh.vertex_count()).map(VertexId::new).collect();
    for _ in 0..mesh.vertex_count() {
        let cell = mesh.cells[random.below(mesh.cell_count())];
        let [a, b, c] = cell.map(|v| name[v.index()]);
        if a != b {
            let is_fan = seed % 2 == 1 && c != a && c != b && random.below(4) == 0;
            let joined = if is_fan { vec![b, c] } else { vec![b] };
            let at = mesh.positions[cell[0].index()].midpoint(mesh.positions[cell[1].index()]);
            let made = sequence.push(a, joined.iter().copied(), vec![0.1; joined.len()], at, false);
            name.iter_mut().filter(|v| **v == a || joined.contains(v)).for_each(|v| *v = made);
        }
    }
    sequence
}

fn careless_cases() -> impl Iterator<Item = (Mesh<3>, Sequence)> {
    let meshes = [generate::torus(7, 5), generate::octahedron(), generate::sphere(2), generate::grid(5, 5)];
    let with_seeds = move |mesh: Mesh<3>| {
        (0..200).map(move |seed| {
            let sequence = careless_merges(&mesh, seed);
            (mesh.clone(), sequence)
        })
    };
    meshes.into_iter().flat_map(with_seeds)
}

#[test]
fn what_sews_is_what_looking_finds() {
    for (case, (mesh, sequence)) in careless_cases().enumerate() {
        let replay = Replay::new(&mesh, &[], &sequence).unwrap();
        assert_eq!(replay.sewn(), sewn_by_looking(&replay), "case {case}");
    }
}

/// Closed surfaces and ones with boundaries, one-sided, in several parts, with ears, and with several boundaries.
fn surfaces() -> Vec<Mesh<3>> {
    let grid = generate::grid(6, 6);
    let center = Vec3::from_array([0, 1, 2].map(|axis| grid.positions.iter().map(|p| p[axis]).sum::<f32>() / 36.0));
    let is_far = |cell: &&[VertexId; 3]| cell.iter().all(|v| grid.positions[v.index()].distance(center) > 0.2);
    let annulus = Mesh { cells: grid.cells.iter().filter(is_far).copied().collect(), ..grid.clone() }.compact();
    let v = VertexId::new;
    let band = |i: usize| [[v(i % 7), v((i + 1) % 7), v((i + 2) % 7)]];
    let moebius =
        Mesh { positions: generate::sphere(2).positions[..7].to_vec(), cells: (0..7).flat_map(band).collect() };
    let ear = generate::strip(5);
    let parts = generate::components(&[generate::octahedron(), generate::triangle(), generate::octahedron()]);
    vec![
        generate::octahedron(),
        generate::torus(5, 4),
        generate::sphere(2),
        annulus,
        moebius,
        ear,
        parts,
        generate::grid(4, 3),
    ]
}

/// Merges of two corners of a triangle that is there now, most of them such that two triangles of the surface die, counting those
/// over the boundary: what a count is needed for.
fn plain_merges(mesh: &Mesh<3>, random: &mut check::Random) -> Sequence {
    let mut sequence = Sequence::new(mesh);
    let mut cells = mesh.cells.clone();
    for _ in 0..2 + random.below(mesh.vertex_count()) {
        let Some(cell) = cells.get(random.below(cells.len().max(1))).copied() else { break };
        let [a, b] = [cell[0], cell[1]];
        let dying = cells.iter().filter(|cell| cell.contains(&a) && cell.contains(&b)).count();
        if dying > 2 && random.below(8) > 0 {
            continue;
        }
        let made = sequence.push(a, [b], [0.1], mesh.positions[0], false);
        cells.retain(|cell| !(cell.contains(&a) && cell.contains(&b)));
        cells.iter_mut().flatten().filter(|v| **v == a || **v == b).for_each(|v| *v = made);
    }
    sequence
}

#[test]
fn what_is_proved_by_counting_is_what_looking_finds() {
    let mut random = check::Random::new(11);
    // Proved, sewn, and neither: a false alarm.
    let mut seen = [0; 3];
    for mesh in surfaces() {
        for _ in 0..150 {
            let sequence = plain_merges(&mesh, &mut random);
            let size = [2, 5, u32::MAX][random.below(3)];
            let (replay, is_proved) = Replay::in_portions(&mesh, &[], &sequence, size).unwrap();
            let sewn = sewn_by_looking(&replay);
            assert!(!is_proved || sewn.is_empty() && replay.is_manifold, "{:?}: {sewn:?}", sequence.children);
            assert_eq!(replay.sewn(), sewn);
            seen[if is_proved { 0 } else { 2 - usize::from(!sewn.is_empty()) }] += 1;
        }
    }
    assert!(seen[0] > 100 && seen[1] > 100, "{seen:?}");
}

/// One surface and its merges for each condition of the proof: without it something would be proved that is not so.
#[test]
fn no_condition_of_the_proof_is_idle() {
    let v = VertexId;
    let proves = |mesh: &Mesh<3>, merges: &[[u32; 2]]| {
        let mut sequence = Sequence::new(mesh);
        merges.iter().for_each(|[a, b]| _ = sequence.push(v(*a), [v(*b)], [0.1], Vec3::ZERO, false));
        let (replay, is_proved) = Replay::in_portions(mesh, &[], &sequence, u32::MAX).unwrap();
        assert_eq!(is_proved, sewn_by_looking(&replay).is_empty());
        is_proved
    };
    let of = |count: usize, cells: &[[u32; 3]]| Mesh {
        positions: (0..count).map(|i| Vec3::new(i as f32, (i * i % 7) as f32, (i * i * i % 5) as f32)).collect(),
        cells: cells.iter().map(|cell| cell.map(v)).collect(),
    };
    // Three or more are left around the vertex: a tetrahedron becomes two triangles on one another.
    let tetrahedron = of(4, &[[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]]);
    assert!(!proves(&tetrahedron, &[[0, 1]]));
    // Three neighbours in common: a waist closes, and an edge of the base has four triangles.
    let waist: Vec<[u32; 3]> = (0..3u32)
        .flat_map(|i| {
            let j = (i + 1) % 3;
            [[i, j, 3 + i], [j, 3 + j, 3 + i], [j, i, 6 + i], [6 + j, j, 6 + i]]
        })
        .chain([[3, 4, 9], [4, 5, 9], [5, 3, 9], [7, 6, 10], [8, 7, 10], [6, 8, 10]])
        .collect();
    assert!(!proves(&of(11, &waist), &[[0, 1]]));
    // The tip in common: an inner edge from boundary to boundary, and a vertex of the base has two of them.
    assert!(!proves(&of(4, &[[0, 1, 2], [1, 0, 3]]), &[[0, 1]]));
    let strip = of(6, &[[0, 1, 2], [2, 1, 3], [2, 3, 4], [4, 3, 5]]);
    assert!(!proves(&strip, &[[2, 3]]) && proves(&strip, &[[0, 2]]));
    // Not two that die: ends that are no neighbours.
    let octahedron = generate::octahedron();
    let shares = |w: u32| octahedron.cells.iter().any(|cell| cell.contains(&v(0)) && cell.contains(&v(w)));
    let opposite = (1..6).find(|&w| !shares(w)).expect("one of five is opposite");
    assert!(!proves(&octahedron, &[[0, opposite]]));
}

#[test]
fn portions_change_nothing() {
    // Most of these sew; those that keep are proved to by counting.
    let kept = [generate::torus(30, 20), generate::grid(16, 9)].map(|mesh| (keeping_merges(&mesh), mesh));
    for (case, (mesh, sequence)) in kept.into_iter().map(|(s, mesh)| (mesh, s)).chain(careless_cases()).enumerate() {
        let links = if case % 3 == 0 { vec![[VertexId(0), VertexId(4)], [VertexId(1), VertexId(2)]] } else { vec![] };
        let whole = Replay::in_portions(&mesh, &links, &sequence, u32::MAX).unwrap().0;
        for size in [2, 5, 16, 40] {
            let cut = Replay::in_portions(&mesh, &links, &sequence, size).unwrap().0;
            let name = format!("case {case} in portions of {size}");
            for m in 0..whole.nodes.len() {
                assert_eq!(cut.nodes[m], whole.nodes[m], "{name}, node {m}");
            }
            assert!(cut == whole, "{name}");
        }
    }
}

#[test]
fn threads_change_nothing() {
    let mesh = generate::torus(60, 40);
    let sequence = careless_merges(&mesh, 5);
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| Replay::in_portions(&mesh, &[], &sequence, 50).unwrap().0)
    };
    let by_one = with(1);
    assert!(with(2) == by_one && with(16) == by_one);
}

/// Merges along edges whose ends have two neighbours in common, and no vertex that has been near a merge.
fn keeping_merges(mesh: &Mesh<3>) -> Sequence {
    let mut sequence = Sequence::new(mesh);
    let mut is_near = vec![false; mesh.vertex_count()];
    for cell in &mesh.cells {
        let ends = [cell[0], cell[1]];
        let around = || mesh.cells.iter().filter(|cell| ends.iter().any(|end| cell.contains(end))).flatten();
        if around().all(|v| !is_near[v.index()]) {
            around().for_each(|v| is_near[v.index()] = true);
            let at = mesh.positions[ends[0].index()].midpoint(mesh.positions[ends[1].index()]);
            sequence.push(ends[0], [ends[1]], [0.1], at, false);
        }
    }
    sequence
}

/// Bounds by their definition: of each patch in the whole mesh, and then of all that is under it.
fn bounds_by_looking(replay: &Replay) -> Vec<crate::Bound> {
    let at = |v: VertexId| replay.positions()[v.index()];
    let normal =
        |cell: crate::Cell<3>| crate::mesh::area_vector(cell.map(|v| at(v).as_dvec3())).as_vec3().normalize_or_zero();
    let mut mesh = replay.reference_mesh();
    let mut bounds: Vec<crate::Bound> = Vec::new();
    for m in (0..replay.len()).map(NodeId) {
        let (ends, into) = (replay.ends(m), replay.vertex(m));
        let center = at(into);
        // Each triangle around the ends once, before and after; those that die have no after.
        let mut both: Vec<Vec3> = Vec::new();
        for (number, end) in ends.into_iter().enumerate() {
            for (slot, _) in mesh.faces.star(end) {
                let cell = *mesh.faces.cell(slot);
                let dies = ends.iter().all(|end| cell.contains(end));
                both.extend((number == 0 || !dies).then(|| normal(cell)));
                both.extend((!dies).then(|| normal(cell.map(|v| if v == end { into } else { v }))));
            }
        }
        let around = ends.into_iter().flat_map(|end| mesh.ring(end)).chain(ends);
        let reach = around.map(|v| at(v).as_dvec3().distance(center.as_dvec3())).fold(0.0, f64::max);
        replay.coarsen(m, &mut mesh, &mut ());
        let (radius, cone) = (((reach * (1.0 + 1e-14)) as f32).next_up(), crate::Cone::of_normals(&both));
        let mut node = super::Node { child: VertexId::NONE, error: 0.1, radius, cone };
        let mut under: Vec<NodeId> = replay.children(m).collect();
        under.sort_unstable();
        under.iter().for_each(|child| super::build::include(&mut node, center, &bounds[child.index()]));
        bounds.push(crate::Bound { center, radius: node.radius, error: node.error, cone: node.cone });
    }
    bounds
}

#[test]
fn bounds_are_what_looking_finds() {
    for (case, (mesh, sequence)) in careless_cases().enumerate() {
        let replay = Replay::in_portions(&mesh, &[], &sequence, 9).unwrap().0;
        let told: Vec<_> = (0..replay.len()).map(|m| replay.bound(NodeId(m))).collect();
        for (m, looked) in bounds_by_looking(&replay).iter().enumerate() {
            assert_eq!(told[m], *looked, "case {case}, node {m}");
        }
    }
}

/// Vertices without triangles join the tip of a cone one after the other, so that each of its triangles has a life as long as the
/// sequence.
#[test]
fn long_lives_are_lived_again_and_not_written_down() {
    let mut mesh = generate::octahedron();
    let rim = mesh.vertex_count();
    mesh.positions.extend((0..400).map(|i| Vec3::new((i % 7) as f32, (i % 5) as f32, (i % 3) as f32)));
    let mut sequence = Sequence::new(&mesh);
    let mut tip = VertexId(0);
    for i in rim..mesh.positions.len() {
        tip = sequence.push(tip, [VertexId::new(i)], [0.1], mesh.positions[i] * 0.5, false);
    }
    for size in [9, u32::MAX] {
        let (replay, _) = Replay::in_portions(&mesh, &[], &sequence, size).unwrap();
        let told: Vec<_> = (0..replay.len()).map(|m| replay.bound(NodeId(m))).collect();
        assert!(told == bounds_by_looking(&replay), "portions of {size}");
    }
}

#[test]
fn sequences_that_are_none_are_refused() {
    let mesh = generate::octahedron();
    let refused = |change: &dyn Fn(&mut Sequence)| {
        let mut sequence = Sequence::new(&mesh);
        sequence.push(VertexId(0), [VertexId(2)], [0.1], Vec3::ZERO, false);
        change(&mut sequence);
        Replay::new(&mesh, &[], &sequence).map(|_| ()).unwrap_err().to_string()
    };
    for (change, says) in [
        (&(|s: &mut Sequence| s.children[0] = VertexId(0)) as &dyn Fn(&mut Sequence), "merged already"),
        (&|s| s.centers[0] = VertexId(6), "not made yet"),
        (&|s| s.errors[0] = f32::NAN, "error"),
        (&|s| s.errors.clear(), "errors"),
        (&|s| s.positions[0] = Vec3::splat(f32::INFINITY), "position"),
        (&|s| s.starts = vec![0, 0], "runs"),
        (&|s| s.starts.clear(), "runs"),
        (&|s| (s.centers, s.positions, s.starts) = (vec![VertexId(0); 2], vec![Vec3::ZERO; 2], vec![0, 0, 1]), "runs"),
        (&|s| s.input_vertex_count = 7, "7 vertices"),
        (&|s| s.kept = Bits::full(1), "moves it"),
    ] {
        let told = refused(change);
        assert!(told.contains(says), "{told}");
    }
    let sequence = Sequence::new(&mesh);
    assert!(Replay::new(&mesh, &[[VertexId(0), VertexId(0)]], &sequence).is_err());
    assert!(Replay::new(&mesh, &[[VertexId(0), VertexId(9)]], &sequence).is_err());
}

/// Waits for nothing, or with `always` for the last node, whatever the view.
struct Waits {
    always: Option<NodeId>,
}

impl Dependency for Waits {
    const RULE: Rule = Rule::Static;
    fn needs(&self, _: &Replay, _: NodeId, out: &mut Vec<NodeId>) {
        out.extend(self.always);
    }
    fn prerequisites(&self, _: &Replay, _: NodeId, _: &View<VertexMesh>, out: &mut Vec<NodeId>) {
        out.extend(self.always);
    }
    fn obstacles(&self, _: &Replay, _: NodeId, _: &View<VertexMesh>, _: &mut Vec<NodeId>) -> Coarsen {
        Coarsen::Now
    }
    fn bytes(&self) -> usize {
        1000
    }
}

#[test]
fn a_hierarchy_tells_what_its_parts_tell() {
    let replay = Arc::new(sample().1);
    let always = Some(NodeId(7));
    let model = Hierarchy { replay: Arc::clone(&replay), dependency: Waits { always } };
    assert_eq!(model.bytes(), replay.bytes() + 1000);
    assert_eq!([0, 1].map(|m| model.gain(NodeId(m))), [Some(2), Some(2)]);
    assert_eq!(model.positions(), replay.positions());
    // A static order is asked even while the parent is coarse, a parent that is refined is not named.
    let mut view = model.base_view();
    let told = |view: &View<VertexMesh>, m| {
        let mut out = Vec::new();
        model.prerequisites(NodeId(m), view, &mut out);
        out.iter().map(|m| m.0).collect::<Vec<_>>()
    };
    assert_eq!((told(&view, 0), told(&view, 1)), (vec![1, 7], vec![7]));
    take(&model, Step::refine(NodeId(1)), &mut view, &mut ());
    assert_eq!(told(&view, 0), [7]);
    // Of those under a node only the refined ones are in the way.
    let obstacles = |view: &View<VertexMesh>| {
        let mut out = Vec::new();
        (model.obstacles(NodeId(1), view, &mut out), out)
    };
    assert_eq!(obstacles(&view), (Coarsen::Now, vec![]));
    take(&model, Step::refine(NodeId(0)), &mut view, &mut ());
    assert_eq!(obstacles(&view), (Coarsen::After, vec![NodeId(0)]));
}

#[test]
fn merges_that_keep_their_centre_are_known() {
    let mesh = generate::icosahedron();
    let [a, b, _] = mesh.cells[0];
    let mut sequence = Sequence::new(&mesh);
    let merged = sequence.push(a, [b], [0.1], mesh.positions[a.index()], true);
    let around = |v: VertexId| mesh.cells.iter().filter(move |cell| cell.contains(&v)).flatten().copied();
    let next = around(a).find(|w| *w != a && *w != b && !around(b).any(|x| x == *w)).expect("a neighbour of one end");
    sequence.push(merged, [next], [0.2], Vec3::ZERO, false);
    let replay = Replay::new(&mesh, &[], &sequence).expect("a sequence");
    assert!(replay.keeps_center(0) && !replay.keeps_center(1) && !replay.keeps_center(2));
    assert_eq!((replay.merge_count(), replay.roots()), (2, [NodeId(1)].as_slice()));
}

#[test]
fn bytes_are_counted_array_by_array() {
    let (mesh, replay) = sample();
    let table: std::collections::BTreeMap<_, _> = replay.bytes_table().into_iter().collect();
    let (nodes, leaves) = (2, mesh.vertex_count());
    let expected = [
        ("positions of merged vertices", 12 * nodes),
        ("centres and spans", 12 * nodes),
        ("children, errors, radii", 12 * nodes),
        ("normal cones", 4 * nodes),
        ("parents", 4 * (leaves + nodes)),
        ("leaf ranks", 4 * leaves),
        ("triangles of each node", 8 * nodes),
    ];
    for (name, bytes) in expected {
        assert_eq!(table[name], bytes, "{name}");
    }
    assert_eq!(replay.bytes(), table.values().sum::<usize>());
    // Where a node has none, or more than two, rows are counted.
    assert_eq!(Born::new(vec![0, 0, 3], [1, 2, 3].map(CellId).to_vec()).bytes(), 4 * (3 + 3));
    assert_eq!(Born::new(vec![0, 1, 3], [1, 2, 3].map(CellId).to_vec()).bytes(), 8 * 2);
}

#[test]
fn the_boundary_of_a_front_is_the_image_of_that_of_the_input() {
    let mesh = generate::grid(2, 2);
    let mut sequence = Sequence::new(&mesh);
    // The middle goes into a corner's neighbour: nothing of the boundary moves. Then two of the boundary become one.
    let middle = VertexId(4);
    let beside = mesh.cells.iter().find(|cell| cell.contains(&middle)).unwrap().iter().find(|w| **w != middle).copied();
    let kept = beside.expect("a triangle has other corners");
    let made = sequence.push(kept, [middle], [0.1], mesh.positions[kept.index()], true);
    let ends = check::boundary_chain(&Replay::new(&mesh, &[], &sequence).unwrap(), &Front::base(1));
    assert_eq!(ends.len(), 8);
    let around = [0u32, 1, 2, 5, 8, 7, 6, 3].map(VertexId);
    let at = around.iter().position(|v| *v == kept).expect("all but the middle are on the boundary");
    sequence.push(made, [around[(at + 1) % 8]], [0.2], Vec3::ZERO, false);
    let replay = Replay::new(&mesh, &[], &sequence).unwrap();
    let chain = |front: &Front| check::boundary_chain(&replay, front).len();
    assert_eq!((chain(&Front::reference(2)), chain(&Front::base(2))), (8, 7));
}

/// Triangles that hang together anyhow, doubled, about hubs, with vertices that have none; and merges of any vertices, in runs.
fn soup(seed: u64) -> (Mesh<3>, Vec<[VertexId; 2]>, Sequence) {
    let mut random = check::Random::new(seed);
    let count = 3 + random.below(30);
    let wanted = random.below(4 * count);
    let mut place = || Vec3::new(random.below(5) as f32, random.below(5) as f32, random.below(3) as f32);
    let positions: Vec<Vec3> = (0..count).map(|_| place()).collect();
    let mut cells: Vec<[VertexId; 3]> = Vec::new();
    while cells.len() < wanted {
        let first = if random.below(4) == 0 { 0 } else { random.below(count) };
        let cell = [first, random.below(count), random.below(count)].map(VertexId::new);
        if crate::cell::is_proper(&cell) {
            cells.extend(std::iter::repeat_n(cell, 1 + usize::from(random.below(6) == 0)));
        }
    }
    let mesh = Mesh { positions, cells };
    let links: &[[u32; 2]] = if seed % 4 == 1 && count > 4 { &[[0, 4], [0, 4], [1, 2], [1, 3]] } else { &[] };
    let links = links.iter().map(|link| link.map(VertexId)).collect();
    let mut sequence = Sequence::new(&mesh);
    let mut there: Vec<VertexId> = (0..count).map(VertexId::new).collect();
    let mut at = mesh.positions.clone();
    let left = 1 + random.below(count);
    while there.len() > left {
        let center = there.swap_remove(random.below(there.len()));
        let longest = if seed.is_multiple_of(3) { 7 } else { 1 };
        let run = 1 + random.below(longest).min(there.len() - 1);
        let children: Vec<VertexId> = (0..run).map(|_| there.swap_remove(random.below(there.len()))).collect();
        let keeps = random.below(2) == 0;
        let to = if keeps { at[center.index()] } else { Vec3::new(random.below(5) as f32, 1.5, 0.0) };
        let errors: Vec<f32> = children.iter().map(|_| random.below(10) as f32).collect();
        there.push(sequence.push(center, children, errors, to, keeps));
        at.push(to);
    }
    (mesh, links, sequence)
}

#[test]
fn soups_are_the_same_in_portions_of_any_size_and_their_quotients() {
    for seed in 0..600 {
        let (mesh, links, sequence) = soup(seed);
        let whole = Replay::in_portions(&mesh, &links, &sequence, u32::MAX).unwrap().0;
        for size in [2, 3, 5, 9] {
            let cut = Replay::in_portions(&mesh, &links, &sequence, size).unwrap().0;
            assert!(cut == whole, "seed {seed}, portions of {size}");
        }
        let mut view = View { front: Front::reference(whole.len()), mesh: whole.reference_mesh() };
        for m in (0..whole.len()).map(NodeId) {
            whole.coarsen(m, &mut view.mesh, &mut ());
            view.front.set(m, false);
            let cells: Vec<_> = view.mesh.faces.cells().map(|(slot, cell)| (CellId(slot), *cell)).collect();
            assert!(cells == check::quotient(&whole, &view.front), "seed {seed}, node {m}");
        }
        assert_eq!(whole.sewn(), sewn_by_looking(&whole), "seed {seed}");
    }
}

/// The vertices of one side of a strip join one after the other, those of the other side late: a long chain of merges that
/// means nothing to most portions.
#[test]
fn a_spine_is_the_same_in_portions() {
    let count = 600;
    let positions = (0..2 * count).map(|i| Vec3::new((i / 2) as f32, (i % 2) as f32, 0.0)).collect();
    let v = VertexId::new;
    let strip = |i: usize| [[v(2 * i), v(2 * i + 2), v(2 * i + 1)], [v(2 * i + 2), v(2 * i + 3), v(2 * i + 1)]];
    let mesh = Mesh { positions, cells: (0..count - 1).flat_map(strip).collect() };
    let mut sequence = Sequence::new(&mesh);
    let mut spine = v(0);
    for i in 1..count {
        spine = sequence.push(spine, [v(2 * i)], [0.1], mesh.positions[2 * i], false);
    }
    for i in 0..count / 2 {
        sequence.push(v(4 * i + 1), [v(4 * i + 3)], [0.1], mesh.positions[4 * i + 1], false);
    }
    let whole = Replay::in_portions(&mesh, &[], &sequence, u32::MAX).unwrap().0;
    for size in [2, 16, 100] {
        assert!(Replay::in_portions(&mesh, &[], &sequence, size).unwrap().0 == whole, "portions of {size}");
    }
}
