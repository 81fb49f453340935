//! Histories as text: a round trip gives the same model, and what cannot be is refused with its line.

use mt_core::{Explicit, Mesh, generate, history};
use mt_tests::model_of;
use operators::EdgeCollapse;
use proptest::prelude::*;

fn text_of(model: &Explicit<3>) -> String {
    let mut text = Vec::new();
    history::write(model, &mut text).expect("writing to memory cannot fail");
    String::from_utf8(text).expect("JSON is UTF-8")
}

fn read(mesh: &Mesh<3>, text: &str) -> Result<Explicit<3>, String> {
    history::read(mesh, text.as_bytes()).map_err(|error| error.to_string())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, ..ProptestConfig::default() })]

    #[test]
    fn a_round_trip_gives_the_same_model(seed in any::<u64>(), half in any::<bool>()) {
        let mesh = generate::random_mesh(seed).mesh;
        let model = model_of(&mesh, if half { &EdgeCollapse::HALF } else { &EdgeCollapse::FULL });
        prop_assert_eq!(read(&mesh, &text_of(&model)).unwrap(), model);
    }

    #[test]
    fn damaged_text_never_panics(at in any::<prop::sample::Index>(), byte in any::<u8>()) {
        let mesh = generate::sphere(1);
        let mut text = text_of(&model_of(&mesh, &EdgeCollapse::FULL)).into_bytes();
        let at = at.index(text.len());
        text[at] = byte;
        _ = history::read(&mesh, text.as_slice());
    }
}

#[test]
fn what_cannot_be_is_refused_with_its_line() {
    let square = Mesh::from_indices(
        vec![
            glam::Vec3::ZERO,
            glam::Vec3::X,
            glam::Vec3::X + glam::Vec3::Y,
            glam::Vec3::Y,
            glam::Vec3::new(0.5, 0.5, 0.0),
        ],
        &[[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]],
    );
    let head = r#"{"history":1,"corners":3,"vertices":5,"cells":4,"error_kind":"measured"}"#;
    let good = r#"{"kill":[0,1,2,3],"make":[[4,0,1,2],[5,0,2,3]],"error":0.1}"#;
    assert!(read(&square, &format!("{head}\n\n{good}\n")).is_ok());
    let cases = [
        (String::new(), "line 1: the history is empty"),
        ("{}".into(), "line 1: the first line must say"),
        (head.replace("\"history\":1", "\"history\":2"), "version 2"),
        (head.replace("\"cells\":4", "\"cells\":9"), "a history of a mesh with 5 vertices and 9 cells"),
        (format!("{head}\nnonsense"), "line 2: "),
        (format!("{head}\n{good}\n{good}"), "line 3: cell 0 is not alive"),
        (format!("{head}\n{}", good.replace("[0,1,2,3]", "[0,0]")), "line 2: cell 0 is not alive"),
        (format!("{head}\n{}", good.replace("[0,1,2,3]", "[]")), "line 2: a modification must kill"),
        (format!("{head}\n{}", good.replace("[0,1,2,3]", "[4]")), "line 2: cell 4 is not alive"),
        (format!("{head}\n{}", good.replace("[4,0,1,2]", "[7,0,1,2]")), "line 2: cell 7 is made, but the next id is 4"),
        (format!("{head}\n{}", good.replace("[4,0,1,2]", "[4,0,1]")), "line 2: cell 4 has 2 corners, not 3"),
        (format!("{head}\n{}", good.replace("[4,0,1,2]", "[4,0,1,9]")), "line 2: a cell's corners"),
        (format!("{head}\n{}", good.replace("0.1", "-1")), "line 2: an error"),
        (format!("{head}\n{}", good.replace("0.1", "1e99")), "line 2: "),
    ];
    for (text, wanted) in cases {
        let error = read(&square, &text).expect_err(&text);
        assert!(error.contains(wanted), "{error:?} does not say {wanted:?}");
    }
}
