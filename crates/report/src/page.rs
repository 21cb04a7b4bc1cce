//! The document around the sections.

use hwasp_scene::source_hash;
use maud::{DOCTYPE, Markup, PreEscaped, html};

const STYLE: &str = include_str!("style.css");
const PLAYER: &str = include_str!("player.js");
const PRINT: &str = include_str!("print.js");

/// A chapter.
pub(super) struct Section {
    /// What links call it.
    pub(super) id: &'static str,
    /// Its heading.
    pub(super) title: &'static str,
    /// What it says, headings from the third level on.
    pub(super) body: Markup,
}

/// A figure to begin with.
pub(super) struct KeyFigure {
    /// What it is of.
    pub(super) label: String,
    /// The figure.
    pub(super) value: String,
    /// What else is to be known of it; may be empty.
    pub(super) note: String,
}

/// The whole document.
pub(super) struct Page {
    /// The main heading.
    pub(super) title: String,
    /// The line above it.
    pub(super) kind: &'static str,
    /// What it is about.
    pub(super) lead: String,
    /// The figures that matter most.
    pub(super) figures: Vec<KeyFigure>,
    /// The chapters.
    pub(super) sections: Vec<Section>,
}

impl Page {
    /// The document as text.
    pub(super) fn html(self) -> String {
        let [style, player, print] = [STYLE, PLAYER, PRINT].map(source_hash);
        let policy = format!("default-src 'none'; style-src '{style}'; script-src '{player}' '{print}'");
        let page = html! {
            (DOCTYPE)
            html lang="en" {
                head {
                    meta charset="utf-8";
                    meta http-equiv="Content-Security-Policy" content=(policy);
                    meta name="viewport" content="width=device-width, initial-scale=1";
                    meta name="color-scheme" content="light dark";
                    meta name="generator" content=(concat!("hwasp ", env!("CARGO_PKG_VERSION")));
                    title { (self.title) " · hwasp report" }
                    style { (PreEscaped(STYLE)) }
                }
                body {
                    a.skip href="#content" { "Skip to the content" }
                    header {
                        p.kind { (self.kind) }
                        h1 { (self.title) }
                        @if !self.lead.is_empty() { p.lead { (self.lead) } }
                        dl.figures {
                            @for KeyFigure { label, value, note } in &self.figures {
                                div { dt { (label) } dd.value { (value) } @if !note.is_empty() { dd.note { (note) } } }
                            }
                        }
                    }
                    nav aria-label="Sections" {
                        ul { @for section in &self.sections { li { a href={ "#" (section.id) } { (section.title) } } } }
                    }
                    main id="content" {
                        @for Section { id, title, body } in &self.sections {
                            section id=(id) aria-labelledby={ (id) "-title" } { h2 id={ (id) "-title" } { (title) } (body) }
                        }
                    }
                    footer { p { "Made by " code { "hwasp report" } ", version " (env!("CARGO_PKG_VERSION")) "." } }
                    script { (PreEscaped(PLAYER)) }
                    script { (PreEscaped(PRINT)) }
                }
            }
        };
        page.into_string() + "\n"
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whatever_is_said_is_text() {
        let evil = "</title></style><script>alert(1)</script>\"'&";
        let figures = vec![KeyFigure { label: evil.into(), value: evil.into(), note: evil.into() }];
        let sections = vec![Section { id: "one", title: "One", body: html! { p title=(evil) { (evil) } } }];
        let page = Page { title: evil.into(), kind: "Run", lead: evil.into(), figures, sections };
        let html = page.html();
        assert_eq!(html.matches("<script").count(), 2, "{html}");
        assert!(!html.contains("<script>alert") && html.contains("&lt;script&gt;alert(1)&lt;/script&gt;&quot;"));
    }
}
