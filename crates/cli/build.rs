//! Tells the program where the MuJoCo library is.

#![allow(clippy::print_stdout, reason = "cargo reads it")]

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    // Set by the build script of hwasp-mujoco, if that is built: Cargo hands link arguments to no other package.
    if let Ok(folder) = std::env::var("DEP_MUJOCO_RT_LIBDIR") {
        println!("cargo::rustc-link-arg=-Wl,-rpath,{folder}");
        // Beside the program, for one that is copied to another machine together with the library.
        println!("cargo::rustc-link-arg=-Wl,-rpath,$ORIGIN");
    }
}
