//! "Did you mean": the nearest of some names.

/// Longer texts are no misspelt names, and comparing them would cost more than it helps.
const LONGEST: usize = 64;

/// The candidate that `typed` was probably meant to be, by edit distance.
pub fn nearest<'c>(typed: &str, candidates: impl IntoIterator<Item = &'c str>) -> Option<&'c str> {
    if typed.len() > LONGEST {
        return None;
    }
    let plain = |text: &str| text.to_lowercase().replace(['-', ' '], "_");
    let typed = plain(typed);
    let slips = |candidate: &str| 1 + candidate.chars().count() / 4;
    let length = typed.chars().count();
    candidates
        .into_iter()
        // Lengths alone tell most strangers apart, and cost less than the distance does.
        .filter(|candidate| length.abs_diff(candidate.chars().count()) <= slips(candidate))
        .map(|candidate| (strsim::damerau_levenshtein(&typed, &plain(candidate)), candidate))
        .filter(|&(distance, candidate)| distance <= slips(candidate))
        .min_by_key(|&(distance, _)| distance)
        .map(|(_, candidate)| candidate)
}

/// `a`, `a or b`, `a, b or c`.
pub fn either(names: &[impl AsRef<str>]) -> String {
    match names {
        [] => String::new(),
        [one] => one.as_ref().to_owned(),
        [before @ .., last] => {
            let before: Vec<&str> = before.iter().map(AsRef::as_ref).collect();
            format!("{} or {}", before.join(", "), last.as_ref())
        }
    }
}

/// Names in backquotes with commas between them.
pub fn listed<'c>(names: impl IntoIterator<Item = &'c str>) -> String {
    names.into_iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_slips_and_leaves_strangers() {
        let keys = ["clip_ratio", "epochs", "discount"];
        assert_eq!(nearest("clip_raito", keys), Some("clip_ratio"));
        assert_eq!(nearest("Clip-Ratio", keys), Some("clip_ratio"));
        assert_eq!(nearest("epoch", keys), Some("epochs"));
        assert_eq!(nearest("temperature", keys), None);
        assert_eq!(nearest(&"x".repeat(1 << 20), keys), None);
    }
}
