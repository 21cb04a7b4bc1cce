//! Tells the program where the MuJoCo library is, and the linker to compress what backtraces read.

#![allow(clippy::print_stdout, reason = "cargo reads it")]

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    // File names and lines are three quarters of the program; the standard library unpacks them when it needs them.
    if std::env::var("CARGO_CFG_TARGET_OS").is_ok_and(|os| os == "linux") {
        println!("cargo::rustc-link-arg=-Wl,--compress-debug-sections=zlib");
    }
    // Set by the build script of hwasp-mujoco, if that is built: Cargo hands link arguments to no other package.
    if let Ok(folder) = std::env::var("DEP_MUJOCO_RT_LIBDIR") {
        println!("cargo::rustc-link-arg=-Wl,-rpath,{folder}");
        // Beside the program, for one that is copied to another machine together with the library.
        println!("cargo::rustc-link-arg=-Wl,-rpath,$ORIGIN");
    }
}
