//! Tells the program where the MuJoCo library is.

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    // Set by the build script of hwasp-mujoco: Cargo hands link arguments to no other package.
    if let Ok(folder) = std::env::var("DEP_MUJOCO_RT_LIBDIR") {
        println!("cargo::rustc-link-arg=-Wl,-rpath,{folder}");
    }
}
