//! Programs as they come over the line, piece by piece.

/// The longest program, bytes; one of `ur_rtde` has 40 000.
const LONGEST: usize = 1 << 20;

/// Collects lines until they are a whole program.
#[derive(Debug, Default)]
pub(super) struct Upload {
    unread: Vec<u8>,
    program: String,
    depth: i32,
}

impl Upload {
    /// Takes what has come; gives back what is complete. An error closes the connection.
    pub(crate) fn push(&mut self, bytes: &[u8]) -> Result<Vec<String>, String> {
        self.unread.extend_from_slice(bytes);
        let mut whole = Vec::new();
        while let Some(end) = self.unread.iter().position(|byte| *byte == b'\n') {
            let line: Vec<u8> = self.unread.drain(..=end).collect();
            let line = String::from_utf8_lossy(&line).into_owned();
            self.depth += depth(&line);
            if self.depth < 0 {
                return Err("a program ends more often than it begins".to_owned());
            }
            self.program.push_str(&line);
            if self.depth == 0 {
                let program = std::mem::take(&mut self.program);
                if program.lines().any(|line| !code(line).trim().is_empty()) {
                    whole.push(program);
                }
            }
        }
        if self.program.len() + self.unread.len() > LONGEST {
            return Err(format!("a program is longer than {LONGEST} bytes"));
        }
        Ok(whole)
    }
}

/// A line without its comment and its texts.
fn code(line: &str) -> String {
    let pieces: String = line.split('"').step_by(2).collect::<Vec<_>>().join(" ");
    pieces.split('#').next().unwrap_or_default().to_owned()
}

/// By how much deeper a line leads into blocks.
fn depth(line: &str) -> i32 {
    let code = code(line);
    let words = code.split(|letter: char| !letter.is_alphanumeric() && letter != '_');
    words
        .map(|word| i32::from(matches!(word, "def" | "sec" | "thread" | "if" | "while")) - i32::from(word == "end"))
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_program_is_whole_at_its_last_end() {
        let text = "# first\ndef a():\n  while True: # if\n    textmsg(\"if end\")\n    sync()\n  end\nend\nhalt\n";
        for size in [1, 7, 1000] {
            let mut upload = Upload::default();
            let programs: Vec<String> =
                text.as_bytes().chunks(size).flat_map(|piece| upload.push(piece).expect("a program")).collect();
            assert_eq!(programs.len(), 2, "{programs:?}");
            assert!(programs[0].trim_end().ends_with("end") && programs[1] == "halt\n");
        }
        assert!(Upload::default().push(b"end\n").is_err());
    }
}
