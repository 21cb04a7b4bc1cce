//! `hwasp-bench [SETTINGS.json]`: arm, motor and hand as one process that speaks as they do. Without a file: a motor with
//! nothing on its spool. What it reads and writes: `docs/deploy_motor.md`.

use std::io::{self, Write};
use std::process::ExitCode;

use hwasp_emulators::bench::{BenchSettings, run_bench};

fn main() -> ExitCode {
    match serve() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            // There is nobody left to be told where this fails.
            let _untold = writeln!(io::stderr(), "hwasp-bench: {error}");
            ExitCode::FAILURE
        }
    }
}

fn serve() -> Result<(), Box<dyn std::error::Error>> {
    let settings = match std::env::args_os().nth(1) {
        None => BenchSettings::default(),
        Some(path) => {
            let text = std::fs::read_to_string(&path).map_err(|error| format!("{}: {error}", path.display()))?;
            BenchSettings::from_json(&text)?
        }
    };
    run_bench(settings.start()?, io::BufReader::new(io::stdin()), &mut io::stdout())?;
    Ok(())
}
