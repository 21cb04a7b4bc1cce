//! Parts that are joined have room wherever they go: sections of their meshes, laid over each other in 200 poses.

#![allow(clippy::unwrap_used)] // a panic is how a test fails

mod digits;
mod mount;
mod sections;

use hwasp_fabrication::SeatedSpring;

fn springs() -> [SeatedSpring; 4] {
    [(0.38e-3, 5.26e-3, 2.60e-3), (0.36e-3, 6.72e-3, 2.45e-3), (0.45e-3, 6.90e-3, 3.17e-3), (0.38e-3, 6.76e-3, 3.07e-3)]
        .map(|(wire, outer, length)| SeatedSpring { wire, outer, length })
}
