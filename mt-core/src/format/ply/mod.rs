//! Reads PLY: text and both binary byte orders, any properties, `face` lists and `tristrips`.

mod body;
mod header;

use super::error::{Place, Problem, Refusal};
use super::soup::{Soup, index_of};
use super::words::{Words, check_count};
use body::{Binary, Source, Text};
use glam::Vec3;
use header::{Element, Encoding, Header, Kind};

pub(super) fn read(bytes: &[u8]) -> Result<Soup, Refusal> {
    let header = header::parse(bytes)?;
    let mut soup = Soup::default();
    let left = match header.encoding {
        Encoding::Text => {
            let mut source = Text { words: Words::new(bytes, header.body) };
            read_elements(&header, &mut source, &mut soup)?;
            source.words.skip_comments();
            source.words.remaining()
        }
        Encoding::Binary { big } => {
            let mut source = Binary { bytes, at: header.body, big };
            read_elements(&header, &mut source, &mut soup)?;
            source.remaining()
        }
    };
    if left > 0 {
        soup.notes.push(format!("{left} bytes after the last element ignored"));
    }
    Ok(soup)
}

fn read_elements(header: &Header, source: &mut impl Source, soup: &mut Soup) -> Result<(), Refusal> {
    // Faces may come before vertices, so their indices are checked when everything is read.
    let vertex_count = header.elements.iter().find(|e| e.name == "vertex").map_or(0, |e| e.count);
    for element in &header.elements {
        let count = check_count(
            source.place(),
            &format!("{} elements", element.name),
            element.count,
            source.least_size(element),
            source.remaining(),
        )?;
        match element.name.as_str() {
            "vertex" => read_vertices(element, count, source, soup)?,
            "face" => read_faces(element, count, source, soup, vertex_count as usize)?,
            "tristrips" => read_strips(element, count, source, soup, vertex_count as usize)?,
            // Elements without properties take no room, however many there are said to be.
            _ if element.properties.is_empty() => {}
            name => {
                (0..count).try_for_each(|_| source.row(element, &mut |_, _| (), &mut Vec::new(), None))?;
                soup.left.other_elements += count;
                soup.notes.push(format!("{count} elements {name:?} ignored"));
            }
        }
    }
    Ok(())
}

fn read_vertices(element: &Element, count: usize, source: &mut impl Source, soup: &mut Soup) -> Result<(), Refusal> {
    let mut axes = [0; 3];
    for (axis, name) in axes.iter_mut().zip(["x", "y", "z"]) {
        let found = element.properties.iter().position(|p| p.name == name && matches!(p.kind, Kind::Scalar(_)));
        *axis = found.ok_or_else(|| Refusal::malformed(Place::File, format!("vertices have no number {name:?}")))?;
    }
    soup.positions.reserve_exact(count);
    if let Some(positions) = source.packed_positions(element, axes, count) {
        soup.positions.extend(positions);
        return Ok(());
    }
    for _ in 0..count {
        let mut position = [0.0; 3];
        let mut keep = |property: usize, value: f64| {
            for (axis, coordinate) in axes.iter().zip(&mut position) {
                if *axis == property {
                    *coordinate = value as f32;
                }
            }
        };
        source.row(element, &mut keep, &mut Vec::new(), None)?;
        soup.positions.push(Vec3::from_array(position));
    }
    Ok(())
}

/// The property that lists vertices, as this format or older programs call it.
fn index_list(element: &Element) -> Result<usize, Refusal> {
    let wanted = |name: &str| matches!(name, "vertex_indices" | "vertex_index");
    let found = element.properties.iter().position(|p| wanted(&p.name) && matches!(p.kind, Kind::List(..)));
    let missing =
        || Refusal::malformed(Place::File, format!("{} elements have no list \"vertex_indices\"", element.name));
    let list = found.ok_or_else(missing)?;
    match element.properties[list].kind {
        Kind::List(_, item) if item.is_float() => {
            Err(Refusal::new(Place::File, Problem::Unsupported("a list of indices with fractions".into())))
        }
        _ => Ok(list),
    }
}

fn read_faces(
    element: &Element,
    count: usize,
    source: &mut impl Source,
    soup: &mut Soup,
    vertices: usize,
) -> Result<(), Refusal> {
    let list = index_list(element)?;
    soup.triangles.reserve(count.min(source.remaining() / 6));
    let (mut items, mut corners) = (Vec::new(), Vec::new());
    for face in 0..count {
        source.row(element, &mut |_, _| (), &mut items, Some(list))?;
        corners.clear();
        for &item in &items {
            corners.push(index_of(item, face, vertices)?);
        }
        soup.push_face(&corners);
    }
    Ok(())
}

/// Strips of triangles; -1 starts a new one, and every second triangle turns the other way.
fn read_strips(
    element: &Element,
    count: usize,
    source: &mut impl Source,
    soup: &mut Soup,
    vertices: usize,
) -> Result<(), Refusal> {
    let list = index_list(element)?;
    let mut items = Vec::new();
    for _ in 0..count {
        source.row(element, &mut |_, _| (), &mut items, Some(list))?;
        for strip in items.split(|&item| item == -1) {
            for (turn, triangle) in strip.windows(3).enumerate() {
                let mut corners = [0; 3];
                for (corner, &item) in corners.iter_mut().zip(triangle) {
                    *corner = index_of(item, soup.faces, vertices)?;
                }
                if turn % 2 == 1 {
                    corners.swap(1, 2);
                }
                soup.push_face(&corners);
            }
        }
    }
    soup.notes.push(format!("{count} strips of triangles unrolled"));
    Ok(())
}
