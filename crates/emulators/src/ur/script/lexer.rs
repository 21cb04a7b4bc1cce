//! Words of a program.

/// A word.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Token {
    Name(String),
    Number(f64),
    Text(String),
    /// One or two signs.
    Sign(&'static str),
    /// The end of a line.
    End,
}

const SIGNS: [&str; 21] =
    ["==", "!=", "<=", ">=", "(", ")", "[", "]", ",", ":", "=", "<", ">", "+", "-", "*", "/", "%", "^", ".", ";"];

/// The words with the numbers of their lines. Within brackets lines have no end.
pub(super) fn words(text: &str) -> Result<Vec<(Token, usize)>, String> {
    let (mut words, mut depth, mut line, mut rest) = (Vec::new(), 0_i32, 1, text);
    while let Some(first) = rest.chars().next() {
        let mut taken = first.len_utf8();
        match first {
            '\n' => {
                if depth == 0 {
                    words.push((Token::End, line));
                }
                line += 1;
            }
            '#' => taken = rest.find('\n').unwrap_or(rest.len()),
            '"' => {
                let end = rest[1..].find('"').ok_or_else(|| format!("line {line}: a text does not end"))?;
                words.push((Token::Text(rest[1..=end].to_owned()), line));
                taken = end + 2;
            }
            _ if first.is_whitespace() => {}
            _ if first.is_ascii_digit() => {
                taken = number(rest);
                let value =
                    rest[..taken].parse().map_err(|_| format!("line {line}: {:?} is no number", &rest[..taken]))?;
                words.push((Token::Number(value), line));
            }
            _ if first.is_alphabetic() || first == '_' => {
                taken = rest.find(|letter: char| !letter.is_alphanumeric() && letter != '_').unwrap_or(rest.len());
                words.push((Token::Name(rest[..taken].to_owned()), line));
            }
            _ => {
                let sign = SIGNS.iter().find(|sign| rest.starts_with(**sign));
                let sign = sign.ok_or_else(|| format!("line {line}: {first:?} is not known"))?;
                depth += i32::from(matches!(*sign, "(" | "[")) - i32::from(matches!(*sign, ")" | "]"));
                words.push((Token::Sign(sign), line));
                taken = sign.len();
            }
        }
        rest = &rest[taken..];
    }
    words.push((Token::End, line));
    Ok(words)
}

/// How many bytes the number takes with which the text begins.
fn number(text: &str) -> usize {
    let mut before = ' ';
    for (at, letter) in text.char_indices() {
        let part = letter.is_ascii_digit() || letter == '.' || matches!(letter, 'e' | 'E');
        let sign = matches!(letter, '+' | '-') && matches!(before, 'e' | 'E');
        if !part && !sign {
            return at;
        }
        before = letter;
    }
    text.len()
}
