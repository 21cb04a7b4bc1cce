//! Fetches the MuJoCo library into the target folder, once, and tells the linker where it is.
//!
//! The library is a file of the wheel `mujoco==3.17.0`: `pip` downloads it, checks its hash (`link/requirements.txt`) and
//! knows the proxies and mirrors of this machine. `MUJOCO_LIB_DIR` names a folder with a copy of one's own instead.

#![allow(clippy::print_stdout, reason = "cargo reads it")]

use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};
use std::time::{Duration, SystemTime};

const VERSION: &str = "3.17.0";
const LIBRARY: &str = "libmujoco.so.3.17.0";
const LIB_DIR_VARIABLE: &str = "MUJOCO_LIB_DIR";

/// What to do instead, below every failure.
const WAYS_OUT: &str = "Other ways:
- set MUJOCO_LIB_DIR to the absolute path of a folder that holds libmujoco.so.3.17.0, of MuJoCo 3.17.0;
- build the program without the engine and the problems that need it: cargo build --release --no-default-features";

fn main() -> ExitCode {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-changed=link");
    println!("cargo::rerun-if-env-changed={LIB_DIR_VARIABLE}");
    match library_folder().and_then(|folder| Ok((link_here(&folder)?, folder))) {
        Ok((here, folder)) => {
            let folder = folder.display();
            // A library that has been deleted is fetched again.
            println!("cargo::rerun-if-changed={folder}/{LIBRARY}");
            println!("cargo::rustc-link-search=native={}", here.display());
            // For programs that Cargo does not start. Link arguments do not reach other packages; they read the metadata.
            println!("cargo::rustc-link-arg=-Wl,-rpath,{folder}");
            println!("cargo::metadata=LIBDIR={folder}");
            ExitCode::SUCCESS
        }
        Err(message) => {
            for line in message.lines().chain(WAYS_OUT.lines()) {
                println!("cargo::error={line}");
            }
            ExitCode::FAILURE
        }
    }
}

/// The folder that holds [`LIBRARY`]: the person's own, or the one in the target folder, filled if need be.
fn library_folder() -> Result<PathBuf, String> {
    if let Some(folder) = std::env::var_os(LIB_DIR_VARIABLE).filter(|folder| !folder.is_empty()) {
        let folder = PathBuf::from(folder);
        // Build scripts and the program run in other folders than the person.
        if !folder.is_absolute() {
            return Err(format!("{LIB_DIR_VARIABLE} is {}, which is no absolute path.", folder.display()));
        }
        return if folder.join(LIBRARY).is_file() {
            Ok(folder)
        } else {
            Err(format!("{LIB_DIR_VARIABLE} is {}, but there is no file {LIBRARY} in it.", folder.display()))
        };
    }
    let architecture = variable("CARGO_CFG_TARGET_ARCH")?;
    let system = variable("CARGO_CFG_TARGET_OS")?;
    if system != "linux" || !matches!(architecture.as_str(), "x86_64" | "aarch64") {
        return Err(format!(
            "The MuJoCo engine is fetched for Linux on x86_64 and aarch64; this build is for {system} on {architecture}."
        ));
    }
    let folder = target_folder()?.join(format!("mujoco-{VERSION}-{architecture}"));
    if !folder.join(LIBRARY).is_file() {
        fetch(&folder, &architecture)?;
    }
    Ok(folder)
}

/// Links the library of `folder` into this script's own folder. Cargo lets the programs that it starts, the tests of every
/// crate among them, search there for libraries.
fn link_here(folder: &Path) -> Result<PathBuf, String> {
    let here = PathBuf::from(variable("OUT_DIR")?);
    let link = here.join(LIBRARY);
    // What an earlier build left may be another library.
    let _ = fs::remove_file(&link);
    fs::hard_link(folder.join(LIBRARY), &link)
        .or_else(|_| fs::copy(folder.join(LIBRARY), &link).map(drop))
        .map_err(|error| format!("{} cannot be written: {error}.", link.display()))?;
    Ok(here)
}

/// The folder above all profiles, so that debug and release builds share one library. `OUT_DIR` is
/// `<target>/[<triple>/]<profile>/build/…`.
fn target_folder() -> Result<PathBuf, String> {
    let out = PathBuf::from(variable("OUT_DIR")?);
    let above_profile = out
        .ancestors()
        .find(|folder| folder.file_name().is_some_and(|name| name == "build"))
        .and_then(|build| build.parent()?.parent())
        .ok_or_else(|| format!("OUT_DIR is {}, which is not laid out as Cargo's target folder.", out.display()))?;
    let triple = variable("TARGET")?;
    let of_triple = above_profile.file_name().is_some_and(|name| name == triple.as_str());
    Ok(above_profile.parent().filter(|_| of_triple).unwrap_or(above_profile).to_path_buf())
}

/// Downloads the wheel and moves the library in it to `folder`.
///
/// Two builds may do so at once: each works in a folder of its own, and the last step is a rename.
fn fetch(folder: &Path, architecture: &str) -> Result<(), String> {
    let scratch = folder.join(format!("fetching-{}", std::process::id()));
    let at = |error: io::Error| format!("{} cannot be written: {error}.", scratch.display());
    fs::create_dir_all(&scratch).map_err(at)?;
    let result = download(&scratch, architecture)
        .and_then(|()| unpack(&scratch))
        .and_then(|library| install(&library, &folder.join(LIBRARY)).map_err(at));
    // What is left there is of no use to anyone, and harmless if it stays.
    let _ = fs::remove_dir_all(&scratch);
    result
}

/// Lets pip download the wheel into `scratch`, for the machine the program is built for, whatever Python runs here.
fn download(scratch: &Path, architecture: &str) -> Result<(), String> {
    run(
        Command::new("python3").args(["-m", "pip", "--version"]),
        "The MuJoCo engine is fetched with pip, which this python3 does not have. Install it (Debian, Ubuntu: apt install \
         python3-pip).",
    )?;
    run(
        Command::new("python3")
            .args(["-m", "pip", "download", "--no-input", "--disable-pip-version-check", "--progress-bar", "off"])
            .args(["--no-deps", "--only-binary", ":all:", "--implementation", "cp", "--python-version", "3.12"])
            .args(["--abi", "cp312", "--platform", &format!("manylinux_2_28_{architecture}")])
            .args(["--require-hashes", "--requirement"])
            .arg(Path::new(&variable("CARGO_MANIFEST_DIR")?).join("link/requirements.txt"))
            .arg("--dest")
            .arg(scratch),
        &format!(
            "pip could not download mujoco=={VERSION} (26 MB) from the Python package index. If this machine reaches the \
             network through a proxy or a mirror, tell pip so (HTTPS_PROXY, PIP_INDEX_URL) and build again."
        ),
    )
}

/// Unpacks the library from the wheel in `scratch` and returns where it is. A wheel is a zip archive, and Python reads them.
fn unpack(scratch: &Path) -> Result<PathBuf, String> {
    const SCRIPT: &str = "import glob, sys, zipfile
[wheel] = glob.glob(glob.escape(sys.argv[1]) + '/*.whl')
zipfile.ZipFile(wheel).extract(sys.argv[2], sys.argv[1])";
    let member = format!("mujoco/{LIBRARY}");
    run(
        Command::new("python3").args(["-c", SCRIPT]).arg(scratch).arg(&member),
        &format!("The wheel mujoco=={VERSION} could not be unpacked."),
    )?;
    Ok(scratch.join(member))
}

/// Moves the library to its place.
fn install(library: &Path, place: &Path) -> io::Result<()> {
    // Older than any build: Cargo would take a file that is newer than its build script's start for a change, and build
    // everything again.
    let long_ago = SystemTime::UNIX_EPOCH + Duration::from_secs(1_000_000_000);
    File::options().write(true).open(library)?.set_modified(long_ago)?;
    fs::rename(library, place)
}

/// Runs a command; where it fails, the error is `hint` and what the command said last.
fn run(command: &mut Command, hint: &str) -> Result<(), String> {
    let output = command.output().map_err(|error| match error.kind() {
        io::ErrorKind::NotFound => {
            "The MuJoCo engine is fetched with python3, which is not on the PATH. Install python3 \
                                    with pip (Debian, Ubuntu: apt install python3 python3-pip)."
                .to_owned()
        }
        _ => format!("python3 cannot be run: {error}."),
    })?;
    if output.status.success() {
        return Ok(());
    }
    let said = String::from_utf8_lossy(&output.stderr);
    let lines: Vec<&str> = said.lines().filter(|line| !line.trim().is_empty()).collect();
    let last = &lines[lines.len().saturating_sub(6)..];
    Err(format!("{hint}\npython3 ended with {}:\n  {}", output.status, last.join("\n  ")))
}

/// A variable that Cargo sets for build scripts.
fn variable(name: &str) -> Result<String, String> {
    std::env::var(name).map_err(|error| format!("{name} is not as Cargo sets it: {error}."))
}
