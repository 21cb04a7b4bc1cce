//! The files of a model: the model itself, and what it includes and refers to.

use std::collections::BTreeMap;
use std::sync::Arc;

use hwasp_settings::{Files, Folder, FolderError, inside};
use roxmltree::{Document, Node, ParsingOptions};

/// The largest model file, bytes.
const LARGEST_MODEL: u64 = 16 << 20;
/// The largest mesh or texture, bytes.
const LARGEST_ASSET: u64 = 64 << 20;
/// The most bytes of all files together.
const LARGEST: u64 = 256 << 20;
/// The most files.
const MOST_FILES: usize = 500;
/// How deep files may include each other.
const DEEPEST: usize = 20;

/// A fault of a model's files, and a way out.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct SourceFault {
    pub(crate) message: String,
    pub(crate) hint: String,
}

impl From<FolderError> for SourceFault {
    fn from(error: FolderError) -> Self {
        Self { message: error.to_string(), hint: error.hint() }
    }
}

/// Reads a model and everything that it names. Paths in the result are relative to the folder.
pub(crate) fn gather(folder: &Folder, model: &str) -> Result<Files, SourceFault> {
    let main = inside(model).ok_or_else(|| FolderError::Outside { path: model.to_owned() })?;
    let mut gather = Gather {
        folder,
        files: BTreeMap::new(),
        bytes: 0,
        assets: Vec::new(),
        directories: Directories::default(),
        open: Vec::new(),
    };
    gather.model(&main, base_of(&main), 0)?;
    for (kind, file) in std::mem::take(&mut gather.assets) {
        let path = gather.directories.path(base_of(&main), kind, &file);
        gather.read(&path, LARGEST_ASSET, &main)?;
    }
    Ok(gather.files)
}

/// The folder part of a path, with its slash.
fn base_of(path: &str) -> &str {
    path.rfind('/').map_or("", |at| &path[..=at])
}

/// What an asset is: where it is looked for depends on it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Asset {
    Mesh,
    Texture,
}

/// `compiler`'s directories.
#[derive(Clone, Debug, Default)]
struct Directories {
    mesh: Option<String>,
    texture: Option<String>,
    strip: bool,
}

impl Directories {
    fn take(&mut self, compiler: Node<'_, '_>) {
        if let Some(both) = compiler.attribute("assetdir") {
            (self.mesh, self.texture) = (Some(both.to_owned()), Some(both.to_owned()));
        }
        if let Some(mesh) = compiler.attribute("meshdir") {
            self.mesh = Some(mesh.to_owned());
        }
        if let Some(texture) = compiler.attribute("texturedir") {
            self.texture = Some(texture.to_owned());
        }
        if let Some(strip) = compiler.attribute("strippath") {
            self.strip = strip == "true";
        }
    }

    fn path(&self, base: &str, kind: Asset, file: &str) -> String {
        let file = if self.strip { file.rsplit(['/', '\\']).next().unwrap_or(file) } else { file };
        let directory = if kind == Asset::Mesh { &self.mesh } else { &self.texture };
        match directory.as_deref().map(|directory| directory.trim_end_matches('/')) {
            None | Some("" | ".") => format!("{base}{file}"),
            Some(directory) => format!("{base}{directory}/{file}"),
        }
    }
}

struct Gather<'f> {
    folder: &'f Folder,
    files: Files,
    bytes: u64,
    assets: Vec<(Asset, String)>,
    directories: Directories,
    /// The files that are being read, each of which includes the next.
    open: Vec<String>,
}

impl Gather<'_> {
    /// Reads a model file and what it includes. Paths in it are relative to the main file's folder, `base`.
    fn model(&mut self, path: &str, base: &str, depth: usize) -> Result<(), SourceFault> {
        if depth > DEEPEST {
            let message = format!("`{path}` is included more than {DEEPEST} files deep");
            return Err(SourceFault { message, hint: "put what they include into fewer files".to_owned() });
        }
        let bytes = self.read(path, LARGEST_MODEL, path)?;
        let text = std::str::from_utf8(&bytes).map_err(|_| SourceFault {
            message: format!("`{path}` is no text"),
            hint: "a model is MJCF or URDF, in XML".to_owned(),
        })?;
        let options = ParsingOptions { allow_dtd: false, nodes_limit: 1_000_000, ..ParsingOptions::default() };
        let document = Document::parse_with_options(text, options).map_err(|error| SourceFault {
            message: format!("`{path}` is no XML: {error}"),
            hint: "a model is MJCF or URDF, in XML".to_owned(),
        })?;
        let root = document.root_element();
        if depth == 0 && !matches!(root.tag_name().name(), "mujoco" | "robot") {
            return Err(SourceFault {
                message: format!("`{path}` begins with <{}>", root.tag_name().name()),
                hint: "a model in MJCF begins with <mujoco>, in URDF with <robot>".to_owned(),
            });
        }
        let mut included = Vec::new();
        for node in root.descendants().filter(Node::is_element) {
            let file = node.attribute("file").or_else(|| node.attribute("filename"));
            match (node.tag_name().name(), file) {
                ("compiler", _) => self.directories.take(node),
                ("include" | "model", Some(file)) => included.push(format!("{base}{file}")),
                ("mesh" | "hfield" | "skin" | "flexcomp", Some(file)) => self.asset(Asset::Mesh, file),
                ("texture", Some(file)) => self.asset(Asset::Texture, file),
                ("texture", None) => {
                    let sides = ["fileright", "fileleft", "fileup", "filedown", "filefront", "fileback"];
                    sides
                        .iter()
                        .filter_map(|side| node.attribute(*side))
                        .for_each(|file| self.asset(Asset::Texture, file));
                }
                _ => {}
            }
        }
        self.open.push(path.to_owned());
        for path in included {
            let inside = inside(&path).ok_or(FolderError::Outside { path })?;
            if let Some(at) = self.open.iter().position(|open| *open == inside) {
                let circle: Vec<&str> = self.open[at..].iter().chain([&inside]).map(String::as_str).collect();
                return Err(SourceFault {
                    message: format!("`{inside}` includes itself: {}", circle.join(", ")),
                    hint: "take the last of these inclusions out of its file".to_owned(),
                });
            }
            if !self.files.contains_key(&inside) {
                self.model(&inside, base, depth + 1)?;
            }
        }
        self.open.pop();
        Ok(())
    }

    fn asset(&mut self, kind: Asset, file: &str) {
        // URDF names packages of ROS: the part behind the package's name is looked for beside the model.
        let file =
            file.strip_prefix("package://").map_or(file, |rest| rest.split_once('/').map_or(rest, |(_, rest)| rest));
        self.assets.push((kind, file.to_owned()));
    }

    fn read(&mut self, path: &str, most: u64, named_by: &str) -> Result<Arc<[u8]>, SourceFault> {
        let inside = inside(path).ok_or_else(|| FolderError::Outside { path: path.to_owned() })?;
        if let Some(bytes) = self.files.get(&inside) {
            return Ok(Arc::clone(bytes));
        }
        let bytes = self.folder.read(&inside, most).map_err(|error| {
            let mut fault = SourceFault::from(error);
            if inside != named_by {
                fault.message = format!("{}, which {named_by} names", fault.message);
            }
            fault
        })?;
        self.bytes += bytes.len() as u64;
        if self.files.len() >= MOST_FILES || self.bytes > LARGEST {
            return Err(SourceFault {
                message: format!("{named_by} names more than {MOST_FILES} files or {} MiB", LARGEST >> 20),
                hint: "leave out what is only to be looked at, or take coarser meshes".to_owned(),
            });
        }
        self.files.insert(inside, Arc::clone(&bytes));
        Ok(bytes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sent(files: &[(&str, &str)]) -> Folder {
        let file = |(path, text): &(&str, &str)| ((*path).to_owned(), Arc::from(text.as_bytes()));
        Folder::Sent(Arc::new(files.iter().map(file).collect()))
    }

    fn names(folder: &Folder, model: &str) -> Result<Vec<String>, String> {
        gather(folder, model).map(|files| files.into_keys().collect()).map_err(|fault| fault.message)
    }

    /// Meshes and textures are looked for where the compiler's settings say, which an included file may say, too.
    #[test]
    fn what_a_model_names_is_found() {
        let folder = sent(&[
            (
                "robots/a.xml",
                r#"<mujoco><include file="parts/common.xml"/><asset><mesh file="arm.stl"/></asset></mujoco>"#,
            ),
            (
                "robots/parts/common.xml",
                r#"<mujoco><compiler meshdir="m/" texturedir="."/><asset><texture file="t.png"/></asset></mujoco>"#,
            ),
            ("robots/m/arm.stl", "solid"),
            ("robots/t.png", "png"),
            ("else.txt", ""),
        ]);
        assert_eq!(
            names(&folder, "robots/a.xml").unwrap(),
            ["robots/a.xml", "robots/m/arm.stl", "robots/parts/common.xml", "robots/t.png"]
        );
    }

    #[test]
    fn what_is_missing_or_outside_is_told() {
        let one = |text: &str| names(&sent(&[("a.xml", text)]), "a.xml").unwrap_err();
        assert_eq!(
            one(r#"<mujoco><asset><mesh file="x.stl"/></asset></mujoco>"#),
            "there is no file `x.stl`, which a.xml names"
        );
        assert_eq!(
            one(r#"<mujoco><include file="../../etc/passwd"/></mujoco>"#),
            "`../../etc/passwd` is not inside of the experiment's folder"
        );
        assert!(one("<mujoco>").starts_with("`a.xml` is no XML"));
        assert_eq!(one("<html/>"), "`a.xml` begins with <html>");
        assert!(names(&sent(&[]), "a.xml").unwrap_err().contains("no file `a.xml`"));
        assert!(names(&Folder::Nowhere, "a.xml").unwrap_err().contains("no folder"));
    }

    /// A file that includes itself was read once, and the engine said something else of it.
    #[test]
    fn a_circle_of_files_is_told() {
        let include = |file: &str| format!("<mujoco><include file=\"{file}\"/></mujoco>");
        let told = |files: &[(&str, &str)]| names(&sent(files), "a.xml").unwrap_err();
        assert_eq!(told(&[("a.xml", &include("a.xml"))]), "`a.xml` includes itself: a.xml, a.xml");
        let (a, b, c) = (include("b.xml"), include("c.xml"), include("b.xml"));
        assert_eq!(
            told(&[("a.xml", &a), ("b.xml", &b), ("c.xml", &c)]),
            "`b.xml` includes itself: b.xml, c.xml, b.xml"
        );
    }
}
