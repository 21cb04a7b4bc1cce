//! Reports: pages that hold everything and load nothing.

use std::fs;
use std::path::Path;

use crate::sandbox::{Sandbox, TINY};

/// Elements that have no end.
const VOID: [&str; 4] = ["meta", "br", "input", "!DOCTYPE"];

/// The report of a folder, which is well-formed and loads nothing.
fn report(sandbox: &Sandbox, folder: &str) -> String {
    let output = sandbox.run(&format!("report {folder} --out page.html"));
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert_eq!(output.stdout, b"page.html\n");
    let html = String::from_utf8(sandbox.read("page.html")).unwrap();
    assert!(html.len() < 500_000, "{} bytes", html.len());
    nested(&html);
    for loads in ["http:", "https:", " src=", "url(", "@import", "<link", "<img", "<iframe"] {
        assert!(!html.contains(loads), "{folder}: {loads}");
    }
    let hrefs: Vec<&str> = html.split("href=\"").skip(1).filter_map(|rest| rest.split('"').next()).collect();
    let there = |href: &str| !href.contains(':') && sandbox.path(href).is_file();
    assert!(hrefs.len() > 5 && hrefs.iter().all(|href| href.starts_with('#') || there(href)), "{folder}: {hrefs:?}");
    html
}

/// Every element is closed in the order in which it was opened; scripts and styles are taken as they are.
fn nested(html: &str) {
    let mut open: Vec<&str> = Vec::new();
    let mut rest = html;
    while let Some(start) = rest.find('<') {
        rest = &rest[start + 1..];
        let end = rest.find('>').expect("a tag ends");
        let (tag, after) = (&rest[..end], &rest[end + 1..]);
        rest = after;
        let name = tag.split([' ', '\n']).next().unwrap_or_default();
        if let Some(closed) = name.strip_prefix('/') {
            assert_eq!(open.pop(), Some(closed), "before {}", &rest[..rest.len().min(200)]);
        } else if !VOID.contains(&name) && !tag.ends_with('/') {
            if ["script", "style"].contains(&name) {
                let end = rest.find(&format!("</{name}>")).expect("it ends");
                rest = &rest[end + name.len() + 3..];
            } else {
                open.push(name);
            }
        }
    }
    assert!(open.is_empty(), "{open:?}");
}

/// The chapters, in their order.
fn chapters(html: &str) -> Vec<&str> {
    html.split("<section id=\"").skip(1).filter_map(|rest| rest.split('"').next()).collect()
}

/// A sandbox with the trained hand of results/ in the folder `hand`.
fn with_hand(name: &str) -> Sandbox {
    let sandbox = Sandbox::new(name);
    let trained = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../results/z-grasp");
    fs::create_dir(sandbox.path("hand")).unwrap();
    for file in ["experiment.toml", "design.toml", "policy.safetensors", "summary.json", "metrics.csv"] {
        fs::copy(trained.join(file), sandbox.path("hand").join(file)).unwrap();
    }
    sandbox
}

#[test]
fn every_problem_without_a_hand() {
    let sandbox = Sandbox::new("report-problems");
    for (experiment, said) in [
        ("mass-spring", "10 parallel springs"),
        ("bar-length", "What is built differs from what was trained, as the law says"),
        ("reach", "reach a goal"),
        ("pendulum", "swing it up"),
    ] {
        let train = "--env-steps 4000 --set train.evaluation_episodes=4 --quiet";
        assert!(sandbox.run(&format!("train {experiment} {train} --out {experiment}")).status.success());
        let html = report(&sandbox, experiment);
        let all = [
            "verdict",
            "optimised",
            "episode",
            "outcome",
            "curves",
            "design",
            "tolerances",
            "law",
            "provenance",
            "files",
        ];
        assert_eq!(chapters(&html), all, "{experiment}");
        for text in [
            said,
            "observed: ",
            "commanded: ",
            "hwasp tolerances",
            "experiment.toml --out again",
            "evaluation_episodes = 4",
            "Does it work?",
            "The task knows no success",
            "Not tested",
            &format!("href=\"{experiment}/policy.safetensors\""),
            "from above",
            "<dt>Trained</dt>",
        ] {
            assert!(html.contains(text), "{experiment}: {text}");
        }
        assert!(html.contains(&format!("hwasp train {experiment} {train} --out {experiment}")), "what was typed");
    }
}

#[test]
fn a_hand_with_and_without_parts() {
    let sandbox = with_hand("report-hand");
    let html = report(&sandbox, "hand");
    let all = [
        "verdict",
        "optimised",
        "episode",
        "outcome",
        "curves",
        "design",
        "mechanism",
        "parts",
        "tolerances",
        "law",
        "provenance",
        "files",
    ];
    assert_eq!(chapters(&html), all);
    for text in ["99.0\u{a0}%", "396 of 400", "Free closing", "hwasp parts hand", "has no <code>provenance.json</code>"]
    {
        assert!(html.contains(text), "{text}");
    }
    // It holds no clock and no chance.
    assert_eq!(html, report(&sandbox, "hand"));
    if !cfg!(feature = "mujoco") {
        assert!(html.contains("this program was built without it"));
        return;
    }
    assert!(html.contains("<figure class=\"player\"") && html.contains("raised 10 cm"));
    for text in [
        // The verdict, failures, the nearer world, the drawing, and what happens over time.
        "396 of 400 held-out episodes succeed",
        "falls shut",
        "None of the first 80 held-out episodes fails",
        "With native tendons 78 of the first 80",
        "pulley r 6.81 mm",
        "torque at the joints",
    ] {
        assert!(html.contains(text), "{text}");
    }
    assert_eq!(html.matches("<figure class=\"stills\">").count(), 4, "one for each shape");
    assert!(sandbox.run("parts hand --episodes 3").status.success());
    let html = report(&sandbox, "hand");
    for text in ["What the parts are worth", "on these parts", "groove ⌀"] {
        assert!(html.contains(text), "{text}");
    }
}

/// A page gave an evaluation of a handful of episodes the interval from the smallest to the largest of them.
#[test]
fn few_episodes_have_no_interval() {
    let sandbox = Sandbox::new("report-few");
    assert!(sandbox.run(&format!("{TINY} --set train.evaluation_episodes=3 --quiet --out run")).status.success());
    let html = report(&sandbox, "run");
    // Of the discounted and of the undiscounted return.
    assert_eq!(html.matches("<td class=\"n\">no interval</td>").count(), 2, "{html}");
}

#[test]
fn tolerances_are_shown_where_they_are() {
    let sandbox = Sandbox::with_run("report-tolerances");
    assert!(sandbox.run("tolerances run --episodes 4").status.success());
    let html = report(&sandbox, "run");
    assert!(html.contains("What errors of each parameter cost") && html.contains("±5 %"), "{html}");
}

#[test]
fn a_comparison() {
    let sandbox = Sandbox::new("report-comparison");
    let compare =
        "compare reach --methods hwasp,fixed:middle --seeds 2 --env-steps 2400 --set train.evaluation_episodes=4";
    assert!(sandbox.run(&format!("{compare} --quiet --out both")).status.success());
    let html = report(&sandbox, "both");
    assert_eq!(chapters(&html), ["winner", "compared", "curves", "table", "designs", "provenance"]);
    for text in
        ["fixed:middle (2 runs)", "has the best evaluation", "best known 1", "Probability of improvement", compare]
    {
        assert!(html.contains(text), "{text}");
    }
    fs::remove_file(sandbox.path("both/cells/hwasp-seed1/summary.json")).unwrap();
    let mut told = sandbox.refused(&["report both"]);
    sandbox.write("both/comparison.json", "{}");
    told.push_str(&sandbox.refused(&["report both"]));
    fs::remove_file(sandbox.path("both/comparison.json")).unwrap();
    told.push_str(&sandbox.refused(&["report both"]));
    insta::assert_snapshot!(told);
}

#[test]
fn names_from_strangers_are_text() {
    let sandbox = Sandbox::with_run("report-hostile");
    let evil = "</title><script>alert(1)</script><b onload='x'>&amp;";
    sandbox.forget_experiment();
    sandbox.replace("run/experiment.toml", "name = \"reach\"", &format!("name = \"{evil}\""));
    sandbox.replace("run/experiment.toml", "description = \"", "description = \"</p><img alt=x>");
    sandbox.replace("run/summary.json", "\"experiment\": \"reach\"", &format!("\"experiment\": \"{evil}\""));
    sandbox.replace("run/provenance.json", "\"train\",", "\"train\", \"</code><script>\",");
    let html = report(&sandbox, "run");
    assert_eq!(html.matches("<script").count(), 3, "those of the page, and the film's data");
    assert!(html.contains("&lt;/title&gt;&lt;script&gt;alert(1)&lt;/script&gt;") && !html.contains("<b "));
}

#[test]
fn where_it_is_written() {
    let sandbox = Sandbox::with_run("report-out");
    assert_eq!(sandbox.run("report run").stdout, b"run/report.html\n");
    assert!(sandbox.path("run/report.html").is_file());
    insta::assert_snapshot!(sandbox.refused(&[
        "report run --out page.txt",
        "report run --out .html",
        "report nowhere"
    ]));
    let output = sandbox.run("report run --out nowhere/page.html");
    assert_eq!(output.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&output.stderr).contains("`nowhere/page.html` cannot be written"));
}
