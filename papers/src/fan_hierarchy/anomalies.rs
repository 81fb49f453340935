//! What we noticed in the paper: its tables against each other and against its text, and its formulas.

use super::{ROLES, ends, exponent, fans, range};
use crate::ledger::{Claim, Entry, LedgerError, Published, PublishedTable, Workshop};
use glam::Vec3;
use mt_core::analysis::{Draft, Operator, Unfit};
use mt_core::{Bound, Cone, NodeId, Plan, Refusal};
use operators::{AnyOperator, FanMerge};
use selective::{Criterion, Reading, VisualError};

pub(super) fn run(workshop: &mut Workshop<'_>, published: &Published, entry: &mut Entry) -> Result<(), LedgerError> {
    let [built, sizes, adapted] = ["table-1", "table-2", "table-3"].map(|id| published.table(id));
    let (built, sizes, adapted) = (built?, sizes?, adapted?);
    order(workshop, entry)?;
    tables_against_each_other(entry, built, sizes)?;
    ratios(entry, published.table("anomalies")?, sizes, adapted)?;
    equation(entry);
    for id in ["figure-8", "figure-9"] {
        let models = published.table(id)?;
        let (figure, tables) = (models.number("figure", "triangles, K")?, models.number("tables", "triangles, K")?);
        entry.claims.push(Claim::check(
            &format!("{id} is of another model than the tables"),
            tables > 2.0 * figure,
            format!("{figure}K triangles, and {tables}K in the tables: the picture says nothing of the row"),
            "",
        ));
    }
    Ok(())
}

/// Fans in the opposite order: the largest error first.
#[derive(Debug)]
struct Decreasing(FanMerge);

impl Operator<3> for Decreasing {
    type Site = <FanMerge as Operator<3>>::Site;
    type Aux = <FanMerge as Operator<3>>::Aux;

    fn name(&self) -> &'static str {
        "fan-merge-decreasing"
    }

    fn prepare(&self, draft: &Draft<3>, sites: &mut Vec<Self::Site>) -> Result<Self::Aux, Unfit> {
        self.0.prepare(draft, sites)
    }

    fn price(&self, draft: &Draft<3>, aux: &Self::Aux, site: Self::Site) -> Option<f64> {
        self.0.price(draft, aux, site).map(|price| 1.0 / (price + 1e-30))
    }

    fn plan(&self, draft: &Draft<3>, aux: &Self::Aux, site: Self::Site, plan: &mut Plan<3>) -> Result<(), Refusal> {
        self.0.plan(draft, aux, site, plan)
    }

    fn alternative(&self, site: Self::Site, refusal: Refusal) -> Option<Self::Site> {
        self.0.alternative(site, refusal)
    }

    fn applied(&self, draft: &Draft<3>, aux: &mut Self::Aux, plan: &Plan<3>, again: &mut Vec<Self::Site>) {
        self.0.applied(draft, aux, plan, again);
    }
}

fn order(workshop: &mut Workshop<'_>, entry: &mut Entry) -> Result<(), LedgerError> {
    let subject = workshop.subject(&ROLES[1])?;
    entry.models.push(subject.told());
    let decreasing = AnyOperator::yours(Decreasing(FanMerge::PARTIAL));
    let [right, wrong] = [fans(), decreasing].map(|operator| {
        let replay = workshop.sequence(&subject, &operator)?.replay;
        // The mean error of the merges that lead to half the vertices.
        let half = (replay.leaf_count() / 2).min(replay.len()).max(1);
        let sum: f64 = (0..half).map(|m| f64::from(replay.node(NodeId(m)).error)).sum();
        Ok::<f64, LedgerError>(sum / f64::from(half) / subject.mesh.diagonal())
    });
    let (right, wrong) = (right?, wrong?);
    entry.claims.push(Claim::check(
        "Section 3.2 merges \"in a decreasing order of the introduced errors\"; it has to be increasing",
        wrong > 2.0 * right,
        format!("down to half the vertices the mean error of a merge is {right:.1e} of the diagonal in increasing order, and {wrong:.1e} in decreasing"),
        "",
    ));
    Ok(())
}

fn tables_against_each_other(
    entry: &mut Entry,
    built: &PublishedTable,
    sizes: &PublishedTable,
) -> Result<(), LedgerError> {
    let (vertices, triangles) = (built.column("vertices, K")?, built.column("triangles, K")?);
    let nodes = sizes.column("VDT internal nodes, K")?;
    let too_many: Vec<String> = (0..nodes.len())
        .filter(|&i| nodes[i] > vertices[i])
        .map(|i| {
            format!(
                "{} {}K nodes and {}K vertices, half its triangles are {}K",
                built.rows[i][0],
                nodes[i],
                vertices[i],
                triangles[i] / 2.0
            )
        })
        .collect();
    entry.claims.push(Claim::check(
        "Table 2 has more internal nodes of the tree of two models than Table 1 has vertices, which no binary tree has",
        too_many.len() == 2,
        format!("{}: the half is where the numbers seem to come from", too_many.join("; ")),
        "",
    ));
    let terrain = built.rows[0][3].to_string();
    entry.claims.push(Claim::check(
        "Table 1 is headed seconds and holds minutes and seconds",
        terrain.contains(':'),
        format!("{} took {terrain}", built.rows[0][0]),
        "",
    ));
    let times: Vec<(f64, f64)> = vertices.iter().copied().zip(built.column("FH, min:s")?).collect();
    let each: Vec<f64> = times.iter().map(|(vertices, seconds)| seconds / vertices).collect();
    let exponent = exponent(&times);
    entry.claims.push(Claim::check(
        "\"Nearly linear\" is not what Table 1 has",
        (exponent - 1.0).abs() > 0.15,
        format!(
            "{} ms a vertex; the time grows as the number of vertices to the power of {exponent:.2}",
            range(&each, 2)
        ),
        "",
    ));
    let (factors, quotients) = (sizes.column("saving factor")?, sizes.quotients("VDT size, KB", "FH size, KB")?);
    let wrong: Vec<String> = (0..factors.len())
        .filter(|&i| (factors[i] - quotients[i]).abs() > 0.02)
        .map(|i| format!("{}: {} printed, {:.2} by its sizes", sizes.rows[i][0], factors[i], quotients[i]))
        .collect();
    entry.claims.push(Claim::check(
        "A saving factor is not the quotient of its sizes",
        wrong.len() == 1,
        wrong.join("; "),
        "",
    ));
    let internal = sizes.column("FH internal nodes, K")?;
    let children: Vec<f64> = vertices.iter().zip(&internal).map(|(vertices, nodes)| vertices / nodes).collect();
    let mean = children.iter().sum::<f64>() / children.len() as f64;
    entry.claims.push(Claim::check(
        "The depth of log6 n goes with six children a node, and the tables have another number",
        (mean - 6.0).abs() > 0.5,
        format!(
            "vertices by internal nodes are {}, {mean:.2} on the average, without the centre; with it one more",
            range(&children, 2)
        ),
        "without the centre the mean is six, as the paper has it; it is ours that are smaller",
    ));
    Ok(())
}

fn ratios(
    entry: &mut Entry,
    text: &PublishedTable,
    sizes: &PublishedTable,
    adapted: &PublishedTable,
) -> Result<(), LedgerError> {
    let [fans, edges, rival] = ["FH fan steps", "FH edge steps", "VDT steps"].map(|heading| adapted.column(heading));
    let (fans, edges, rival) = (fans?, edges?, rival?);
    let by = |weight: f64| -> Vec<f64> { (0..rival.len()).map(|i| rival[i] / (weight * fans[i] + edges[i])).collect() };
    for (what, values) in [
        ("internal nodes", sizes.quotients("VDT internal nodes, K", "FH internal nodes, K")?),
        ("adapt operations", by(1.0)),
        ("adaptation time", adapted.quotients("VDT adapt, ms", "FH adapt, ms")?),
        ("frame rates", adapted.quotients("FH frames a s", "VDT frames a s")?),
    ] {
        let said = (text.number(what, "least")?, text.number(what, "most")?);
        let (least, most) = ends(&values);
        entry.claims.push(Claim::check(
            &format!("The text's ratio of {what} is not its table's"),
            most > said.1 + 0.04 || least > said.0 + 0.5,
            format!("{} to {} times in the text, {} by the table", said.0, said.1, range(&values, 1)),
            "",
        ));
    }
    let honest = by(5.0);
    entry.claims.push(Claim::check(
        "Much of the gain in operations is that a fan counts as one",
        ends(&honest).1 < 1.5,
        format!("a fan as five edges, the printed table gives {} times fewer", range(&honest, 2)),
        "",
    ));
    Ok(())
}

/// Equation 3, at either side of its branch and at two distances.
fn equation(entry: &mut Entry) {
    let epsilon = 0.2;
    let visual =
        |reading| VisualError { eye: Vec3::ZERO, light: Vec3::X, epsilon, scale: 1.0, error_min: 0.0, reading };
    // A small flat patch whose normal has this cosine with the view and looks at the light as much as it can.
    let at = |cosine: f32, distance: f32| {
        let normal = Vec3::new((1.0 - cosine * cosine).sqrt(), 0.0, -cosine);
        Bound { center: Vec3::Z * distance, radius: 1e-4, error: 1.0, cone: Cone::of_normals(&[normal]) }
    };
    let weight = |bound| f64::from(visual(Reading::Error).excess(&bound, false)) + 1.0;
    let jump = weight(at(epsilon - 0.03, 10.0)) / weight(at(epsilon + 0.03, 10.0));
    entry.claims.push(Claim::check(
        "Equation 3 is discontinuous at the silhouette",
        jump > 2.0,
        format!("its value jumps by a factor of {jump:.1} where |N.D| passes epsilon = {epsilon}"),
        "",
    ));
    let growth = weight(at(0.6, 20.0)) / weight(at(0.6, 10.0));
    entry.claims.push(Claim::check(
        "Equation 3 grows with distance, though it is called an error that should fall with it",
        growth > 1.5,
        format!("twice as far away it is {growth:.2} times as large; read as a tolerance that is right, but then silhouettes get coarser. Both readings are there (`selective::VisualError`)"),
        "",
    ));
}
