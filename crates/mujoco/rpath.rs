//! The build script of the crates above: tells their tests, examples and benchmarks where the MuJoCo library is.

#![allow(clippy::print_stdout, reason = "cargo reads it")]

fn main() {
    println!("cargo::rerun-if-changed=../mujoco/rpath.rs");
    // Set by the build script of hwasp-mujoco, if that is built: Cargo hands link arguments to no other package.
    if let Ok(folder) = std::env::var("DEP_MUJOCO_RT_LIBDIR") {
        println!("cargo::rustc-link-arg=-Wl,-rpath,{folder}");
    }
}
