//! Projects of one's own.

use std::fs;

use super::Given::{Made, Nothing};
use super::{Case, case};

pub(super) const CASES: &[Case] = &[
    case("No folder for a project", Nothing, "hwasp init"),
    case(
        "A project in a folder with files in it",
        Made(|s| {
            fs::create_dir(s.path("lamp")).unwrap();
            for name in ["precious", "a", "b", "c", "d", "e"] {
                s.write(&format!("lamp/{name}"), "");
            }
        }),
        "hwasp init lamp",
    ),
    case("A project in place of a file", Made(|s| s.write("file", "precious")), "hwasp init file"),
    case("A project in a file", Made(|s| s.write("file", "precious")), "hwasp init file/lamp"),
    case("A folder that names no package", Nothing, "hwasp init 2lamps"),
    case("A package of an impossible name", Nothing, "hwasp init lamp --name 'my lamp'"),
    case("A package named by a word of Rust", Nothing, "hwasp init lamp --name match"),
    case("A template that there is not", Nothing, "hwasp init lamp --template urdf"),
    case("A checkout that is none", Nothing, "hwasp init lamp --path ."),
];
