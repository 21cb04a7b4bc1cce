//! Pulleys: a groove between two flanges.

use super::super::solid::{Layer, disc};
use super::{Stock, between};

/// A pulley for a line that lies `radius`, m, from its shaft, from line's centre to shaft's. The one of a distal joint is pinned
/// to its link, and the line ends in it.
pub(super) fn layers(radius: f64, distal: bool, stock: &Stock) -> Vec<Layer> {
    let rim = stock.rim(radius);
    let (groove, half) = (stock.groove(), stock.pulley());
    between(vec![-half, -groove, groove, half], |x| {
        let mut cut = vec![disc([0.0, 0.0], stock.bore())];
        let outer = if x.abs() < groove {
            stock.groove_bottom(radius)
        } else if distal && x < 0.0 {
            cut.extend(pins(stock).map(|pin| disc(pin, stock.leg_hole())));
            cut.push(disc([0.0, stock.line_end(radius)], stock.line_hole()));
            rim.max(stock.leg_circle() + stock.leg_hole() + stock.wall)
        } else {
            rim
        };
        (vec![disc([0.0, 0.0], outer)], cut)
    })
}

/// Where the pins between pulley and link are.
pub(super) fn pins(stock: &Stock) -> [[f64; 2]; 2] {
    [[-stock.leg_circle(), 0.0], [stock.leg_circle(), 0.0]]
}
