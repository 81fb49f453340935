//! A pen: panels beside each other, lines and cells in them, as SVG that takes its ink from the page around it.

use std::fmt::Write;

/// What a line or an area says.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Ink {
    /// The mesh, or what is there anyway.
    Plain,
    /// What is spoken of.
    Fine,
    /// What stands in its place.
    Coarse,
    /// What is wrong.
    Wrong,
    /// Hardly there.
    Faint,
    /// One of some colours, for things that are told apart.
    Hue(usize),
}

const HUES: [&str; 12] = [
    "#2a7ab8", "#c98a1b", "#3f9b57", "#8d63b5", "#d2556f", "#35a3ad", "#8a8a3a", "#6d5fd2", "#b5651d", "#7fb800",
    "#c45fb0", "#5b7083",
];

impl Ink {
    fn colour(self) -> &'static str {
        match self {
            Ink::Plain | Ink::Faint => "currentColor",
            Ink::Fine => "#2a7ab8",
            Ink::Coarse => "#c98a1b",
            Ink::Wrong => "#d2373a",
            Ink::Hue(i) => HUES[i % HUES.len()],
        }
    }

    fn strength(self) -> f32 {
        if self == Ink::Faint { 0.25 } else { 0.9 }
    }
}

/// A point in a panel, from 0 to 1, up and to the right.
pub type At = [f32; 2];

/// A row of panels.
#[derive(Default)]
pub struct Drawing {
    body: String,
    panels: usize,
}

/// Width of a panel, and of the space before it; height of what is drawn in it, and of all.
const WIDE: f32 = 190.0;
const GAP: f32 = 22.0;
const HIGH: f32 = 150.0;
const TALL: f32 = 190.0;

impl Drawing {
    /// Adds a panel with what is said under it.
    pub fn panel(mut self, caption: &str, ink: Ink, draw: impl FnOnce(&mut Panel)) -> Self {
        let left = GAP + self.panels as f32 * (WIDE + GAP);
        let mut panel = Panel { body: String::new(), left };
        draw(&mut panel);
        self.body += &panel.body;
        let (x, fill) = (left + WIDE / 2.0, ink.colour());
        for (i, line) in caption.split('\n').enumerate() {
            let y = HIGH + 14.0 + 13.0 * i as f32;
            _ = writeln!(self.body, "<text x=\"{x}\" y=\"{y}\" fill=\"{fill}\" text-anchor=\"middle\">{line}</text>");
        }
        self.panels += 1;
        self
    }

    /// A sign between the last panel and the next.
    pub fn sign(mut self, sign: &str) -> Self {
        let x = GAP / 2.0 + self.panels as f32 * (WIDE + GAP);
        let y = HIGH / 2.0 + 6.0;
        _ = writeln!(
            self.body,
            "<text x=\"{x}\" y=\"{y}\" fill=\"currentColor\" text-anchor=\"middle\" font-size=\"18\">{sign}</text>"
        );
        self
    }

    /// The drawing as SVG, without an empty line, so that it can stand within Markdown.
    pub fn svg(&self) -> String {
        let width = GAP + self.panels as f32 * (WIDE + GAP);
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {TALL}\" style=\"max-width:{width}px;width:100%\" \
             font-family=\"sans-serif\" font-size=\"11\">\n{}</svg>\n",
            self.body
        )
    }
}

/// A place to draw in.
pub struct Panel {
    body: String,
    left: f32,
}

impl Panel {
    fn place(&self, [x, y]: At) -> String {
        format!("{:.1},{:.1}", self.left + 6.0 + x * (WIDE - 12.0), HIGH - 6.0 - y * (HIGH - 12.0))
    }

    /// A filled polygon with a thin outline.
    pub fn area(&mut self, points: &[At], ink: Ink, opacity: f32) {
        let (places, colour) = (points.iter().map(|&at| self.place(at)).collect::<Vec<_>>().join(" "), ink.colour());
        _ = writeln!(
            self.body,
            "<polygon points=\"{places}\" fill=\"{colour}\" fill-opacity=\"{opacity}\" stroke=\"{colour}\" \
             stroke-opacity=\"{}\" stroke-width=\"1\" stroke-linejoin=\"round\"/>",
            ink.strength() * 0.6
        );
    }

    /// A line of some width.
    pub fn line(&mut self, from: At, to: At, ink: Ink, width: f32) {
        let (from, to) = (self.place(from), self.place(to));
        let (x1, y1) = from.split_once(',').expect("two numbers");
        let (x2, y2) = to.split_once(',').expect("two numbers");
        _ = writeln!(
            self.body,
            "<line x1=\"{x1}\" y1=\"{y1}\" x2=\"{x2}\" y2=\"{y2}\" stroke=\"{}\" stroke-opacity=\"{}\" \
             stroke-width=\"{width}\" stroke-linecap=\"round\"/>",
            ink.colour(),
            ink.strength()
        );
    }

    /// A line with a head at its end, which stops short of a dot there.
    pub fn arrow(&mut self, from: At, to: At, ink: Ink) {
        let (dx, dy) = (to[0] - from[0], to[1] - from[1]);
        let length = dx.hypot(dy).max(1e-3);
        let (ux, uy) = (dx / length, dy / length);
        let end = [to[0] - 0.045 * ux, to[1] - 0.045 * uy];
        self.line(from, end, ink, 1.2);
        let wing = |side: f32| [end[0] - 0.03 * ux - side * 0.02 * uy, end[1] - 0.03 * uy + side * 0.02 * ux];
        self.area(&[end, wing(1.0), wing(-1.0)], ink, 0.9);
    }

    /// A dot; hollow where it is not filled.
    pub fn dot(&mut self, at: At, ink: Ink, radius: f32, filled: bool) {
        let (place, colour) = (self.place(at), ink.colour());
        let (x, y) = place.split_once(',').expect("two numbers");
        let opacity = if filled { ink.strength() } else { 0.0 };
        _ = writeln!(
            self.body,
            "<circle cx=\"{x}\" cy=\"{y}\" r=\"{radius}\" fill=\"{colour}\" fill-opacity=\"{opacity}\" \
             stroke=\"{colour}\" stroke-opacity=\"{}\" stroke-width=\"1.4\"/>",
            ink.strength()
        );
    }

    /// A circle, by its radius in the panel's units across and up.
    pub fn circle(&mut self, at: At, radius: At, ink: Ink) {
        let place = self.place(at);
        let (x, y) = place.split_once(',').expect("two numbers");
        _ = writeln!(
            self.body,
            "<ellipse cx=\"{x}\" cy=\"{y}\" rx=\"{:.1}\" ry=\"{:.1}\" fill=\"{colour}\" fill-opacity=\"0.07\" \
             stroke=\"{colour}\" stroke-opacity=\"{}\" stroke-width=\"1.4\"/>",
            radius[0] * (WIDE - 12.0),
            radius[1] * (HIGH - 12.0),
            ink.strength(),
            colour = ink.colour()
        );
    }

    /// A word or two.
    pub fn word(&mut self, at: At, ink: Ink, word: &str) {
        let place = self.place(at);
        let (x, y) = place.split_once(',').expect("two numbers");
        _ = writeln!(
            self.body,
            "<text x=\"{x}\" y=\"{y}\" fill=\"{}\" text-anchor=\"middle\" dominant-baseline=\"middle\">{word}</text>",
            ink.colour()
        );
    }
}
