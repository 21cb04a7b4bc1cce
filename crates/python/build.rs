//! Tells the module where the MuJoCo library is.

#![allow(clippy::print_stdout, reason = "cargo reads it")]

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    // Set by the build script of hwasp-mujoco. A wheel brings the library along, and its maker writes that place instead.
    if let Ok(folder) = std::env::var("DEP_MUJOCO_RT_LIBDIR") {
        println!("cargo::rustc-link-arg-cdylib=-Wl,-rpath,{folder}");
    }
}
