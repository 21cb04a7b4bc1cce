//! `hwasp graph`.

use hwasp_lab::Assembly;

use super::experiment;
use crate::Failure;
use crate::args::GraphArgs;

pub(crate) fn run(args: &GraphArgs) -> Result<(), Failure> {
    let spec = experiment(&args.experiment, &[])?;
    let assembly = Assembly::new(&spec)?;
    let (dot, svg) = (assembly.drawing().dot, assembly.drawing().svg);
    let Some(path) = &args.out else {
        print!("{dot}");
        return Ok(());
    };
    let text = match path.extension().and_then(|e| e.to_str()) {
        Some("svg") => svg,
        Some("dot" | "gv") => dot,
        _ => return Err(format!("{} ends neither in .svg nor in .dot", path.display()).into()),
    };
    std::fs::write(path, text).map_err(|e| format!("cannot write {}: {e}", path.display()))?;
    println!("{}", path.display());
    Ok(())
}
