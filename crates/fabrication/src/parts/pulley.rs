//! Pulleys: a groove between two flanges.

use super::{Layout, between, is_distal};
use crate::solid::{Layer, disc};

/// The pulley of a kind of joint, for a line that lies `radius`, m, from its axle, from line's centre to axle's. The one of a
/// distal joint is pinned to its link, and the line ends in it.
pub(super) fn layers(kind: usize, radius: f64, layout: &Layout<'_>) -> Vec<Layer> {
    let (groove, half) = (layout.groove(), layout.pulley());
    between(vec![-half, -groove, groove, half], |x| {
        let mut cut = vec![disc([0.0, 0.0], layout.bore())];
        let outer = if x.abs() < groove {
            layout.groove_bottom(radius)
        } else if is_distal(kind) && x < 0.0 {
            cut.extend(pins(layout).map(|pin| disc(pin, layout.pin_hole())));
            cut.push(disc([0.0, -layout.line_end(kind, radius)], layout.line_hole()));
            layout.pinned_rim(kind, radius)
        } else {
            layout.rim(radius)
        };
        (vec![disc([0.0, 0.0], outer)], cut)
    })
}

/// Where the pins between pulley and link are.
pub(super) fn pins(layout: &Layout<'_>) -> [[f64; 2]; 2] {
    [[-layout.pin_circle(), 0.0], [layout.pin_circle(), 0.0]]
}
