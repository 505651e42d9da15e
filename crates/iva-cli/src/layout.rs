//! Plain text for a terminal of 80 columns.

/// Width of the widest line that is printed, in characters.
pub(crate) const WIDTH: usize = 80;
/// Width of the blank space before each column, in characters.
const BETWEEN: usize = 2;

/// Breaks a text into lines of at most [`WIDTH`] characters.
pub(crate) fn wrap(text: &str) -> String {
    let mut lines = vec![String::new()];
    let mut width = 0;
    for word in text.split(' ') {
        let length = word.chars().count();
        if width > 0 && width + 1 + length > WIDTH {
            lines.push(String::new());
            width = 0;
        }
        if let Some(line) = lines.last_mut() {
            if width > 0 {
                line.push(' ');
                width += 1;
            }
            line.push_str(word);
            width += length;
        }
    }
    lines.join("\n")
}

/// A table of right-aligned columns that fits the terminal.
#[derive(Debug, Default)]
pub(crate) struct TextTable {
    columns: Vec<TextColumn>,
}

#[derive(Debug, Clone)]
struct TextColumn {
    heading: Vec<String>,
    unit: String,
    cells: Vec<String>,
    optional: bool,
}

impl TextColumn {
    fn width(&self) -> usize {
        let heading = self.heading.iter().map(|word| word.chars().count());
        let cells = self.cells.iter().map(|cell| cell.chars().count());
        heading.chain(cells).chain([self.unit.chars().count()]).max().unwrap_or(0)
    }
}

impl TextTable {
    /// Adds a column.
    pub(crate) fn push(&mut self, heading: &str, unit: &str, cells: Vec<String>) {
        self.columns.push(TextColumn {
            heading: vec![heading.to_owned()],
            unit: unit.to_owned(),
            cells,
            optional: false,
        });
    }

    /// Adds a column that is left out if the table is too wide, the last optional column first.
    pub(crate) fn push_optional(&mut self, heading: &str, unit: &str, cells: Vec<String>) {
        self.push(heading, unit, cells);
        if let Some(column) = self.columns.last_mut() {
            column.optional = true;
        }
    }

    /// The lines of the table.
    pub(crate) fn print(&self) -> String {
        let mut columns = self.columns.clone();
        while width(&columns) > WIDTH && columns.iter().any(|column| column.optional) {
            columns.pop();
        }
        if width(&columns) > WIDTH {
            for column in &mut columns {
                column.heading = stacked(&column.heading);
            }
        }
        let mut left_out = Vec::new();
        // The last column is the ranked measure: it stays.
        while width(&columns) > WIDTH && columns.len() > 1 {
            left_out.push(columns.remove(columns.len() - 2).heading.concat());
        }
        let height = columns.iter().map(|c| c.heading.len()).max().unwrap_or(0);
        let mut out = String::new();
        for level in 0..height {
            push_line(&mut out, &columns, |column| {
                let above = height - column.heading.len();
                let word = level.checked_sub(above).and_then(|i| column.heading.get(i));
                word.map_or("", String::as_str)
            });
        }
        if columns.iter().any(|column| !column.unit.is_empty()) {
            push_line(&mut out, &columns, |column| &column.unit);
        }
        let rows = columns.first().map_or(0, |column| column.cells.len());
        for row in 0..rows {
            push_line(&mut out, &columns, |column| {
                column.cells.get(row).map_or("", String::as_str)
            });
        }
        if !left_out.is_empty() {
            left_out.reverse();
            let note = format!("Not shown, but in the summary: {}.", left_out.join(", "));
            out.push_str(&wrap(&note));
            out.push('\n');
        }
        out
    }
}

/// A heading broken into lines after `_` and `.`: `relative_`, `clearance`.
fn stacked(heading: &[String]) -> Vec<String> {
    heading.iter().flat_map(|word| word.split_inclusive(['_', '.'])).map(str::to_owned).collect()
}

fn width(columns: &[TextColumn]) -> usize {
    columns.iter().map(|column| BETWEEN + column.width()).sum()
}

fn push_line<'a>(
    out: &mut String,
    columns: &'a [TextColumn],
    cell: impl Fn(&'a TextColumn) -> &'a str,
) {
    let mut line = String::new();
    for column in columns {
        let text = cell(column);
        let padding = BETWEEN + column.width() - text.chars().count().min(column.width());
        line.push_str(&" ".repeat(padding));
        line.push_str(text);
    }
    out.push_str(line.trim_end());
    out.push('\n');
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_break_at_eighty() {
        let text = wrap(&"word ".repeat(40));
        assert!(text.lines().count() > 1);
        assert!(text.lines().all(|line| line.chars().count() <= WIDTH));
    }

    #[test]
    fn a_wide_table_first_drops_optional_columns_then_stacks_then_leaves_out() {
        for axes in 1..12 {
            let mut table = TextTable::default();
            for axis in 0..axes {
                table.push(
                    &format!("absorber.relative_clearance_{axis}"),
                    "1/ωn",
                    vec!["0.25".into()],
                );
            }
            table.push("settling_time_5", "1/ωn", vec!["39.21".into()]);
            table.push_optional("impacts", "", vec!["18".into()]);
            let text = table.print();
            assert!(text.lines().all(|line| line.chars().count() <= WIDTH), "{text}");
            assert!(text.contains("39.21"), "{text}");
            assert_eq!(text.contains("Not shown"), axes > 5, "{text}");
        }
    }
}
