//! Escaping of control characters in text for a terminal: names of files, keys and columns may hold
//! characters that move the cursor, change colours or turn the direction of reading.

/// A text with its control and direction characters escaped, as `\u{1b}`; line feeds stay.
pub fn visible(text: &str) -> String {
    let mut shown = String::with_capacity(text.len());
    for character in text.chars() {
        if acts(character) {
            shown.extend(character.escape_default());
        } else {
            shown.push(character);
        }
    }
    shown
}

/// True for control characters but the line feed, and for marks that turn the direction of reading.
fn acts(character: char) -> bool {
    let turns = matches!(
        character,
        '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}'
    );
    turns || (character.is_control() && character != '\n')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_acts_is_written_out() {
        for (text, shown) in [
            ("results/γ = 0.5\n", "results/γ = 0.5\n"),
            ("a\u{1b}[31mb", "a\\u{1b}[31mb"),
            ("a\rb\tc\u{7f}", "a\\rb\\tc\\u{7f}"),
            ("a\u{9b}2Jb", "a\\u{9b}2Jb"),
            ("gpj.\u{202e}exe", "gpj.\\u{202e}exe"),
        ] {
            assert_eq!(visible(text), shown);
        }
    }
}
