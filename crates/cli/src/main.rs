//! `hwasp`: design a robot's body and its controller together.

#![forbid(unsafe_code)]

fn main() -> std::process::ExitCode {
    hwasp_cli::run(&hwasp_builtin::catalogue())
}
