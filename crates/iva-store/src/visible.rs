//! Text of others on a terminal: names of files, keys and columns may hold characters that move the
//! cursor, change colours or turn the direction of reading. They are shown, not obeyed.

/// A text with the control characters in it written out, as `\u{1b}`; line ends stay.
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

/// True of a character that does something instead of being seen.
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
