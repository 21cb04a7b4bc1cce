//! The drawing of a part: seen along its axis and from two sides, with sizes, levels and a table of its holes. At full scale, in mm.

use std::fmt::Write;

use super::dimensions::{levels, rounds};
use crate::bill::Item;
use crate::parts::Part;
use crate::solid::{Face, faces};

/// Around views, mm.
const MARGIN: f64 = 18.0;
/// Lines of the tables, mm.
const LINE: f64 = 4.2;
/// Faces that meet at a smaller angle belong to one round side; its cosine.
const SMOOTH: f64 = 0.94;
/// The most rows of a table of holes that is legible; holes on a circle share a row.
const MOST_ROWS: usize = 60;

/// A drawing on its way.
struct Sheet {
    body: String,
    size: [f64; 2],
}

impl Sheet {
    fn text(&mut self, at: [f64; 2], size: f64, anchor: &str, text: &str) {
        let text = text.replace('&', "&amp;").replace('<', "&lt;");
        // Writing to a string cannot fail.
        let _ = writeln!(
            self.body,
            "<text x=\"{:.2}\" y=\"{:.2}\" font-size=\"{size}\" text-anchor=\"{anchor}\">{text}</text>",
            at[0], at[1]
        );
        self.size[1] = self.size[1].max(at[1] + MARGIN);
    }

    fn line(&mut self, from: [f64; 2], to: [f64; 2], class: &str) {
        let _ = writeln!(
            self.body,
            "<line class=\"{class}\" x1=\"{:.3}\" y1=\"{:.3}\" x2=\"{:.3}\" y2=\"{:.3}\"/>",
            from[0], from[1], to[0], to[1]
        );
    }

    /// A dimension line with its number, beside a view.
    fn dimension(&mut self, from: [f64; 2], to: [f64; 2], text: &str) {
        self.line(from, to, "dim");
        let upright = (to[0] - from[0]).abs() < 1e-9;
        let tick = if upright { [1.2, 0.0] } else { [0.0, 1.2] };
        for end in [from, to] {
            self.line([end[0] - tick[0], end[1] - tick[1]], [end[0] + tick[0], end[1] + tick[1]], "dim");
        }
        let middle = [0.5 * (from[0] + to[0]), 0.5 * (from[1] + to[1])];
        if upright {
            self.text([middle[0] + 1.5, middle[1] + 1.0], 3.2, "start", text);
        } else {
            self.text([middle[0], middle[1] - 1.2], 3.2, "middle", text);
        }
    }
}

/// The drawing of a part that is this row of the bill. Lines are those of all edges, hidden ones too.
pub(crate) fn part_drawing(part: &Part, item: &Item) -> String {
    let [upright, across, along] = part.axis.names();
    let (all, vertices) = faces(&part.mesh);
    let [low, high] = part.mesh.bounds().map(|bound| part.axis.split(bound));
    let low = [low.1[0], low.1[1], low.0].map(|it| 1e3 * it);
    let high = [high.1[0], high.1[1], high.0].map(|it| 1e3 * it);
    let extent = [0, 1, 2].map(|i| high[i] - low[i]);
    let edges = edges(&all, vertices);
    let flat = |point: [f64; 3]| {
        let (height, [a, b]) = part.axis.split(point);
        [a, b, height].map(|it| 1e3 * it)
    };
    let mut sheet = Sheet { body: String::new(), size: [0.0; 2] };
    // From above; from the front below it; from the side to the right.
    let top = [MARGIN, MARGIN + 10.0];
    let below = [MARGIN, top[1] + extent[1] + MARGIN];
    let right = [top[0] + extent[0] + MARGIN, top[1]];
    let views: [([f64; 2], usize, usize); 3] = [(top, 0, 1), (below, 0, 2), (right, 2, 1)];
    for (origin, horizontal, vertical) in views {
        let put = |point: [f64; 3]| {
            let point = flat(point);
            [origin[0] + point[horizontal] - low[horizontal], origin[1] + high[vertical] - point[vertical]]
        };
        for [from, to] in &edges {
            let (from, to) = (put(*from), put(*to));
            if (from[0] - to[0]).hypot(from[1] - to[1]) > 1e-6 {
                sheet.line(from, to, "edge");
            }
        }
        let names = [across, along, upright];
        let (width, height) = (extent[horizontal], extent[vertical]);
        let bottom = origin[1] + height + 5.0;
        sheet.dimension([origin[0], bottom], [origin[0] + width, bottom], &format!("{} {width:.1}", names[horizontal]));
        let beside = origin[0] + width + 4.0;
        sheet.dimension([beside, origin[1]], [beside, origin[1] + height], &format!("{} {height:.1}", names[vertical]));
    }
    // The holes by their numbers, where they are.
    let mut row = [right[0] + extent[2] + MARGIN, MARGIN + 10.0];
    tables(part, &mut sheet, &mut row, |middle| {
        [top[0] + 1e3 * middle[0] - low[0], top[1] + high[1] - 1e3 * middle[1]]
    });
    let head = format!("{} · {} of it · mm, 1:1", part.name, item.count);
    sheet.text([MARGIN, MARGIN - 6.0], 5.0, "start", &head);
    sheet.text([MARGIN, MARGIN], 3.2, "start", &format!("{}; {upright} upright in the printer", item.what));
    let width = (row[0] + 95.0).max(below[0] + extent[0] + 2.0 * MARGIN);
    let height = sheet.size[1].max(below[1] + extent[2] + MARGIN + 10.0);
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width:.1}mm\" height=\"{height:.1}mm\" viewBox=\"0 0 {width:.1} {height:.1}\" \
         font-family=\"sans-serif\">\n<style>.edge{{stroke:#222;stroke-width:.15}}.dim{{stroke:#06c;stroke-width:.15}}</style>\n\
         <rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n{}</svg>\n",
        sheet.body
    )
}

/// To a hundredth of a millimetre, and no negative zero.
fn hundredths(metres: f64) -> f64 {
    (1e5 * metres).round() / 100.0 + 0.0
}

/// The edges between faces that are no one round side.
fn edges(all: &[Face], vertices: &[[f64; 3]]) -> Vec<[[f64; 3]; 2]> {
    let mut normals: std::collections::BTreeMap<[usize; 2], Vec<[f64; 3]>> = std::collections::BTreeMap::new();
    for face in all {
        for chain in &face.loops {
            for i in 0..chain.len() {
                let (a, b) = (chain[i], chain[(i + 1) % chain.len()]);
                normals.entry([a.min(b), a.max(b)]).or_default().push(face.normal);
            }
        }
    }
    let sharp = |normals: &[[f64; 3]]| match normals {
        [one, other] => (0..3).map(|i| one[i] * other[i]).sum::<f64>() < SMOOTH,
        _ => true,
    };
    normals
        .into_iter()
        .filter(|(_, normals)| sharp(normals))
        .map(|(ends, _)| ends.map(|index| vertices[index]))
        .collect()
}

/// Holes, round outsides and levels.
fn tables(part: &Part, sheet: &mut Sheet, row: &mut [f64; 2], put: impl Fn([f64; 2]) -> [f64; 2]) {
    let [upright, across, along] = part.axis.names();
    let mut number = 0;
    for (cut, title) in [(true, "round holes"), (false, "round outsides")] {
        let found = rounds(part, cut);
        if found.is_empty() {
            continue;
        }
        sheet.text(*row, 3.6, "start", &format!("{title}: number, diameter, {across}, {along}; {upright} from, to"));
        row[1] += LINE;
        for round in found.iter().take(MOST_ROWS) {
            number += 1;
            let [a, b, from, to] = [round.middle[0], round.middle[1], round.span[0], round.span[1]].map(hundredths);
            let diameter = 2e3 * round.radius;
            let told = format!("{number}   ⌀ {diameter:.2}   {a:.2}, {b:.2}   {from:.2} to {to:.2}");
            sheet.text(*row, 3.0, "start", &told);
            row[1] += LINE;
            if cut {
                sheet.text(put(round.middle), 2.0, "middle", &number.to_string());
            }
        }
        if found.len() > MOST_ROWS {
            sheet.text(*row, 3.0, "start", &format!("and {} more", found.len() - MOST_ROWS));
            row[1] += LINE;
        }
    }
    let levels: Vec<String> = levels(part).iter().map(|level| format!("{:.2}", hundredths(*level))).collect();
    sheet.text(*row, 3.6, "start", &format!("levels along {upright}"));
    for some in levels.chunks(10) {
        row[1] += LINE;
        sheet.text(*row, 3.0, "start", &some.join("  "));
    }
    row[1] += LINE;
}
