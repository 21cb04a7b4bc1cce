//! Projects of one's own: what is written. That they build, pass their tests and train is shown by the example `template_plant`
//! and by `.ci/run`.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::sandbox::Sandbox;

/// The root of this repository, in whose target folder the program lies.
fn root() -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize().unwrap().to_str().unwrap().to_owned()
}

/// Every file below a folder, by its path there.
fn files(folder: &Path) -> Vec<String> {
    fn visit(folder: &Path, root: &Path, found: &mut Vec<String>) {
        for entry in fs::read_dir(folder).unwrap().map(Result::unwrap) {
            let path = entry.path();
            if path.is_dir() {
                visit(&path, root, found);
            } else {
                found.push(path.strip_prefix(root).unwrap().to_str().unwrap().to_owned());
            }
        }
    }
    let mut found = Vec::new();
    visit(folder, folder, &mut found);
    found.sort();
    found
}

#[test]
fn a_project_says_what_it_is_and_what_to_do_next() {
    let sandbox = Sandbox::new("init");
    let told = sandbox.transcript(&[
        &format!("init lamp --path {}", root()),
        &format!("init --template mjcf --name desk-lamp in/mjcf --path {}", root()),
    ]);
    insta::assert_snapshot!(told.replace(&root(), "CHECKOUT"));
    let manifest = String::from_utf8(sandbox.read("lamp/Cargo.toml")).unwrap();
    insta::assert_snapshot!("the_manifest_of_a_project", manifest.replace(&root(), "CHECKOUT"));
    let listed = |name: &str| files(&sandbox.path(name)).join("\n");
    insta::assert_snapshot!("the_files_of_a_project", format!("{}\n\n{}", listed("lamp"), listed("in/mjcf")));
}

#[test]
fn nothing_is_left_open_in_its_files() {
    let sandbox = Sandbox::new("init-files");
    for template in ["plant", "mjcf"] {
        assert!(sandbox.run(&format!("init --template {template} {template} --path {}", root())).status.success());
        for file in files(&sandbox.path(template)) {
            let text = String::from_utf8(sandbox.read(&format!("{template}/{file}"))).unwrap();
            assert!(!text.contains("{{"), "{template}/{file} has a place that is not filled:\n{text}");
        }
    }
    // A model that the engine refuses is an error there.
    for (template, arm) in [("plant", "Arm::default()"), ("mjcf", "Arm::new()?")] {
        for file in ["main.rs", "spring.rs"] {
            let text = String::from_utf8(sandbox.read(&format!("{template}/src/{file}"))).unwrap();
            assert_eq!(text.matches("Arm::").count(), text.matches(arm).count(), "{template}: {text}");
            assert!(text.contains(arm), "{template}: {text}");
        }
    }
}

/// The tests of a project named the lamp throughout, and had to be written anew at the first change; and the law said nothing of
/// branches, for which the compiler's advice leads nowhere (`new_problem.rs` tries what it says now).
#[test]
fn what_a_project_is_changed_by_is_said_in_it() {
    let sandbox = Sandbox::new("init-changes");
    for template in ["plant", "mjcf"] {
        assert!(sandbox.run(&format!("init --template {template} {template} --path {}", root())).status.success());
        let read = |file: &str| String::from_utf8(sandbox.read(&format!("{template}/src/{file}"))).unwrap();
        let tests = read("tests.rs");
        let code = tests.lines().filter(|line| !line.trim_start().starts_with("//"));
        let naming: Vec<&str> = code.filter(|line| line.to_lowercase().contains("lamp")).collect();
        assert_eq!(naming, ["use crate::Lamp as Own;"], "{template}");
        let law = read("spring.rs");
        for said in
            ["it must not branch on values", "the compiler's advice, `T: PartialOrd`, leads", "| instead of | write |"]
        {
            assert!(law.contains(said), "{template}: {said}");
        }
    }
}

/// Addresses on the network stood in manifests at which this program never was.
#[test]
fn no_manifest_has_an_address_that_nobody_checked() {
    let root = PathBuf::from(root());
    let below = |folder: &str| fs::read_dir(root.join(folder)).unwrap().map(|entry| entry.unwrap().path());
    let mut manifests = vec![root.join("Cargo.toml"), root.join("fuzz/Cargo.toml")];
    manifests.extend(below("crates").map(|folder| folder.join("Cargo.toml")).filter(|file| file.is_file()));
    manifests.extend(below("templates").map(|folder| folder.join("Cargo.toml.in")).filter(|file| file.is_file()));
    assert!(manifests.len() > 20, "{manifests:?}");
    for manifest in manifests {
        let text = fs::read_to_string(&manifest).unwrap();
        let keys = text.split(['\n', '{', ',']).filter_map(|entry| Some(entry.split_once('=')?.0.trim()));
        for key in keys {
            let key = key.split('.').next().unwrap();
            assert!(!["repository", "homepage", "git"].contains(&key), "{} has `{key}`", manifest.display());
        }
        assert!(!text.contains("://"), "{}", manifest.display());
    }
}

/// The lock file of a fresh project was that of the checkout, and `cargo build --locked` failed for it.
#[test]
fn a_fresh_project_is_locked() {
    let sandbox = Sandbox::new("init-locked");
    // With Cargo at hand, as whoever builds a project has it.
    let tools =
        || ["PATH", "HOME", "CARGO_HOME", "RUSTUP_HOME", "RUSTUP_TOOLCHAIN"].map(|key| (key, std::env::var_os(key)));
    let tools = || tools().into_iter().filter_map(|(key, value)| Some((key, value?)));
    for template in ["plant", "mjcf"] {
        let output = sandbox
            .command(&format!("init --template {template} {template} --path {}", root()))
            .envs(tools())
            .output()
            .unwrap();
        assert!(output.status.success() && output.stderr.is_empty(), "{}", String::from_utf8_lossy(&output.stderr));
        let mut cargo = Command::new(env!("CARGO"));
        // Of this platform: the crates of others need not be at hand.
        cargo.args(["tree", "--locked", "--offline"]);
        let output = cargo.current_dir(sandbox.path(template)).output().unwrap();
        assert!(output.status.success(), "{template}: {}", String::from_utf8_lossy(&output.stderr));
        // The versions are those that hwasp is tested with.
        let versions = |lock: &str| -> Vec<(String, String)> {
            let lock: toml::Table = lock.parse().unwrap();
            let package = |package: &toml::Value| {
                let text = |key: &str| package[key].as_str().unwrap().to_owned();
                (text("name"), text("version"))
            };
            lock["package"].as_array().unwrap().iter().map(package).collect()
        };
        let tested = versions(&fs::read_to_string(format!("{}/Cargo.lock", root())).unwrap());
        let own = versions(&String::from_utf8(sandbox.read(&format!("{template}/Cargo.lock"))).unwrap());
        assert!(own.len() > 50 && own.contains(&(template.to_owned(), "0.1.0".to_owned())));
        for package in own.iter().filter(|(name, _)| name != template) {
            assert!(tested.contains(package), "{package:?}");
        }
    }
}

/// Copies the program by a process of its own: a test that starts another program meanwhile would pass a file that is open for
/// writing on to it, and what is open for writing cannot be run.
fn copy_program(to: &Path) {
    assert!(Command::new("cp").arg(env!("CARGO_BIN_EXE_hwasp")).arg(to).status().unwrap().success());
}

/// An installed program wrote projects that were built from an address on the network at which hwasp never was.
#[test]
fn a_copy_of_the_program_elsewhere_asks_for_the_sources() {
    let sandbox = Sandbox::new("init-elsewhere");
    // Nothing above it is a checkout.
    let elsewhere = std::env::temp_dir().join(format!("hwasp-init-{}", std::process::id()));
    fs::create_dir_all(&elsewhere).unwrap();
    let program = elsewhere.join("hwasp");
    copy_program(&program);
    let run = |arguments: &[&str]| {
        Command::new(&program).args(arguments).current_dir(sandbox.path("")).env_clear().output().unwrap()
    };
    let output = run(&["init", "lamp"]);
    assert_eq!(output.status.code(), Some(2));
    assert_eq!(
        String::from_utf8_lossy(&output.stderr),
        "error: this program does not lie in a checkout of hwasp, and a project is built with hwasp's sources\n  = hint: name a \
         checkout with --path, such as --path ../hwasp\n"
    );
    assert!(!sandbox.path("lamp").exists());

    let root = root();
    assert!(run(&["init", "other", "--path", &root]).status.success());
    let manifest = String::from_utf8(sandbox.read("other/Cargo.toml")).unwrap();
    assert!(manifest.contains(&format!("path = \"{root}/crates/core\"")), "{manifest}");

    // In a checkout it finds the sources itself.
    let checkout = elsewhere.join("checkout");
    fs::create_dir_all(checkout.join("target")).unwrap();
    for name in ["crates", "Cargo.toml", "Cargo.lock"] {
        std::os::unix::fs::symlink(Path::new(&root).join(name), checkout.join(name)).unwrap();
    }
    let program = checkout.join("target/hwasp");
    copy_program(&program);
    let output =
        Command::new(&program).args(["init", "lamp"]).current_dir(sandbox.path("")).env_clear().output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let manifest = String::from_utf8(sandbox.read("lamp/Cargo.toml")).unwrap();
    assert!(manifest.contains(&format!("path = \"{}/crates/core\"", checkout.display())), "{manifest}");
    fs::remove_dir_all(&elsewhere).unwrap();
}

#[test]
fn a_folder_with_version_control_alone_is_empty() {
    let sandbox = Sandbox::new("init-git");
    fs::create_dir_all(sandbox.path("lamp/.git")).unwrap();
    let line = format!("init lamp --path {}", root());
    assert!(sandbox.run(&line).status.success());
    let again = sandbox.run(&line);
    assert_eq!(again.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&again.stderr).contains("lamp is not empty: it has .cargo, .gitignore"));
}
