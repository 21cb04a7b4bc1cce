//! Tells the module where the MuJoCo library is.

#![allow(clippy::print_stdout, reason = "cargo reads it")]

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    // Set by the build script of hwasp-mujoco. A wheel brings the library along, and its maker writes that place instead.
    if let Ok(folder) = std::env::var("DEP_MUJOCO_RT_LIBDIR") {
        println!("cargo::rustc-link-arg-cdylib=-Wl,-rpath,{folder}");
    }
    // maturin gives the library in the module another name, in the file that Cargo keeps. So it gets one that is linked anew: there is
    // no file of this name, and Cargo takes that for a change.
    println!("cargo::rerun-if-env-changed=PYO3_CONFIG_FILE");
    if std::env::var("PYO3_CONFIG_FILE").is_ok_and(|file| file.contains("maturin")) {
        println!("cargo::rerun-if-changed=linked-anew-for-a-wheel");
    }
}
