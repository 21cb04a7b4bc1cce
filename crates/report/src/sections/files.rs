//! What else lies in the run folder: pictures, exports, parts, films, each with a link.

use std::path::Path;

use maud::{Markup, html};

use super::provenance::command;
use crate::page::Section;
use crate::run::Run;

/// Folders that commands write into a run, what makes them, and what is in them.
const FOLDERS: [(&str, &str, &str); 3] = [
    ("export", "export", "the controller for a robot, and the mechanism to print and to simulate"),
    ("build", "parts", "parts to buy, tolerances, the sheet for the bench"),
    ("play", "play", "films"),
];
/// What is built, of what is no hand.
const TOLERANCES: (&str, &str, &str) = ("build", "tolerances", "which part has to be precise");
/// The most files of a folder that are listed.
const MOST: usize = 60;

pub(crate) fn section(run: &Run) -> Section {
    let own = files(&run.path, "");
    let folders = if run.design.hand.is_some() { FOLDERS } else { [FOLDERS[0], TOLERANCES, FOLDERS[2]] };
    let body = html! {
        p { "Links lead from this page to the run folder " code { (run.path.display()) } ": they hold where both lie as they do now." }
        (list(run, "The run", &own))
        @for (folder, made_by, about) in folders {
            @let found = files(&run.path, folder);
            @if found.is_empty() {
                div.part {
                    h3 { code { (folder) "/" } }
                    p { "Not there yet: " (about) ". What makes it:" }
                    (command(&format!("hwasp {made_by} {}", run.typed_path())))
                }
            } @else {
                (list(run, &format!("{folder}/: {about}"), &found))
            }
        }
    };
    Section { id: "files", title: "Files", body }
}

/// The files of a folder of the run and their bytes, by name; pages that lie with them, this one for one, are left out.
fn files(run: &Path, folder: &str) -> Vec<(String, u64)> {
    let read = std::fs::read_dir(run.join(folder));
    let named = |entry: std::fs::DirEntry| {
        let (name, about) = (entry.file_name().into_string().ok()?, entry.metadata().ok()?);
        let page = Path::new(&name).extension().is_some_and(|extension| extension == "html");
        let own = name.starts_with('.') || (folder.is_empty() && page);
        let path = if folder.is_empty() { name } else { format!("{folder}/{name}") };
        (about.is_file() && !own).then_some((path, about.len()))
    };
    let mut files: Vec<(String, u64)> = read.into_iter().flatten().flatten().filter_map(named).collect();
    files.sort();
    files
}

fn list(run: &Run, caption: &str, files: &[(String, u64)]) -> Markup {
    html! {
        table {
            caption { (caption) }
            thead { tr { th scope="col" { "file" } th.n scope="col" { "size" } } }
            tbody {
                @for (path, bytes) in files.iter().take(MOST) {
                    tr { th scope="row" { a href=(run.link(path)) { (path) } } td.n { (size(*bytes)) } }
                }
                @if files.len() > MOST { tr { th scope="row" { "… and " (files.len() - MOST) " more" } td.n { "–" } } }
            }
        }
    }
}

fn size(bytes: u64) -> String {
    match bytes {
        0..1000 => format!("{bytes} B"),
        1000..1_000_000 => format!("{:.1} kB", bytes as f64 / 1e3),
        _ => format!("{:.1} MB", bytes as f64 / 1e6),
    }
}
