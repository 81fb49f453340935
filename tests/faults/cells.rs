//! Histories that are not what they should be: cells, sides and bounds of an explicit model.

use crate::catalogue::{Caught, fault, hunt};
use mt_core::explicit::Parts;
use mt_core::{Bound, Explicit, VertexId, check, generate};
use mt_tests::model_of;
use multi_tessellation::verify;
use operators::EdgeCollapse;

/// Every law on the model whose parts were changed, and on its ends.
fn judge(model: &Explicit<3>, planted: bool, change: impl FnOnce(&mut Parts<3>)) -> Result<(), Caught> {
    let input = model.reference();
    let mut parts = model.parts().clone();
    if planted {
        change(&mut parts);
    }
    let model = Explicit::from_parts(parts).map_err(Caught::refused)?;
    let options = verify::Options { fronts: 60, seed: 5, ..verify::Options::default() };
    verify::explicit(&model, &options, &mut |_| true)?;
    check::ends(&model, &input)?;
    Ok(())
}

#[test]
fn histories_of_cells() {
    let model = model_of(&generate::bumpy_sphere(2, 0.1, 3), &EdgeCollapse::FULL);
    let planted = |what, change: fn(&mut Parts<3>)| {
        let model = &model;
        fault(what, move |planted| judge(model, planted, change))
    };
    let bound = |what, change: fn(&mut Bound)| {
        let model = &model;
        fault(what, move |planted| judge(model, planted, |parts| change(parts.bounds.last_mut().expect("a node"))))
    };
    hunt(
        "histories of cells",
        &[
            planted("a corner of a made cell is another vertex", |parts| {
                let made = parts.coarse_start[10] as usize;
                let stranger = (0..).map(VertexId).find(|v| !parts.corners[made].contains(v));
                parts.corners[made][0] = stranger.expect("there are more than three");
            }),
            planted("a patch is inside out", |parts| {
                let (from, to) = (parts.coarse_start[10] as usize, parts.coarse_start[11] as usize);
                parts.corners[from..to].iter_mut().for_each(|cell| cell.swap(0, 1));
            }),
            planted("a cell is never killed", |parts| {
                parts.fine.pop();
                *parts.fine_start.last_mut().expect("starts") -= 1;
            }),
            planted("a cell is killed twice", |parts| {
                let first = parts.fine[0];
                parts.fine[9] = first;
            }),
            planted("a node kills what it makes", |parts| {
                let at = parts.fine_start[10] as usize;
                parts.fine[at] = mt_core::CellId(parts.coarse_start[10]);
            }),
            planted("a vertex of the input moved by a bit", |parts| {
                parts.positions[5].y = f32::from_bits(parts.positions[5].y.to_bits() ^ 1);
            }),
            planted("a vertex is not a number", |parts| parts.positions[5].y = f32::NAN),
            planted("an error below is larger than the one above", |parts| parts.bounds[0].error = 1e3),
            bound("a bound's error is too small", |bound| bound.error *= 0.5),
            bound("a bound's sphere is too small", |bound| bound.radius *= 0.5),
            bound("a bound's sphere is elsewhere", |bound| bound.center.x += bound.radius),
        ],
    );
}
