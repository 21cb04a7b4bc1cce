//! The engine reads the files that it is given, and none of the disk. A test of its own: the working directory belongs to the
//! process.

#![allow(clippy::unwrap_used)] // a panic is how a test fails

mod common;

use std::fs;

use common::{files, mesh};
use hwasp_mujoco::engine::Spec;

/// Every way to a file of the disk, each of which is there.
#[test]
fn nothing_else_is_read() {
    let folder = std::env::temp_dir().join(format!("hwasp-mujoco-files-{}", std::process::id()));
    for inner in ["meshes", "robots/meshes"] {
        fs::create_dir_all(folder.join(inner)).unwrap();
    }
    let floor = "<mujoco><worldbody><geom name='floor' type='plane' size='1 1 1'/></worldbody></mujoco>";
    for place in ["", "meshes", "robots", "robots/meshes"] {
        fs::write(folder.join(place).join("floor.xml"), floor).unwrap();
        for name in ["part.obj", "part.png", "part.skn", "part.hf"] {
            fs::write(folder.join(place).join(name), mesh(0.1)).unwrap();
        }
    }
    let absolute = folder.display();
    std::env::set_current_dir(&folder).unwrap();
    let escaped = format!("&#x2f;{}", absolute.to_string().trim_start_matches('/').replace('/', "&#47;"));
    let up = format!("{}{absolute}", "../".repeat(12));
    let refused = ["opening file", "not among the files", "No provider found"];
    let folders = [
        String::new(),
        "meshes/".to_owned(),
        "../".to_owned(),
        "../meshes/".to_owned(),
        "../robots/".to_owned(),
        "./x/../".to_owned(),
        format!("{absolute}/"),
        format!("{escaped}/"),
        format!("{up}/"),
        format!("{absolute}//meshes/./"),
        format!("file://{absolute}/"),
    ];
    for folder in &folders {
        let body = "<body><freejoint/><geom type='mesh' mesh='part'/></body>";
        for text in [
            format!("<mujoco><include file='{folder}floor.xml'/></mujoco>"),
            format!("<mujoco><include file='{folder}FLOOR.xml'/></mujoco>"),
            format!("<mujoco><asset><model name='m' file='{folder}floor.xml'/></asset></mujoco>"),
            format!("<mujoco><asset><mesh name='part' file='{folder}part.obj'/></asset><worldbody>{body}</worldbody></mujoco>"),
            format!("<mujoco><compiler meshdir='{folder}'/><asset><mesh file='part.obj'/></asset><worldbody>{body}</worldbody></mujoco>"),
            format!("<mujoco><compiler assetdir='{folder}'/><asset><mesh file='part.obj'/></asset><worldbody>{body}</worldbody></mujoco>"),
            format!("<mujoco><asset><hfield name='h' file='{folder}part.png' size='1 1 1 1'/></asset></mujoco>"),
            format!("<mujoco><asset><skin name='s' file='{folder}part.skn'/></asset></mujoco>"),
            format!("<mujoco><asset><texture type='2d' name='t' file='{folder}part.png'/></asset></mujoco>"),
            format!("<mujoco><asset><texture type='cube' name='t' fileright='{folder}part.png'/></asset></mujoco>"),
            format!("<mujoco><worldbody><flexcomp name='f' type='mesh' file='{folder}part.obj' dim='2'/></worldbody></mujoco>"),
            format!(
                "<robot name='r'><link name='l'><collision><geometry><mesh filename='{folder}part.obj'/></geometry></collision>
                 </link></robot>"
            ),
            format!("<mujoco><asset><model name='m' file='{folder}box.zip/floor.xml'/></asset></mujoco>"),
        ] {
            // The names exist elsewhere in the set, which must not help.
            let files = files(&[("robots/model.xml", &text), ("elsewhere/floor.xml", floor), ("elsewhere/part.png", "")]);
            let error = Spec::parse("robots/model.xml", &files).and_then(|mut spec| spec.compile()).expect_err(&text);
            let message = error.to_string();
            assert!(refused.iter().any(|words| message.contains(words)), "{text}: {message}");
            assert!(!message.contains("model-"), "the folder of the mount is nobody's business: {message}");
        }
    }
    std::env::set_current_dir("/").unwrap();
    fs::remove_dir_all(&folder).unwrap();
}
