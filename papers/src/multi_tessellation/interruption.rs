//! The curve of interruption: the largest error that is left against modifications made, by priority and depth first.

use super::FIELD;
use crate::ledger::{Claim, Entry, Figure, LedgerError, Published, Workshop, edge_collapse};
use crate::plot::{Axis, Lines, Series};
use crate::table::Table;
use mt_core::{Explicit, MultiTessellation, NodeId, Step};
use selective::{Limits, Strategy, UniformError, extract};

/// Shares of the modifications after which one looks, in per cent.
const AT: [f64; 11] = [0.0, 1.0, 2.0, 5.0, 10.0, 20.0, 30.0, 50.0, 70.0, 90.0, 99.0];

/// The largest error of a modification that is not made after each number of steps.
fn left(model: &Explicit<3>, steps: &[Step]) -> Vec<f32> {
    let mut left = vec![0.0f32; steps.len() + 1];
    for (i, step) in steps.iter().enumerate().rev() {
        left[i] = left[i + 1].max(model.bound(step.node).error);
    }
    left
}

pub(super) fn interruption(workshop: &mut Workshop<'_>, _: &Published, entry: &mut Entry) -> Result<(), LedgerError> {
    let subject = workshop.subject(&FIELD)?;
    entry.models.push(subject.told());
    let model = workshop.explicit(&subject, &edge_collapse())?;
    let everything = UniformError { error_max: -1.0 };
    let [priority, depth_first] = [Strategy::Priority, Strategy::TopDown].map(|strategy| {
        let (state, _) = extract(&*model, &everything, &Limits::NONE, strategy, ());
        left(&model, &state.steps)
    });
    let all = (0..model.len()).map(|m| model.bound(NodeId(m)).error).fold(0.0, f32::max);
    let percent = |error: f32| 100.0 * f64::from(error) / f64::from(all.max(f32::MIN_POSITIVE));
    let at = |curve: &[f32], share: f64| percent(curve[(share * 0.01 * (curve.len() - 1) as f64) as usize]);
    let mut table = Table::new(
        "Measured: the largest error left, as a share of that of the base mesh.",
        "#modifications made, % | #by priority, % | #depth first, %",
    );
    for share in AT {
        table.row([
            format!("{share}"),
            format!("{:.4}", at(&priority, share)),
            format!("{:.4}", at(&depth_first, share)),
        ]);
    }
    entry.measured.push(table);
    entry.claims.push(Claim::check(
        "by priority, intermediate steps are approximations of the result",
        at(&priority, 10.0) < 0.5 * at(&depth_first, 10.0),
        format!(
            "after a tenth of the modifications {:.2} % of the error is left by priority, {:.2} % depth first",
            at(&priority, 10.0),
            at(&depth_first, 10.0)
        ),
        "on a model this small depth first comes by the large errors as early",
    ));
    let series = |name: &str, curve: &[f32]| {
        let points = (0..=100).map(|share| [f64::from(share), at(curve, f64::from(share)).max(1e-4)]);
        Series { name: name.into(), points: points.collect() }
    };
    let plot = Lines {
        title: "Interruption".into(),
        x: Axis::linear("modifications made, %"),
        y: Axis::logarithmic("largest error left, % of that of the base mesh"),
        series: vec![series("by priority", &priority), series("depth first", &depth_first)],
    };
    entry.figures.push(Figure {
        name: "multi-tessellation-interruption.svg".into(),
        caption: "What is left when the work is interrupted, by priority and depth first".into(),
        bytes: plot.svg().into_bytes(),
    });
    Ok(())
}
