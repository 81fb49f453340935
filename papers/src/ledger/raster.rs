//! Grids of samples: terrains as heights, images as meshes. Read from bytes of PNG and SRTM files.

use super::LedgerError;
use glam::Vec3;
use mt_core::{Mesh, VertexId};

/// The relief of a terrain is this share of its longer side: the files at hand do not all say how large a cell is.
const RELIEF: f32 = 0.2;
/// What an SRTM file has where nothing was measured.
const VOID: i16 = -32768;

/// How a file tells samples.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Coding {
    /// A picture whose grey values, 0 to 1, are samples.
    Grey,
    /// A picture whose three colours are a height in metres, as Mapbox codes terrains.
    Mapbox,
    /// A square SRTM tile of heights in metres.
    Srtm,
}

/// Samples in rows from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Raster {
    /// Samples in a row.
    pub width: usize,
    /// `width` times the number of rows.
    pub values: Vec<f32>,
}

impl Raster {
    /// Number of rows.
    pub fn height(&self) -> usize {
        self.values.len() / self.width.max(1)
    }

    /// The sample in column `x` and row `y`; beyond the border the nearest one.
    pub fn at(&self, x: isize, y: isize) -> f32 {
        let clamp = |i: isize, count: usize| i.clamp(0, count as isize - 1) as usize;
        self.values[clamp(y, self.height()) * self.width + clamp(x, self.width)]
    }

    /// A function sampled at whole numbers.
    pub fn sampled(width: usize, height: usize, value: impl Fn(f32, f32) -> f32) -> Self {
        let values = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        Self { width, values: values.map(|(x, y)| value(x as f32, y as f32)).collect() }
    }

    /// The samples in the bytes of a file.
    pub fn read(bytes: &[u8], coding: Coding) -> Result<Self, LedgerError> {
        match coding {
            Coding::Srtm => Self::from_hgt(bytes),
            Coding::Grey => Self::from_png(bytes, |[r, g, b]| (0.299 * r + 0.587 * g + 0.114 * b) / 255.0),
            Coding::Mapbox => Self::from_png(bytes, |[r, g, b]| (r * 65536.0 + g * 256.0 + b) * 0.1 - 10_000.0),
        }
    }

    fn from_png(bytes: &[u8], value: impl Fn([f32; 3]) -> f32) -> Result<Self, LedgerError> {
        let wrong =
            |error: &dyn std::fmt::Display| LedgerError::Data(format!("not a picture that can be read: {error}"));
        let mut decoder = png::Decoder::new(std::io::Cursor::new(bytes));
        decoder.set_transformations(png::Transformations::normalize_to_color8());
        let mut reader = decoder.read_info().map_err(|error| wrong(&error))?;
        let size = reader.output_buffer_size().ok_or_else(|| wrong(&"too large"))?;
        let mut pixels = vec![0; size];
        let info = reader.next_frame(&mut pixels).map_err(|error| wrong(&error))?;
        let channels = info.color_type.samples();
        let value = |pixel: &[u8]| match *pixel {
            [r, g, b, ..] => value([r, g, b].map(f32::from)),
            [grey, ..] => value([f32::from(grey); 3]),
            [] => 0.0,
        };
        let values = pixels[..info.buffer_size()].chunks_exact(channels).map(value).collect();
        Ok(Self { width: info.width as usize, values })
    }

    /// A square SRTM tile: heights in metres, two bytes each, the larger one first. Voids take the sample before them.
    fn from_hgt(bytes: &[u8]) -> Result<Self, LedgerError> {
        let side = (bytes.len() / 2).isqrt();
        if side < 2 || side * side * 2 != bytes.len() {
            return Err(LedgerError::Data("not a square tile of heights".into()));
        }
        let mut last = 0.0;
        let mut value = |pair: &[u8]| {
            let height = i16::from_be_bytes([pair[0], pair[1]]);
            if height != VOID {
                last = f32::from(height);
            }
            last
        };
        Ok(Self { width: side, values: bytes.chunks_exact(2).map(&mut value).collect() })
    }

    /// The part that begins in column `x` and row `y`, as far as there is anything.
    pub fn crop(&self, x: usize, y: usize, width: usize, height: usize) -> Self {
        let (x, y) = (x.min(self.width - 1), y.min(self.height() - 1));
        let (width, height) = (width.min(self.width - x), height.min(self.height() - y));
        let rows = (y..y + height).flat_map(|row| &self.values[row * self.width + x..][..width]);
        Self { width, values: rows.copied().collect() }
    }

    /// A terrain over the plane: a vertex a sample, one unit apart, y up, rows towards z.
    pub fn terrain(&self) -> Mesh<3> {
        let (low, high) = self.values.iter().fold((f32::MAX, f32::MIN), |(low, high), &v| (low.min(v), high.max(v)));
        let scale = RELIEF * self.width.max(self.height()) as f32 / (high - low).max(f32::MIN_POSITIVE);
        self.mesh(|x, y, value| Vec3::new(x, (value - low) * scale, y))
    }

    /// A plane mesh, y up, a vertex a sample.
    pub fn plane(&self) -> Mesh<3> {
        self.mesh(|x, y, _| Vec3::new(x, 0.0, y))
    }

    fn mesh(&self, place: impl Fn(f32, f32, f32) -> Vec3) -> Mesh<3> {
        let (columns, rows) = (self.width, self.height());
        let position = |i: usize| place((i % columns) as f32, (i / columns) as f32, self.values[i]);
        let mut cells = Vec::with_capacity(2 * columns.saturating_sub(1) * rows.saturating_sub(1));
        for y in 1..rows {
            for x in 1..columns {
                let at = |dx: usize, dy: usize| VertexId::new((y - dy) * columns + x - dx);
                cells.push([at(1, 1), at(1, 0), at(0, 1)]);
                cells.push([at(0, 1), at(1, 0), at(0, 0)]);
            }
        }
        Mesh { positions: (0..self.values.len()).map(position).collect(), cells }
    }

    /// The magnitude of Sobel's gradient at each sample.
    pub fn sobel(&self) -> Vec<f32> {
        let magnitude = |i: usize| {
            let (x, y) = ((i % self.width) as isize, (i / self.width) as isize);
            let side = |dx: isize| self.at(x + dx, y - 1) + 2.0 * self.at(x + dx, y) + self.at(x + dx, y + 1);
            let level = |dy: isize| self.at(x - 1, y + dy) + 2.0 * self.at(x, y + dy) + self.at(x + 1, y + dy);
            (side(1) - side(-1)).hypot(level(1) - level(-1))
        };
        (0..self.values.len()).map(magnitude).collect()
    }

    /// The value between samples.
    pub fn between(&self, x: f32, y: f32) -> f32 {
        let (left, top) = (x.floor(), y.floor());
        let at = |dx: isize, dy: isize| self.at(left as isize + dx, top as isize + dy);
        let (u, v) = (x - left, y - top);
        (at(0, 0) * (1.0 - u) + at(1, 0) * u) * (1.0 - v) + (at(0, 1) * (1.0 - u) + at(1, 1) * u) * v
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mt_core::format::census;

    #[test]
    fn a_terrain_faces_up_and_is_one_sheet() {
        let raster = Raster::sampled(7, 5, |x, y| (x * 0.7).sin() + y);
        let mesh = raster.terrain();
        let census = census(&mesh);
        assert_eq!((mesh.positions.len(), mesh.cells.len()), (35, 48));
        assert!(census.is_manifold() && !census.is_closed());
        let up = |cell: &[VertexId; 3]| {
            let [a, b, c] = cell.map(|v| mesh.positions[v.index()]);
            (b - a).cross(c - a).y > 0.0
        };
        assert!(mesh.cells.iter().all(up));
    }

    #[test]
    fn pictures_and_tiles_are_read() {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, 3, 2);
        encoder.set_color(png::ColorType::Grayscale);
        encoder.write_header().unwrap().write_image_data(&[0, 51, 102, 153, 204, 255]).unwrap();
        let raster = Raster::read(&bytes, Coding::Grey).unwrap();
        assert_eq!((raster.width, raster.height(), raster.at(-4, 0)), (3, 2, 0.0));
        assert_eq!(raster.crop(1, 0, 9, 1).values, [0.2, 0.4]);
        assert!((raster.between(0.5, 0.5) - 0.4).abs() < 1e-6);
        assert!(Raster::read(b"no picture", Coding::Grey).is_err() && Raster::read(&[0; 6], Coding::Srtm).is_err());
        let tile = Raster::read(&[0, 7, 0x80, 0, 0x01, 0, 0, 1], Coding::Srtm).unwrap();
        assert_eq!(tile.values, [7.0, 7.0, 256.0, 1.0]);
    }

    #[test]
    fn an_edge_is_where_sobel_says() {
        let step = Raster::sampled(6, 4, |x, _| if x < 3.0 { 0.0 } else { 1.0 });
        assert_eq!(step.sobel()[6..12], [0.0, 0.0, 4.0, 4.0, 0.0, 0.0]);
    }
}
