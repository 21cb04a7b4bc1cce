//! What a motor's numbers mean.

/// The error of an answer, in words: its number without the alert bit.
pub(super) fn error_words(number: u8) -> String {
    let words = match number {
        1 => "it could not do it",
        2 => "it does not know the instruction, or nothing was registered for it",
        3 => "the packet arrived with a wrong checksum",
        4 => "a value is outside of the register's range",
        5 => "too few bytes for the register",
        6 => "a value is beyond the limit that another register sets",
        7 => "the register is not there, read-only, or kept without power and locked while torque is on",
        other => return format!("error {other}, which the protocol does not know"),
    };
    format!("{words} (error {number})")
}

/// The bits of a hardware error, in words; empty where there is none.
pub fn hardware_error_words(bits: u8) -> String {
    const KNOWN: [(u8, &str); 5] = [
        (0, "the voltage is outside of its limits"),
        (2, "it is too hot"),
        (3, "the encoder does not work"),
        (4, "an electrical shock, or too little power"),
        (5, "it was overloaded for too long"),
    ];
    let words = (0..8).filter(|bit| bits & (1 << bit) != 0).map(|bit| {
        let known = KNOWN.iter().find(|(known, _)| *known == bit);
        known.map_or_else(|| format!("unknown bit {bit}"), |(_, words)| (*words).to_owned())
    });
    words.collect::<Vec<_>>().join("; ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_in_words() {
        assert!(error_words(6).ends_with("(error 6)") && error_words(99).contains("99"));
        assert_eq!(hardware_error_words(0), "");
        assert_eq!(hardware_error_words(0b10_0100), "it is too hot; it was overloaded for too long");
        assert_eq!(hardware_error_words(0x80), "unknown bit 7");
    }
}
