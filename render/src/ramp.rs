//! Colours: eight-bit sRGB with opacity, and the perceptually uniform ramps that values are shown by.

/// Red, green, blue (sRGB) and opacity, each 0 to 255.
pub type Rgba = [u8; 4];

/// A way from value to colour along which equal steps look equal, and lightness rises all along.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ramp {
    /// Violet, green, yellow.
    Viridis,
    /// Blue, magenta, orange, yellow; told apart from viridis at a glance.
    Plasma,
}

/// Knots of a ramp, evenly spaced; ten of them are within 3/255 of the full tables.
pub(crate) const KNOTS: usize = 10;

/// After the tables of matplotlib (Smith, van der Walt, Firing; CC0).
const VIRIDIS: [u32; KNOTS] =
    [0x440154, 0x482878, 0x3e4a89, 0x31688e, 0x26828e, 0x1f9e89, 0x35b779, 0x6dcd59, 0xb4de2c, 0xfde725];
const PLASMA: [u32; KNOTS] =
    [0x0d0887, 0x47039f, 0x7301a8, 0x9c179e, 0xbd3786, 0xd8576b, 0xed7953, 0xfa9e3b, 0xfdc926, 0xf0f921];

impl Ramp {
    /// The colour at `position`, 0 to 1; beyond the ends the ends' colours, and grey for what is not a number.
    pub fn colour(self, position: f32) -> Rgba {
        if position.is_nan() {
            return [150, 150, 150, 255];
        }
        let place = position.clamp(0.0, 1.0) * (KNOTS - 1) as f32;
        let below = (place as usize).min(KNOTS - 2);
        let share = place - below as f32;
        let (low, high) = (self.knot(below), self.knot(below + 1));
        std::array::from_fn(|i| (f32::from(low[i]) * (1.0 - share) + f32::from(high[i]) * share).round() as u8)
    }

    /// The colour of one knot, opaque.
    pub(crate) fn knot(self, index: usize) -> Rgba {
        let table = match self {
            Ramp::Viridis => &VIRIDIS,
            Ramp::Plasma => &PLASMA,
        };
        let [_, red, green, blue] = table[index].to_be_bytes();
        [red, green, blue, 255]
    }
}
