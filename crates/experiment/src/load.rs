//! Experiments that come with the problems of a catalogue, and files.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;
use std::sync::Arc;

use hwasp_settings::text::shorten;
use hwasp_settings::{Faults, Folder, LONGEST_FILE, Layers, listed, nearest};

use crate::catalogue::Catalogue;

/// What the experiment in a run folder is called.
pub const EXPERIMENT: &str = "experiment.toml";

/// An experiment by its name, or the file at a path (anything that ends in `.toml` or exists).
pub fn load(name_or_path: &str, catalogue: &Catalogue) -> Result<Layers, Faults> {
    let presets = catalogue.presets();
    if let Some(preset) = presets.iter().find(|preset| preset.name == name_or_path) {
        let files = preset.files.iter().map(|(path, text)| ((*path).to_owned(), Arc::from(text.as_bytes())));
        return Ok(Layers::from_text(preset.name, preset.text)?.with_folder(Folder::Sent(Arc::new(files.collect()))));
    }
    let names = || presets.iter().map(|preset| preset.name);
    let path = Path::new(name_or_path);
    let is_toml = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("toml"));
    if !is_toml && !path.exists() {
        let message = format!("there is neither an experiment nor a file `{}`", shorten(name_or_path, 120));
        let mut hint = format!("the experiments are {}; files end in .toml", listed(names()));
        let file = format!("{name_or_path}.toml");
        if Path::new(&file).is_file() {
            hint = format!("did you mean the file `{}`? {hint}", shorten(&file, 120));
        } else if let Some(near) = nearest(name_or_path, names()) {
            hint = format!("did you mean `{near}`? {hint}");
        }
        return Err(Faults::single(name_or_path, message, Some(hint)));
    }
    let bytes = read(path).map_err(|error| unreadable(name_or_path, &error, names()))?;
    match String::from_utf8(bytes) {
        Ok(text) => {
            let folder = path.parent().unwrap_or(Path::new(""));
            let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
            Ok(Layers::from_text(name_or_path, &text)?.with_folder(Folder::Disk(folder.to_owned())))
        }
        Err(error) => {
            let valid = &error.as_bytes()[..error.utf8_error().valid_up_to()];
            let line = valid.split(|&byte| byte == b'\n').count();
            let hint = "an experiment is a text in TOML, saved as UTF-8".to_owned();
            Err(Faults::single(name_or_path, format!("line {line} is no UTF-8 text"), Some(hint)))
        }
    }
}

/// What to say of a path that is no file to read.
fn unreadable<'n>(name: &str, error: &io::Error, names: impl Iterator<Item = &'n str>) -> Faults {
    let path = Path::new(name);
    if path.is_dir() {
        let file = path.join(EXPERIMENT);
        let hint = if file.is_file() {
            format!("the experiment of this run is {}", shorten(&file.display().to_string(), 120))
        } else {
            "name a file, or an experiment of `hwasp list`".into()
        };
        return Faults::single(name, "this is a folder, where an experiment is a file".into(), Some(hint));
    }
    let stem = path.file_stem().and_then(|stem| stem.to_str()).unwrap_or_default();
    let hint = match nearest(stem, names) {
        Some(near) if !path.exists() => format!("`{near}` without .toml comes with the program"),
        _ => "see that the path is right and that you may read it".into(),
    };
    Faults::single(name, format!("the file cannot be read: {error}"), Some(hint))
}

/// A file's bytes, at most one more than may be; the length is refused where the text is read.
fn read(path: &Path) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    File::open(path)?.take(LONGEST_FILE as u64 + 1).read_to_end(&mut bytes)?;
    Ok(bytes)
}
