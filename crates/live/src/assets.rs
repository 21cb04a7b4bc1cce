//! The files of the page, which are in the program.

use crate::answer::Answer;

const HTML: &str = "text/html; charset=utf-8";
const SCRIPT: &str = "text/javascript; charset=utf-8";
const STYLE: &str = "text/css; charset=utf-8";

/// Paths, kinds and texts.
const FILES: [(&str, &str, &str); 11] = [
    ("/", HTML, include_str!("../page/index.html")),
    ("/style.css", STYLE, include_str!("../page/style.css")),
    ("/app.js", SCRIPT, include_str!("../page/app.js")),
    ("/words.js", SCRIPT, include_str!("../page/words.js")),
    ("/chart.js", SCRIPT, include_str!("../page/chart.js")),
    ("/panels.js", SCRIPT, include_str!("../page/panels.js")),
    ("/robot.js", SCRIPT, include_str!("../page/robot.js")),
    ("/icon.svg", "image/svg+xml", include_str!("../page/icon.svg")),
    ("/viewer.js", SCRIPT, hwasp_scene::VIEWER_JS),
    ("/viewer.css", STYLE, hwasp_scene::VIEWER_CSS),
    ("/server.js", SCRIPT, include_str!("../page/server.js")),
];

/// The file at a path.
pub(crate) fn file(path: &str) -> Option<Answer> {
    FILES.iter().find(|file| file.0 == path).map(|&(_, kind, text)| Answer::file(kind, text))
}
