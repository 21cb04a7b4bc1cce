//! How a picture is drawn.

use crate::curve::XAxis;

/// What a panel's vertical axis says.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PanelText {
    /// The column it is about: [`RETURN`](crate::RETURN) or a design total's name.
    pub column: String,
    /// What is measured, such as `total stiffness`.
    pub label: String,
    /// The symbol of the unit to draw it in, such as `N/m` or `mm`; empty for a pure number. Values are brought to it from
    /// SI; one that is not known is taken for SI.
    pub unit: String,
    /// A known optimum, SI, drawn as a dashed line.
    pub optimum: Option<f64>,
}

/// What the band around several runs spans.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Band {
    /// The smallest to the largest run.
    #[default]
    MinMax,
    /// The 95 % bootstrap interval of the interquartile mean. Up to three runs carry none and are drawn one by one.
    Bootstrap,
}

/// What a picture is to be looked at on. The colours of both are those of Okabe and Ito (*Color Universal Design*, 2008;
/// <https://jfly.uni-koeln.de/color/>) without the yellow, which every common kind of colour vision tells apart.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Theme {
    /// Panels of one size, as many side by side as a wide screen holds.
    #[default]
    Screen,
    /// As wide as the text of a page (170 mm), whatever is on it: texts have 7.5 points and more, lines one, and each colour has
    /// dashes of its own for printers without colour.
    Print,
}

/// How a picture is drawn.
///
/// | option | default | what it does | range |
/// |---|---|---|---|
/// | `title` | none | the line above everything | any text |
/// | `x_axis` | `EnvSteps` | what the curves are drawn against; their `x` has to be that | - |
/// | `window` | 11 | rows in the trailing mean of the return | 1 to 1001 |
/// | `band` | `MinMax` | the band around several runs | - |
/// | `theme` | `Screen` | what it is to be looked at on | - |
/// | `panels` | none | axis texts and optima by column; a column without gets its own name | - |
/// | `asked` | none | labels with the runs that there should be, where some did not finish | - |
#[derive(Clone, Debug, PartialEq)]
pub struct PlotOptions {
    /// The line above everything; empty for none.
    pub title: String,
    /// What the curves are drawn against.
    pub x_axis: XAxis,
    /// Rows in the trailing mean of the return.
    pub window: usize,
    /// The band around several runs.
    pub band: Band,
    /// What it is to be looked at on.
    pub theme: Theme,
    /// Axis texts and optima by column.
    pub panels: Vec<PanelText>,
    /// Labels with the runs that there should be. The legend says `1 of 5 runs` where there are fewer.
    pub asked: Vec<(String, usize)>,
}

impl Default for PlotOptions {
    fn default() -> Self {
        Self {
            title: String::new(),
            x_axis: XAxis::EnvSteps,
            window: 11,
            band: Band::MinMax,
            theme: Theme::Screen,
            panels: Vec::new(),
            asked: Vec::new(),
        }
    }
}
