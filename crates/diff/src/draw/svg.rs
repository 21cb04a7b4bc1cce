//! The picture itself.

use std::fmt::Write as _;

use super::GraphStyle;
use super::dot::mark;
use super::graph::{Graph, Kind, Node};
use super::layout::{Layout, place};
use super::simplify::reads_many;

const MARGIN: f64 = 28.0;
const TITLE: f64 = 34.0;
const LEGEND: f64 = 40.0;
/// How far the second outline of a group is set off.
const STACK: f64 = 4.0;
/// The radius of an operator's ends.
const ROUND: f64 = 18.0;
/// The distance between the arrows into an operator of many inputs.
const ARROW_GAP: f64 = 15.0;

/// Fill and outline of each kind of node.
fn colours(kind: Kind) -> (&'static str, &'static str) {
    match kind {
        Kind::Uniform => ("#dbeafe", "#2563eb"),
        Kind::Column => ("#dcfce7", "#16a34a"),
        Kind::Constant => ("none", "none"),
        Kind::Output => ("#ffedd5", "#ea580c"),
        Kind::Unary(_) | Kind::Binary(_) | Kind::Clamp => ("#ffffff", "#475569"),
    }
}

/// Whether a node is drawn as an operator: a circle, or a pill where its sign is a word.
fn is_operator(node: &Node) -> bool {
    matches!(node.kind, Kind::Unary(_) | Kind::Binary(_) | Kind::Clamp)
}

/// Roughly what a sans-serif text of this size (px) takes.
fn text_width(text: &str, size: f64) -> f64 {
    let narrow = |c: char| {
        if "iljft.,[]()|·/ ".contains(c) {
            0.34
        } else if "mwMW".contains(c) {
            0.86
        } else {
            0.58
        }
    };
    text.chars().map(narrow).sum::<f64>() * size
}

fn size(node: &Node) -> (f64, f64) {
    let text = text_width(&node.label, 13.0);
    match node.kind {
        Kind::Constant => (text + 8.0, 20.0),
        // Tall enough for its arrows to be told apart.
        _ if is_operator(node) => {
            let height = f64::max(2.0 * ROUND, node.inputs.len() as f64 * ARROW_GAP + 8.0);
            (if text <= 28.0 { 2.0 * ROUND } else { text + 26.0 }, height)
        }
        _ => (text + 30.0, 32.0),
    }
}

pub(super) fn write(graph: &Graph, style: &GraphStyle) -> String {
    let sizes: Vec<_> = graph.nodes.iter().map(size).collect();
    let layout = place(graph, &sizes);
    let head = if style.title.is_empty() { 0.0 } else { TITLE };
    let (legend, legend_width) = legend(graph, style);
    let inner = layout.width.max(legend_width).max(text_width(&style.title, 17.0));
    let (width, height) = (inner + 2.0 * MARGIN, layout.height + head + LEGEND + 2.0 * MARGIN);
    let mut text = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width:.0} {height:.0}\" width=\"{width:.0}\" \
         height=\"{height:.0}\" font-family=\"Helvetica, Arial, 'Liberation Sans', 'DejaVu Sans', sans-serif\" \
         font-size=\"13\">\n<rect width=\"100%\" height=\"100%\" fill=\"#fdfdfc\"/>\n"
    );
    if head > 0.0 {
        let _ = writeln!(
            text,
            "<text x=\"{MARGIN}\" y=\"{:.1}\" font-size=\"17\" font-weight=\"600\" fill=\"#0f172a\">{}</text>",
            MARGIN + 8.0,
            escaped(&style.title)
        );
    }
    let left = MARGIN + (inner - layout.width) / 2.0;
    let _ = writeln!(text, "<g transform=\"translate({left:.1} {:.1})\">", MARGIN + head);
    edges(&mut text, graph, &sizes, &layout);
    for (node, (&at, &size)) in graph.nodes.iter().zip(layout.at.iter().zip(&sizes)) {
        draw_node(&mut text, node, at, size);
    }
    let _ = writeln!(text, "</g>");
    let _ = writeln!(text, "<g transform=\"translate({MARGIN} {:.1})\">\n{legend}</g>\n</svg>", height - MARGIN);
    text
}

fn draw_node(text: &mut String, node: &Node, (x, y): (f64, f64), (width, height): (f64, f64)) {
    let (fill, outline) = colours(node.kind);
    let operator = is_operator(node);
    let round = if operator { ROUND } else { 8.0 };
    let weight = if node.kind == Kind::Output { 2.0 } else { 1.4 };
    if node.kind != Kind::Constant {
        let mut outline_at = |shift: f64| {
            let _ = writeln!(
                text,
                "<rect x=\"{:.1}\" y=\"{:.1}\" width=\"{width:.1}\" height=\"{height:.1}\" rx=\"{round:.1}\" \
                 fill=\"{fill}\" stroke=\"{outline}\" stroke-width=\"{weight}\"/>",
                x - width / 2.0 + shift,
                y - height / 2.0 - shift,
            );
        };
        // A group looks like a stack.
        if !node.members.is_empty() {
            outline_at(STACK);
        }
        outline_at(0.0);
    }
    let symbol = operator && node.label.chars().count() == 1;
    let (colour, font) = match node.kind {
        Kind::Constant => ("#94a3b8", 13),
        _ if symbol => ("#0f172a", 18),
        _ => ("#0f172a", 13),
    };
    let _ = writeln!(
        text,
        "<text x=\"{x:.1}\" y=\"{:.1}\" font-size=\"{font}\" text-anchor=\"middle\" fill=\"{colour}\">{}</text>",
        y + f64::from(font) * 0.35,
        escaped(&node.label)
    );
}

fn edges(text: &mut String, graph: &Graph, sizes: &[(f64, f64)], layout: &Layout) {
    for (to, node) in graph.nodes.iter().enumerate() {
        let ways = &layout.ways[to];
        let from_height = |k: usize| ways[k].last().map_or(layout.at[node.inputs[k].from].1, |way| way.2);
        // Arrows arrive one above the other in the order in which they come.
        let mut arriving: Vec<usize> = (0..node.inputs.len()).collect();
        arriving.sort_by(|&a, &b| from_height(a).total_cmp(&from_height(b)));
        for (rank, &k) in arriving.iter().enumerate() {
            let edge = &node.inputs[k];
            let (half, height) = (sizes[to].0 / 2.0, sizes[to].1);
            let step = (height * 0.62 / arriving.len() as f64).clamp(11.0, ARROW_GAP);
            let spread = (rank as f64 - (arriving.len() - 1) as f64 / 2.0) * step;
            // The corners of an operator are quarter circles.
            let beyond = (spread.abs() - (height / 2.0 - ROUND)).max(0.0);
            let inset = if is_operator(node) { ROUND - (ROUND * ROUND - beyond * beyond).max(0.0).sqrt() } else { 0.0 };
            let end = (layout.at[to].0 - half + inset - 1.0, layout.at[to].1 + spread);
            let start = (layout.at[edge.from].0 + sizes[edge.from].0 / 2.0, layout.at[edge.from].1);
            let faint = graph.nodes[edge.from].kind == Kind::Constant;
            let colour = if faint { "#cbd5e1" } else { "#64748b" };
            let weight = if reads_many(edge, &graph.nodes) { 2.2 } else { 1.2 };
            let mut path = format!("M{:.1} {:.1}", start.0, start.1);
            let mut pen = start;
            for &(x0, x1, y) in &ways[k] {
                bend(&mut path, pen, (x0, y));
                let _ = write!(path, " L{x1:.1} {y:.1}");
                pen = (x1, y);
            }
            bend(&mut path, pen, (end.0 - 7.0, end.1));
            let _ = writeln!(text, "<path d=\"{path}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"{weight}\"/>");
            let (x, y) = end;
            let _ = writeln!(text, "<path d=\"M{x:.1} {y:.1} l-9 -4 l2 4 l-2 4 z\" fill=\"{colour}\"/>");
            if edge.minus {
                minus(text, (x - 17.0, y));
            }
            let mark = mark(edge, graph, to, k);
            let mark = mark.trim_start_matches('−');
            if !mark.is_empty() {
                // Above its arrow, below for the last of several, so that marks keep apart.
                let below = rank > 0 && rank + 1 == arriving.len();
                let y = if below { y + 13.0 } else { y - 5.0 };
                write_mark(text, &escaped(mark), (x - 10.0, y));
            }
        }
    }
}

/// The sign of a subtracted term, on its line as in a block diagram.
fn minus(text: &mut String, (x, y): (f64, f64)) {
    let _ = writeln!(
        text,
        "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"5.5\" fill=\"#ffffff\" stroke=\"#dc2626\" stroke-width=\"1.2\"/>\
         <path d=\"M{:.1} {y:.1} h6\" stroke=\"#dc2626\" stroke-width=\"1.6\"/>",
        x - 3.0
    );
}

/// A mark beside an arrow, with a halo that keeps lines off it (two texts, because not every viewer knows paint orders).
fn write_mark(text: &mut String, mark: &str, (x, y): (f64, f64)) {
    for look in ["fill=\"#fdfdfc\" stroke=\"#fdfdfc\" stroke-width=\"3\"", "fill=\"#334155\""] {
        let _ =
            writeln!(text, "<text x=\"{x:.1}\" y=\"{y:.1}\" font-size=\"11\" text-anchor=\"end\" {look}>{mark}</text>");
    }
}

/// A curve that leaves and arrives level.
fn bend(path: &mut String, from: (f64, f64), to: (f64, f64)) {
    let middle = f64::midpoint(from.0, to.0);
    let _ = write!(path, " C{middle:.1} {:.1} {middle:.1} {:.1} {:.1} {:.1}", from.1, to.1, to.0, to.1);
}

/// The kinds of node that occur, and the width of the line.
fn legend(graph: &Graph, style: &GraphStyle) -> (String, f64) {
    let kinds = [
        (Kind::Uniform, style.uniform_legend.as_str()),
        (Kind::Column, style.column_legend.as_str()),
        (Kind::Output, "output"),
    ];
    let mut text = String::new();
    let mut x = 0.0;
    for (kind, name) in kinds {
        if graph.nodes.iter().any(|node| node.kind == kind) {
            let (fill, outline) = colours(kind);
            let _ = writeln!(
                text,
                "<rect x=\"{x:.1}\" y=\"-11\" width=\"18\" height=\"12\" rx=\"3\" fill=\"{fill}\" stroke=\"{outline}\"/>\
                 <text x=\"{:.1}\" y=\"-1\" font-size=\"12\" fill=\"#475569\">{}</text>",
                x + 24.0,
                escaped(name)
            );
            x += 24.0 + text_width(name, 12.0) + 22.0;
        }
    }
    (text, x)
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}
