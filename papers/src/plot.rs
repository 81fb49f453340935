//! Line plots and grouped bars as SVG text, to be put into a page: kuva draws, this room fits its pictures to ours.
//!
//! kuva writes a picture of fixed size, on white, with black text, whose ids
//! count up through the process. Ours scales with the page, takes text colour
//! and background from it (so dark pages work), and is a function of the data alone.

use kuva::plot::legend::LegendPosition;
use kuva::plot::{BarPlot, LinePlot, LineStyle, ScatterPlot};
use kuva::render::layout::{AxisLabelOverlap, Layout, TickFormat};
use kuva::render::plots::Plot;
use kuva::render::theme::Theme;
use std::sync::Arc;

/// Colours that show on white and on black; the first six, of Okabe and Ito, also differ for colour-blind readers.
const COLOURS: [&str; 10] =
    ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#8c6bb1", "#8b6b3e", "#888888", "#c2185b"];
const GREY: &str = "#80808050";
const FONTS: &str = "system-ui, sans-serif";
const WIDTH: f64 = 640.0;
const HEIGHT: f64 = 400.0;

/// How an axis turns values into lengths.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Scale {
    /// Equal steps are equally long.
    #[default]
    Linear,
    /// Equal factors are equally long; what is not above 0 is left out, and below 1e-10 all looks alike.
    Logarithmic,
}

/// An axis of a plot.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Axis {
    /// What is measured, and the unit.
    pub label: String,
    /// Linear or logarithmic.
    pub scale: Scale,
}

impl Axis {
    /// A linear axis.
    pub fn linear(label: &str) -> Self {
        Self { label: label.into(), scale: Scale::Linear }
    }

    /// A logarithmic axis.
    pub fn logarithmic(label: &str) -> Self {
        Self { label: label.into(), scale: Scale::Logarithmic }
    }

    fn can_show(&self, value: f64) -> bool {
        value.is_finite() && (self.scale == Scale::Linear || value > 0.0)
    }
}

/// One line of a plot.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Series {
    /// What the legend calls it.
    pub name: String,
    /// Its points (x, y), joined in this order. Those that their axis cannot show are left out.
    pub points: Vec<[f64; 2]>,
}

/// Several lines over the same axes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Lines {
    /// Written above; may be empty.
    pub title: String,
    /// The horizontal axis.
    pub x: Axis,
    /// The vertical axis.
    pub y: Axis,
    /// The lines, in the order of the legend; from the eleventh on colours come again, dashed.
    pub series: Vec<Series>,
}

/// Bars side by side, one of each series in each group.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Bars {
    /// Written above; may be empty.
    pub title: String,
    /// What is measured, and the unit; the axis is linear and starts at 0.
    pub y_label: String,
    /// Names of the series.
    pub series: Vec<String>,
    /// Name of each group, and its value in each series; a value that is not finite or missing has no bar.
    pub groups: Vec<(String, Vec<f64>)>,
}

impl Lines {
    /// The plot as an `<svg>` element; a line of text where there is no point to show. Names may hold any text.
    pub fn svg(&self) -> String {
        let shown: Vec<Vec<(f64, f64)>> = self.series.iter().map(|series| self.shown(series)).collect();
        if shown.iter().all(Vec::is_empty) {
            return nothing_to_show(&self.title);
        }
        let mut plots: Vec<Plot> = Vec::new();
        for (i, points) in shown.into_iter().enumerate().filter(|(_, points)| !points.is_empty()) {
            let colour = COLOURS[i % COLOURS.len()];
            let style = [LineStyle::Solid, LineStyle::Dashed, LineStyle::Dotted][i / COLOURS.len() % 3].clone();
            let line = LinePlot::new().with_data(points.iter().copied()).with_color(colour).with_line_style(style);
            plots.push(line.with_legend(literal(&self.series[i].name)).into());
            // Few points are measurements one wants to see; many would make a sausage.
            if points.len() <= 40 {
                plots.push(ScatterPlot::new().with_data(points).with_color(colour).with_size(3.0).into());
            }
        }
        let layout = Layout::auto_from_plots(&plots);
        let layout = layout.with_x_label(literal(&self.x.label)).with_y_label(literal(&self.y.label));
        let layout = if self.x.scale == Scale::Logarithmic { layout.with_log_x() } else { layout };
        let layout = if self.y.scale == Scale::Logarithmic { layout.with_log_y() } else { layout };
        draw(plots, layout, &self.title)
    }

    fn shown(&self, series: &Series) -> Vec<(f64, f64)> {
        let can_show = |&[x, y]: &[f64; 2]| self.x.can_show(x) && self.y.can_show(y);
        series.points.iter().filter(|point| can_show(point)).map(|&[x, y]| (x, y)).collect()
    }
}

impl Bars {
    /// The plot as an `<svg>` element; a line of text where there is no group. Names may hold any text.
    pub fn svg(&self) -> String {
        if self.groups.is_empty() || self.series.is_empty() {
            return nothing_to_show(&self.title);
        }
        let names: Vec<String> = self.series.iter().map(|name| literal(name)).collect();
        let mut plot = BarPlot::new().with_legend(names.iter().map(String::as_str).collect());
        for (name, values) in &self.groups {
            let value = |i: usize| values.get(i).copied().filter(|value| value.is_finite()).unwrap_or(0.0);
            let bars: Vec<_> = (0..names.len()).map(|i| (value(i), COLOURS[i % COLOURS.len()])).collect();
            plot = plot.with_group(literal(name), bars);
        }
        let plots = vec![plot.into()];
        let layout = Layout::auto_from_plots(&plots).with_y_label(literal(&self.y_label));
        let layout = layout.with_x_label_overlap(AxisLabelOverlap::Stagger);
        draw(plots, layout, &self.title)
    }
}

fn draw(plots: Vec<Plot>, layout: Layout, title: &str) -> String {
    let layout = layout
        .with_theme(page_theme())
        .with_width(WIDTH)
        .with_height(HEIGHT)
        .with_font_family(FONTS)
        .with_legend_box(false)
        .with_legend_position(LegendPosition::OutsideRightTop)
        .with_tick_format(TickFormat::Custom(Arc::new(short_number)));
    let layout = if title.is_empty() { layout } else { layout.with_title(literal(title)) };
    fit_to_page(&kuva::render_to_svg(plots, layout))
}

/// Text and lines in the colour of the page's text, on the page's background.
fn page_theme() -> Theme {
    Theme {
        background: "none".into(),
        axis_color: "currentColor".into(),
        tick_color: "currentColor".into(),
        text_color: "currentColor".into(),
        grid_color: GREY.into(),
        legend_bg: "none".into(),
        legend_border: "none".into(),
        ..Theme::light()
    }
}

/// kuva would read `$x^2$` as a formula; in a name it is only text.
fn literal(text: &str) -> String {
    text.replace('$', "\\$")
}

/// A number as short as an axis wants it.
fn short_number(value: f64) -> String {
    if value == 0.0 {
        return "0".into();
    }
    let (size, sign) = (value.abs(), if value < 0.0 { "-" } else { "" });
    let trimmed = |x: f64| {
        let text = format!("{x:.3}");
        text.trim_end_matches('0').trim_end_matches('.').to_string()
    };
    match size {
        _ if !(1e-3..1e9).contains(&size) => format!("{value:e}"),
        _ if size >= 1e6 => format!("{sign}{}M", trimmed(size / 1e6)),
        _ if size >= 1e4 => format!("{sign}{}k", trimmed(size / 1e3)),
        _ => trimmed(value),
    }
}

/// Lets the picture shrink with its column, and names its clip paths after what it shows.
fn fit_to_page(svg: &str) -> String {
    let Some((head, body)) = svg.split_once('>') else { return svg.to_string() };
    let size = |name: &str| head.split_once(&format!("{name}=\"")).and_then(|(_, rest)| rest.split_once('"'));
    let (Some((width, _)), Some((height, _))) = (size(" width"), size(" height")) else { return svg.to_string() };
    // A page holds several pictures, and an id must be one picture's own.
    let body = match body.split_once("id=\"kuva-clip-").and_then(|(_, rest)| rest.split_once('"')) {
        Some((number, _)) => {
            let old = format!("kuva-clip-{number}");
            let plain = body.replace(&old, "clip");
            body.replace(&old, &format!("clip-{:016x}", fingerprint(&plain)))
        }
        None => body.to_string(),
    };
    format!("{head} viewBox=\"0 0 {width} {height}\" style=\"max-width:100%;height:auto;color:inherit\">{body}")
}

/// FNV-1a, the same everywhere.
fn fingerprint(text: &str) -> u64 {
    text.bytes().fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
}

fn nothing_to_show(title: &str) -> String {
    let title = crate::html::escape(title);
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"320\" height=\"40\" fill=\"currentColor\">\
         <text x=\"8\" y=\"26\" font-family=\"{FONTS}\" font-size=\"14\">{title}: nothing to show</text></svg>"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines() -> Lines {
        let series = |name: &str, k: f64| Series {
            name: name.into(),
            points: (2..14).map(|i| [2f64.powi(i), k * 0.7f64.powi(i)]).collect(),
        };
        Lines {
            title: "Error <rms> & \"more\"".into(),
            x: Axis::logarithmic("triangles"),
            y: Axis::logarithmic("error, of the diagonal"),
            series: vec![series("half-edge collapse </svg>", 1.0), series("cost $5 and $6", 0.4)],
        }
    }

    fn bars() -> Bars {
        Bars {
            title: "Steps".into(),
            y_label: "ms".into(),
            series: vec!["ours".into(), "published".into()],
            groups: vec![("bunny <1>".into(), vec![3.0, 5.0]), ("armadillo".into(), vec![12.5, f64::NAN])],
        }
    }

    #[test]
    fn text_is_escaped_and_stays_text() {
        let svg = lines().svg();
        assert!(svg.starts_with("<svg ") && svg.ends_with("</svg>"));
        assert_eq!(svg.matches("</svg>").count(), 1);
        assert!(svg.contains("Error &lt;rms&gt; &amp; ") && svg.contains("collapse &lt;/svg&gt;"));
        assert!(svg.contains("cost $5 and $6"));
        assert!(bars().svg().contains("bunny &lt;1&gt;"));
    }

    #[test]
    fn the_picture_fits_the_page() {
        for svg in [lines().svg(), bars().svg()] {
            assert!(svg.contains("viewBox=\"0 0 ") && svg.contains("currentColor"), "{svg}");
            assert!(!svg.contains("kuva-clip") && !svg.contains("fill=\"white\""), "{svg}");
        }
    }

    #[test]
    fn the_same_data_give_the_same_text_and_other_data_other_ids() {
        assert_eq!(lines().svg(), lines().svg());
        let id = |svg: &str| {
            svg.split_once("url(#").and_then(|(_, rest)| rest.split_once(')')).map(|(id, _)| id.to_string())
        };
        let mut other = lines();
        other.series[0].points[0][1] *= 2.0;
        let (one, two) = (id(&lines().svg()), id(&other.svg()));
        assert!(one.is_some() && one != two);
        assert!(lines().svg().contains(&format!("id=\"{}\"", one.expect("a clip path"))));
    }

    #[test]
    fn what_cannot_be_shown_is_left_out() {
        let mut plot = lines();
        plot.series[0].points.extend([[0.0, 1.0], [1.0, -1.0], [f64::NAN, 1.0], [1.0, f64::INFINITY]]);
        assert_eq!(plot.svg(), lines().svg());
        assert!(Lines::default().svg().contains("nothing to show"));
        assert!(Bars { title: "<b>".into(), ..Bars::default() }.svg().contains("&lt;b&gt;: nothing"));
        let single = Series { name: "one".into(), points: vec![[1.0, 1.0]] };
        assert!(Lines { series: vec![single], ..lines() }.svg().contains("<circle"));
    }

    #[test]
    fn numbers_are_short() {
        let texts = [0.0, 1.0, -2.5, 0.001, 1e-4, 12.125, 9999.0, 20_000.0, 1e6, -2.5e6, 1e9].map(short_number);
        assert_eq!(texts, ["0", "1", "-2.5", "0.001", "1e-4", "12.125", "9999", "20k", "1M", "-2.5M", "1e9"]);
    }
}
