//! What a word that is not known could have meant.

use hwasp_settings::nearest;

use crate::error::ExprError;

/// Adds the nearest of the known names, or all of them where there are few.
pub(crate) fn suggest(error: ExprError, word: &str, known: &[String]) -> ExprError {
    if let Some(near) = nearest(word, known.iter().map(String::as_str)) {
        return error.hint(format!("did you mean `{near}`?"));
    }
    if known.is_empty() {
        return error;
    }
    let shown: Vec<&str> = known.iter().take(30).map(String::as_str).collect();
    let rest =
        if known.len() > shown.len() { format!(" and {} more", known.len() - shown.len()) } else { String::new() };
    error.hint(format!("known here: {}{rest}", shown.join(", ")))
}
