//! `hwasp play` where nothing can be drawn. What it draws is tested in `hwasp-report`, where there is an OpenGL to draw with.

use crate::sandbox::Sandbox;

#[test]
fn runs_without_grasps_and_folders_that_are_none() {
    let sandbox = Sandbox::with_run("play-reach");
    sandbox.write("file", "");
    insta::assert_snapshot!(sandbox.refused(&["play run", "play nowhere", "play file"]));
    assert!(!sandbox.path("run/play").exists());
}

#[cfg(all(feature = "mujoco", not(feature = "renderer")))]
#[test]
fn a_program_without_the_renderer_says_how_to_build_it() {
    let sandbox = Sandbox::new("play-z-grasp");
    let trained = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../results/z-grasp");
    std::fs::create_dir(sandbox.path("run")).unwrap();
    for name in ["experiment.toml", "policy.safetensors"] {
        std::fs::copy(trained.join(name), sandbox.path("run").join(name)).unwrap();
    }
    insta::assert_snapshot!(sandbox.refused(&["play run"]));
    assert!(!sandbox.path("run/play").exists());
}
