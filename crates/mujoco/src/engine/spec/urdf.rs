//! URDF models: their links and the files of their meshes.

use mujoco_rs::prelude::MjSpec;

use super::super::{BuildError, Files};

/// Keeps links that do not move as bodies of their own, so that they can be named, and finds the meshes: URDF names them
/// by packages (`package://arm/meshes/leg.stl`) or by absolute paths. The one file of the set whose path ends most like the
/// name is taken.
pub(super) fn adapt(spec: &mut MjSpec, main: &str, files: &Files) -> Result<(), BuildError> {
    spec.compiler_mut().set_fusestatic(false);
    let folder = format!("{}/{}", parts(main, 1).join("/"), spec.compiler().meshdir());
    for mesh in spec.mesh_iter_mut() {
        let name = mesh.file().to_owned();
        if name.is_empty() || files.get(&joined(&folder, &name)).is_some() {
            continue;
        }
        let message = match closest(&name, files)[..] {
            [path] => {
                // The engine takes paths from the folder of the meshes on.
                let up = "../".repeat(parts(&joined("", &folder), 0).len());
                mesh.set_file(&format!("{up}{path}"));
                continue;
            }
            [] => format!("the mesh `{name}` is not among the files of the model"),
            ref several => format!("the mesh `{name}` may be one of several files: {}", several.join(", ")),
        };
        return Err(BuildError::Model { file: main.to_owned(), line: None, message });
    }
    Ok(())
}

/// The files whose paths end with the most parts of the name.
fn closest<'f>(name: &str, files: &'f Files) -> Vec<&'f str> {
    let plain = name.split_once("://").map_or(name, |(_, path)| path);
    let wanted = parts(plain, 0);
    let shared = |path: &str| wanted.iter().rev().zip(path.split('/').rev()).take_while(|(a, b)| *a == b).count();
    let most = files.paths().map(shared).max().unwrap_or_default();
    if most == 0 { Vec::new() } else { files.paths().filter(|path| shared(path) == most).collect() }
}

/// The parts of a path that are more than `.`, but for some at its end.
fn parts(path: &str, less: usize) -> Vec<&str> {
    let mut parts: Vec<&str> = path.split(['/', '\\']).filter(|part| !matches!(*part, "" | ".")).collect();
    parts.truncate(parts.len().saturating_sub(less));
    parts
}

/// The path of a file in a folder, without `..`.
fn joined(folder: &str, file: &str) -> String {
    let mut path: Vec<&str> = Vec::new();
    for part in parts(folder, 0).into_iter().chain(parts(file, 0)) {
        if part == ".." {
            path.pop();
        } else {
            path.push(part);
        }
    }
    path.join("/")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn meshes_are_found_by_the_end_of_their_path() {
        let files =
            Files::new(["arm/meshes/leg.stl", "other/leg.stl", "meshes/arm.stl"].map(|path| (path, b"".as_slice())))
                .expect("plain paths");
        for (name, found) in [
            ("package://robot/meshes/leg.stl", vec!["arm/meshes/leg.stl"]),
            ("file:///home/me/other/leg.stl", vec!["other/leg.stl"]),
            ("leg.stl", vec!["arm/meshes/leg.stl", "other/leg.stl"]),
            ("arm.stl", vec!["meshes/arm.stl"]),
            ("foot.stl", vec![]),
            ("", vec![]),
        ] {
            assert_eq!(closest(name, &files), found, "{name}");
        }
        assert_eq!(joined("a/b", "../c/./d.stl"), "a/c/d.stl");
    }
}
