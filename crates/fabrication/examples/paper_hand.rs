//! Writes the package of the paper's hand (table 2) into a folder: `cargo run -p hwasp-fabrication --example paper_hand -- FOLDER`.

use std::error::Error;
use std::path::PathBuf;

use hwasp_fabrication::{FittedSpring, SeatedSpring, Workshop, package, parts, scad, step_files};
use hwasp_tasks::hand::{HandDescription, PAPER_HWASP};

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1).map_or_else(|| std::env::temp_dir().join("paper_hand"), PathBuf::from);
    std::fs::create_dir_all(&folder)?;
    let (hand, workshop) = (HandDescription::default(), Workshop::default());
    let seated = SeatedSpring { wire: 0.4e-3, outer: 6.4e-3, length: 3.0e-3 };
    let springs = [(); 4].map(|()| FittedSpring { part: "example".to_owned(), seated, stress_share: 0.7 });
    let write = |name: &str, contents: &[u8]| std::fs::write(folder.join(name), contents);
    for part in parts(&hand, &PAPER_HWASP, &[seated; 4], &workshop)? {
        write(&format!("{}.stl", part.name), &part.mesh.stl(part.name))?;
    }
    write("hand.scad", scad(&hand, &PAPER_HWASP, &[seated; 4], &workshop)?.as_bytes())?;
    let package = package(&hand, &PAPER_HWASP, &springs, &workshop, &[6; 4])?;
    for file in package.into_iter().chain(step_files(&hand, &PAPER_HWASP, &springs, &workshop)?) {
        write(&file.name, &file.contents)?;
    }
    Ok(())
}
