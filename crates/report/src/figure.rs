//! Pictures in the page.

use maud::{Markup, PreEscaped, html};

/// A picture of ours as a part of the page, with a name and a description for those who do not see it. `id` is its own.
pub(super) fn picture(svg: &str, id: &str, title: &str, description: &str) -> Markup {
    let (open, rest) = svg.split_once('>').unwrap_or((svg, ""));
    // In a page the namespace goes without saying; role and name are given here.
    let open = open.replace(" xmlns=\"http://www.w3.org/2000/svg\"", "").replace(" role=\"img\"", "");
    let rest = rest.trim_start();
    let body = match rest.strip_prefix("<title>").and_then(|rest| rest.split_once("</title>")) {
        Some((_, body)) => body,
        None => rest,
    };
    let names = html! { title id={ (id) "-t" } { (title) } desc id={ (id) "-d" } { (description) } };
    let names = names.into_string();
    PreEscaped(format!("{open} role=\"img\" aria-labelledby=\"{id}-t {id}-d\">{names}{}", body.trim_start()))
}

/// Pictures side by side where there is room, and what is to be said of them all.
pub(super) fn gallery(pictures: &[Markup], caption: &str) -> Markup {
    html! {
        figure.gallery {
            div.pictures { @for picture in pictures { (picture) } }
            @if !caption.is_empty() { figcaption { (caption) } }
        }
    }
}

/// A picture that keeps its size and is scrolled where there is less room.
pub(super) fn wide(picture: &Markup, label: &str, caption: &str) -> Markup {
    html! {
        figure.wide {
            div.scroll tabindex="0" role="region" aria-label=(label) { (picture) }
            figcaption { (caption) }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_is_named_once_and_carries_no_address() {
        let svg = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"9\" role=\"img\">\n<title>old</title>\n<rect/>\n</svg>\n";
        let inlined = picture(svg, "p", "a < b", "what it shows").into_string();
        let expected = "<svg width=\"9\" role=\"img\" aria-labelledby=\"p-t p-d\"><title id=\"p-t\">a &lt; b</title>\
                        <desc id=\"p-d\">what it shows</desc><rect/>\n</svg>\n";
        assert_eq!(inlined, expected);
    }
}
