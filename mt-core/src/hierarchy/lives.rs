//! What happens to each triangle of the input while the merges are made: which nodes move a corner of it, one after the
//! other, and which one it dies of.
//!
//! The forest alone says so. A corner waits for the node at which its vertex is merged, then for that of the vertex which
//! comes of it; the earliest node for which a corner waits is next, and one for which two corners wait is the last. So
//! triangles are followed one by one, and no mesh is made. All that a node is bounded by are the triangles around its two
//! vertices just before and after it, and these are the triangles to which it happens.

use super::build::grow;
use super::replay::{Node, Replay};
use crate::bins::rows;
use crate::bound::{Bound, Cone, NormalSum};
use crate::cell::Cell;
use crate::id::{CellId, NodeId, VertexId};
use crate::mesh::area_vector;
use glam::{DVec3, Vec3};

/// The portion that a node belongs to, and its place among the nodes of that.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Home {
    pub(super) portion: u32,
    pub(super) place: u32,
}

/// A portion of the forest, and whatever is around a vertex of it at any time.
pub(super) struct Portion<'a> {
    pub(super) replay: &'a Replay,
    /// Where each node of the forest belongs.
    pub(super) homes: &'a [Home],
    /// The portion of the nodes that lie across cuts.
    pub(super) across: u32,
    pub(super) number: u32,
    /// Its nodes, ascending.
    pub(super) nodes: &'a [u32],
    /// At least all triangles to which any of its nodes happens, ascending.
    pub(super) cells: &'a [u32],
    /// Boundary edges of the input: at least all of those to which any of its nodes happens, each once.
    pub(super) border: &'a [[VertexId; 2]],
}

/// What is found out about a portion. Nodes are those of the portion, one after the other.
pub(super) struct Found {
    /// Bounded; by all that is under them too, except those across the cuts, which are grown when all is together.
    pub(super) nodes: Vec<Node>,
    /// Where the triangles of each node begin, and where those of the last end.
    pub(super) starts: Vec<u32>,
    /// The triangles that appear at each node, ascending.
    pub(super) born: Vec<CellId>,
    /// Of the portion's triangles those that may be around a vertex across the cuts at any time, ascending.
    pub(super) crossed: Vec<u32>,
    /// Whether each node takes just two away of the surface that is closed by a cone over its boundary, with different third
    /// corners, and leaves three or more around its vertex: see [`super::umbrellas::keeps_umbrellas`].
    pub(super) is_plain: bool,
    /// How many edges of the boundary become points.
    pub(super) border_gone: usize,
}

/// The node is not in the portion, nor is any above it; or there is none.
const ELSEWHERE: u32 = u32::MAX;
/// The same, and the node lies across the cuts.
const ACROSS: u32 = ELSEWHERE - 1;
/// The portion lies across the cuts, and the node does not.
const BELOW: u32 = ACROSS - 1;

/// A triangle or an edge on its way to the base mesh: its corners by what has become of them.
struct Life<const N: usize> {
    corners: Cell<N>,
    /// The node at which each corner changes next; none where it never does.
    next: [NodeId; N],
    /// The place of these nodes in the portion.
    places: [u32; N],
}

/// What is next in a life.
struct Event {
    /// The corner that changes; the first of two.
    corner: usize,
    /// The place in the portion of the node that does it.
    place: u32,
    dies: bool,
}

impl<const N: usize> Life<N> {
    /// What is next, if anything in the portion ever is.
    #[inline]
    fn peek(&self) -> Option<Event> {
        if self.places.iter().all(|&place| place >= ACROSS) {
            return None;
        }
        let (mut corner, mut dies) = (0, false);
        for i in 1..N {
            dies = self.next[i] == self.next[corner] || dies && self.next[i] > self.next[corner];
            corner = if self.next[i] < self.next[corner] { i } else { corner };
        }
        Some(Event { corner, place: self.places[corner], dies })
    }
}

/// What a node has heard so far from those to whom it happens.
#[derive(Clone, Copy, Default)]
struct Heard {
    normals: NormalSum,
    has_triangles: bool,
    /// The squared distance of what is furthest from the merged vertex.
    reach: f64,
    /// How many triangles it takes away, and how many it leaves around its vertex, counting those of the cone.
    died: u32,
    around: u32,
    /// The third corner of the last one that died; none for the tip of the cone.
    apex: VertexId,
    /// Whether two that died had one third corner.
    is_doubled: bool,
}

impl Heard {
    /// Hears the normal of a triangle around one of the ends, or the merged vertex.
    #[inline]
    fn hear_normal(&mut self, normal: NormalSum) {
        self.normals.add(normal);
        self.has_triangles = true;
    }

    /// Hears where a corner of such a triangle is.
    #[inline]
    fn hear_place(&mut self, of_vertex: DVec3, place: DVec3) {
        self.reach = self.reach.max(of_vertex.distance_squared(place));
    }

    /// Hears that a triangle with this third corner dies.
    fn hear_death(&mut self, apex: VertexId) {
        self.is_doubled |= self.died > 0 && self.apex == apex;
        self.died += 1;
        self.apex = apex;
    }

    fn is_plain(&self) -> bool {
        self.died == 2 && !self.is_doubled && self.around > 2
    }
}

/// What is written down in the first pass over the lives, so that the second need not live them again: a normal, and the place
/// of the node that made it; of nobody where it was not known before.
type Entry = (u32, Vec3);

/// The normal of a triangle as it is now: of length 1, or 0 without area.
#[derive(Clone, Copy)]
struct Normal {
    unit: Vec3,
    sum: NormalSum,
}

impl Normal {
    #[inline]
    fn of(corners: [DVec3; 3]) -> Self {
        let unit = area_vector(corners).as_vec3().normalize_or_zero();
        Self { unit, sum: NormalSum::of(unit) }
    }
}

/// So many times as much is written down as there are triangles in a portion; of most meshes it is six. Where lives are longer,
/// as around hubs, they are lived again instead.
const ENTRIES: usize = 32;

/// What the lives around a portion say about its nodes. O(lives).
pub(super) fn listen(portion: &Portion) -> Found {
    let replay = portion.replay;
    let mut heard = vec![Heard::default(); portion.nodes.len()];
    let mut log: Vec<Entry> = Vec::with_capacity(8 * portion.cells.len());
    let mut is_whole = true;
    let mut deaths: Vec<(u32, CellId)> = Vec::with_capacity(portion.cells.len());
    let mut crossed = Vec::new();
    for &cell in portion.cells {
        if log.len() > ENTRIES * portion.cells.len() {
            log.clear();
            is_whole = false;
        }
        let (died, crosses) = portion.live(replay.cells[cell as usize], &mut heard, &mut log);
        deaths.extend(died.map(|place| (place, CellId(cell))));
        crossed.extend(crosses.then_some(cell));
    }
    let border_gone = portion.border.iter().filter(|edge| portion.live_on_border(**edge, &mut heard)).count();
    let mut spread = Spread::new(&heard);
    if is_whole {
        spread.see(&log);
    } else {
        let mut again = heard.clone();
        for &cell in portion.cells {
            log.clear();
            portion.live(replay.cells[cell as usize], &mut again, &mut log);
            spread.see(&log);
        }
    }
    let cones = spread.cones(&heard);
    let by_place = deaths.iter().map(|&(place, cell)| (place as usize, cell));
    let (starts, born) = rows(portion.nodes.len(), CellId::NONE, by_place);
    let is_plain = heard.iter().all(Heard::is_plain);
    Found { nodes: portion.bound(&heard, &cones), starts, born, crossed, is_plain, border_gone }
}

impl Portion<'_> {
    fn life<const N: usize>(&self, corners: Cell<N>) -> Life<N> {
        let next = corners.map(|v| self.replay.merged_at(v));
        Life { corners, next, places: next.map(|node| self.place(node)) }
    }

    #[inline]
    fn place(&self, node: NodeId) -> u32 {
        match self.homes.get(node.index()) {
            None => ELSEWHERE,
            Some(home) if home.portion == self.number => home.place,
            Some(home) if home.portion == self.across => ACROSS,
            Some(_) if self.number == self.across => BELOW,
            Some(_) => ELSEWHERE,
        }
    }

    /// Lets a node happen to a corner.
    #[inline]
    fn pass<const N: usize>(&self, life: &mut Life<N>, corner: usize) {
        let node = life.next[corner];
        life.corners[corner] = self.replay.vertex(node);
        life.next[corner] = self.replay.parent(node).unwrap_or(NodeId::NONE);
        life.places[corner] = self.place(life.next[corner]);
    }

    #[inline]
    fn at(&self, v: VertexId) -> DVec3 {
        self.replay.positions[v.index()].as_dvec3()
    }

    /// Lives the life of a triangle, as far as the portion goes, and tells its nodes. Told back are the place of the node that
    /// it dies of, if that is here, and whether any that lies across the cuts may happen to it.
    fn live(&self, corners: Cell<3>, heard: &mut [Heard], log: &mut Vec<Entry>) -> (Option<u32>, bool) {
        let mut life = self.life(corners);
        let mut crosses = false;
        // As it is now, if anybody has asked.
        let mut known: Option<Normal> = None;
        while let Some(Event { corner, place, dies }) = life.peek() {
            let Some(heard) = heard.get_mut(place as usize) else {
                crosses |= place == ACROSS;
                if dies {
                    return (None, crosses);
                }
                self.pass(&mut life, corner);
                known = None;
                continue;
            };
            let before = known.unwrap_or_else(|| {
                let now = Normal::of(life.corners.map(|v| self.at(v)));
                log.push((ELSEWHERE, now.unit));
                now
            });
            heard.hear_normal(before.sum);
            if dies {
                let node = life.next[corner];
                let apex = (0..3).find(|&i| life.next[i] != node).expect("two of three corners meet");
                heard.hear_place(self.at(self.replay.vertex(node)), self.at(life.corners[apex]));
                heard.hear_death(life.corners[apex]);
                log.push((place, before.unit));
                return (Some(place), crosses);
            }
            self.pass(&mut life, corner);
            let points = life.corners.map(|v| self.at(v));
            let after = Normal::of(points);
            heard.hear_normal(after.sum);
            heard.around += 1;
            // One of them is the centre, whichever: no branch.
            let center = self.at(life.corners[corner]);
            points.into_iter().for_each(|point| heard.hear_place(center, point));
            log.push((place, after.unit));
            known = Some(after);
        }
        (None, crosses || life.places.contains(&ACROSS))
    }

    /// Lives the life of the triangle between an edge of the boundary and the tip of the cone; whether it ends here.
    fn live_on_border(&self, corners: [VertexId; 2], heard: &mut [Heard]) -> bool {
        let mut life = self.life(corners);
        while let Some(Event { corner, place, dies }) = life.peek() {
            let heard = heard.get_mut(place as usize);
            if dies {
                heard.into_iter().for_each(|heard| heard.hear_death(VertexId::NONE));
                return place < BELOW;
            }
            heard.into_iter().for_each(|heard| heard.around += 1);
            self.pass(&mut life, corner);
        }
        false
    }

    /// The nodes with their bounds, grown until they hold those under them, but across the cuts.
    fn bound(&self, heard: &[Heard], cones: &[Cone]) -> Vec<Node> {
        let replay = self.replay;
        let mut nodes: Vec<Node> = Vec::with_capacity(self.nodes.len());
        for ((&m, heard), &cone) in self.nodes.iter().zip(heard).zip(cones) {
            let m = NodeId(m);
            let made = replay.vertex(m);
            let reach = replay.ends(m).map(|end| self.at(end).distance_squared(self.at(made)));
            let reach = reach.into_iter().fold(heard.reach, f64::max);
            let radius = ((reach.sqrt() * (1.0 + 1e-14)) as f32).next_up();
            let mut node = Node { radius, cone, ..*replay.node(m) };
            if self.number != self.across {
                grow(&mut node, replay, m, |child| {
                    let Node { error, radius, cone, .. } = nodes[self.place(child) as usize];
                    Bound { center: replay.positions[replay.vertex(child).index()], radius, error, cone }
                });
            }
            nodes.push(node);
        }
        nodes
    }
}

/// How far the normals that nodes hear of are from the axis of all of them.
struct Spread {
    /// Of each node the axis, and the least that a normal has along it.
    all: Vec<(Option<Vec3>, f32)>,
}

impl Spread {
    fn new(heard: &[Heard]) -> Self {
        Self { all: heard.iter().map(|heard| (heard.normals.axis(), 1.0)).collect() }
    }

    /// Looks at whole lives.
    fn see(&mut self, lives: &[Entry]) {
        let mut before = Vec3::ZERO;
        for &(place, normal) in lives {
            if let Some((Some(axis), least)) = self.all.get_mut(place as usize) {
                for along in [before.dot(*axis), normal.dot(*axis)] {
                    *least = if along < *least { along } else { *least };
                }
            }
            before = normal;
        }
    }

    fn cones(self, heard: &[Heard]) -> Vec<Cone> {
        let cone = |(heard, (axis, least)): (&Heard, (Option<Vec3>, f32))| match axis {
            Some(axis) => Cone::about(axis, least),
            None if heard.has_triangles => Cone::ALL,
            None => Cone::EMPTY,
        };
        heard.iter().zip(self.all).map(cone).collect()
    }
}
