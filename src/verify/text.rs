//! Findings as text: meshes as OBJ and as Rust, stories as a log, and tests to paste.

use super::Options;
use super::counterexample::{Case, Counterexample, Found};
use mt_core::cell::facets;
use mt_core::check::Law;
use mt_core::hierarchy::Story;
use mt_core::{Front, Mesh, Sequence, history};
use std::fmt::{Display, Write};

/// Numbers, a space between.
pub(super) fn join<T: Display>(numbers: impl IntoIterator<Item = T>) -> String {
    numbers.into_iter().map(|n| n.to_string()).collect::<Vec<_>>().join(" ")
}

/// A mesh as OBJ; of tetrahedra all their faces.
pub(super) fn obj<const N: usize>(mesh: &Mesh<N>) -> String {
    let mut text = String::new();
    for p in &mesh.positions {
        _ = writeln!(text, "v {} {} {}", p.x, p.y, p.z);
    }
    for cell in &mesh.cells {
        if N == 3 {
            _ = writeln!(text, "f {}", join(cell.iter().map(|v| v.0 + 1)));
        } else {
            let sides = facets(cell);
            sides.into_iter().for_each(|(facet, _)| {
                _ = writeln!(text, "f {}", join(facet.vertices().iter().map(|v| v.0 + 1)));
            });
        }
    }
    text
}

/// A mesh as an expression of Rust.
fn rust_mesh<const N: usize>(mesh: &Mesh<N>) -> String {
    let mut text = String::from("Mesh::from_indices(\n        [");
    for (i, p) in mesh.positions.iter().enumerate() {
        let gap = if i % 4 == 0 { "\n            " } else { " " };
        _ = write!(text, "{gap}[{:?}, {:?}, {:?}],", p.x, p.y, p.z);
    }
    text += "\n        ]\n        .map(Into::into)\n        .to_vec(),\n        &[";
    for (i, cell) in mesh.cells.iter().enumerate() {
        let gap = if i % 8 == 0 { "\n            " } else { " " };
        _ = write!(text, "{gap}[{}],", cell.map(|v| v.0.to_string()).join(", "));
    }
    text + "\n        ],\n    )"
}

/// Merges as statements of Rust.
fn rust_merges(sequence: &Sequence) -> String {
    let mut text = String::from("    let mut sequence = Sequence::new(&mesh);\n");
    for f in 0..sequence.merge_count() {
        let nodes = sequence.starts[f as usize] as usize..sequence.starts[f as usize + 1] as usize;
        let joined: Vec<String> = sequence.children[nodes.clone()].iter().map(|v| format!("VertexId({v})")).collect();
        let [x, y, z] = sequence.positions[f as usize].to_array();
        let kept = f < sequence.kept.capacity() && sequence.kept.contains(f);
        _ = writeln!(
            text,
            "    sequence.push(VertexId({}), [{}], {:?}, [{x:?}, {y:?}, {z:?}].into(), {kept});",
            sequence.centers[f as usize],
            joined.join(", "),
            &sequence.errors[nodes],
        );
    }
    text
}

fn test_name(subject: &str, law: Law) -> String {
    let plain = |c: char| if c.is_ascii_alphanumeric() { c.to_ascii_lowercase() } else { '_' };
    format!("{}_keeps_{}", subject, law).chars().map(plain).collect()
}

fn rust_options(options: &Options) -> String {
    format!(
        "verify::Options {{ fronts: {}, seed: {}, topology: verify::Topology::{:?} }}",
        options.fronts, options.seed, options.topology
    )
}

/// A test that judges an operator on a mesh.
pub(super) fn operator_test<const N: usize>(
    type_name: &str,
    subject: &str,
    law: Law,
    mesh: &Mesh<N>,
    options: &Options,
) -> String {
    format!(
        "#[test]\nfn {}() {{\n    use multi_tessellation::{{mt_core::Mesh, verify}};\n    let mesh: Mesh<{N}> = {};\n    \
         // The operator as it was given.\n    let operator = {type_name};\n    \
         verify::operator_on(&mesh, &operator, &{}).unwrap();\n}}\n",
        test_name(subject, law),
        rust_mesh(mesh),
        rust_options(options)
    )
}

/// A test that adapts what is left of a model from the front at which a criterion or a strategy went wrong.
pub(super) fn rule_test<const N: usize>(subject: &str, found: &Counterexample<N>, options: &Options) -> String {
    let refined = join(found.front.finest_first().map(|m| m.0));
    let tried = format!(
        "// {}\n    use multi_tessellation::mt_core::{{Front, MultiTessellation, NodeId}};\n    \
         use multi_tessellation::selective::{{Limits, State, adapt, approach, wish_closure}};\n    \
         let mut state = State::new(&model, ());\n    \
         let refined: [u32; {}] = [{refined}];\n    \
         approach(&model, &Front::from_nodes(model.len(), refined.into_iter().map(NodeId)), &mut state);\n    \
         // The criterion as it was given; a strategy goes in the place of `adapt`.\n    \
         let criterion = make(&model);\n    \
         adapt(&model, &criterion, &Limits::NONE, &mut state);\n    \
         assert!(*state.front() == wish_closure(&model, &criterion));\n",
        found.breach.to_string().replace('\n', " "),
        found.front.len(),
    );
    let judged = |line: &str| line.contains("verify::explicit(&model");
    case_test(subject, found, "", options)
        .lines()
        .map(|line| if judged(line) { format!("    {tried}") } else { line.replace(", verify}", "}") + "\n" })
        .collect()
}

/// A test that judges a model made of a mesh.
pub(super) fn model_test<const N: usize>(subject: &str, law: Law, mesh: &Mesh<N>, options: &Options) -> String {
    format!(
        "#[test]\nfn {}() {{\n    use multi_tessellation::{{mt_core::Mesh, verify}};\n    let mesh: Mesh<{N}> = {};\n    \
         // The model as it was made.\n    let model = make(&mesh).unwrap();\n    \
         multi_tessellation::mt_core::check::ends(&model, &mesh).unwrap();\n    \
         verify::model(&model, &{}, &mut |_| true).unwrap();\n}}\n",
        test_name(subject, law),
        rust_mesh(mesh),
        rust_options(options)
    )
}

/// A test that judges what is left of a model; of merges `judged` judges `replay`, with `OPTIONS`.
pub(super) fn case_test<const N: usize>(
    subject: &str,
    found: &Counterexample<N>,
    judged: &str,
    options: &Options,
) -> String {
    let name = test_name(subject, found.breach.law);
    let options = rust_options(options);
    match &found.case {
        Case::Cells(model) => {
            let mut text = Vec::new();
            history::write(model, &mut text).expect("memory takes it");
            let text = String::from_utf8(text).expect("JSON is text");
            format!(
                "#[test]\nfn {name}() {{\n    use multi_tessellation::{{mt_core::{{Mesh, history}}, verify}};\n    \
                 let mesh: Mesh<{N}> = {};\n    let told = r#\"{text}\"#;\n    \
                 let model = history::read(&mesh, told.as_bytes()).unwrap();\n    \
                 verify::explicit(&model, &{options}, &mut |_| true).unwrap();\n}}\n",
                rust_mesh(&model.reference())
            )
        }
        Case::Merges(story) => format!(
            "#[test]\nfn {name}() {{\n    \
             use multi_tessellation::{{mt_core::{{Mesh, Replay, Sequence, VertexId}}, operators, verify}};\n    \
             use std::sync::Arc;\n    let mesh: Mesh<3> = {};\n{}    \
             let replay = Arc::new(Replay::new(&mesh, &{}, &sequence).unwrap());\n    {}\n}}\n",
            rust_mesh(&story.mesh),
            rust_merges(&story.sequence),
            rust_links(story),
            judged.replace("OPTIONS", &options),
        ),
        Case::Whole => {
            format!("// No part of the model breaks the law, so the test is the one that told this: {name}.\n")
        }
    }
}

fn rust_links(story: &Story) -> String {
    let links: Vec<String> = story.links.iter().map(|[a, b]| format!("[VertexId({a}), VertexId({b})]")).collect();
    format!("[{}]", links.join(", "))
}

/// How large a case was and is.
pub(super) fn sizes<const N: usize>(found: &Counterexample<N>) -> String {
    let Found { nodes, cells, front, .. } = found.found;
    let now = (found.case.node_count().unwrap_or(nodes), found.case.cell_count().unwrap_or(cells));
    format!(
        "{nodes} modifications to {}, {cells} cells to {}, a front of {front} to {}",
        now.0,
        now.1,
        found.front.len()
    )
}

/// A counterexample as text: what is wrong, the input, its history and the front.
pub(super) fn story<const N: usize>(found: &Counterexample<N>) -> String {
    let mut text = format!("{}\n{}\n", found.breach, sizes(found));
    if found.found.breach != found.breach {
        _ = writeln!(text, "as it was found: {}", found.found.breach);
    }
    match &found.case {
        Case::Cells(model) => {
            let mut lines = Vec::new();
            history::write(model, &mut lines).expect("memory takes it");
            text += "\nthe input:\n";
            text += &obj(&model.reference());
            text += "\nits history, one coarsening modification a line; node 0 is the first:\n";
            text += &String::from_utf8_lossy(&lines);
        }
        Case::Merges(story) => {
            text += "\nthe input:\n";
            text += &obj(&story.mesh);
            text += "\nits merges:\n";
            text += &rust_merges(&story.sequence);
        }
        Case::Whole => text += "\nno part of the model breaks the law; the front is one of the whole\n",
    }
    text += &front(&found.front);
    if let Some((m, patch)) = &found.patch {
        _ = writeln!(text, "\nnode {m} replaces, when refined:");
        patch.coarse.iter().for_each(|cell| _ = writeln!(text, "  - {}", join(cell.iter().map(|v| v.0))));
        patch.fine.iter().for_each(|cell| _ = writeln!(text, "  + {}", join(cell.iter().map(|v| v.0))));
    }
    text
}

fn front(front: &Front) -> String {
    format!("\nfront, finest first: {}\n", join(front.finest_first().map(|m| m.0)))
}
