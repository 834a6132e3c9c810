//! HTML that is well-formed XML too.

use crate::plot::Figure;

/// A column of a table: its heading, and whether it holds numbers.
pub type Column = (&'static str, bool);

/// A table that scrolls on its own where the page is narrow. Cells are escaped.
pub fn table(columns: &[Column], rows: &[Vec<String>]) -> String {
    let class = |numeric: bool| if numeric { " class=\"n\"" } else { "" };
    let cells = |tag: &str, texts: &[&str]| -> String {
        texts
            .iter()
            .zip(columns)
            .map(|(text, (_, numeric))| {
                format!("<{tag}{}>{}</{tag}>", class(*numeric), escape(text))
            })
            .collect()
    };
    let headings: Vec<&str> = columns.iter().map(|(heading, _)| *heading).collect();
    let body: String = rows
        .iter()
        .map(|row| {
            let texts: Vec<&str> = row.iter().map(String::as_str).collect();
            format!("<tr>{}</tr>\n", cells("td", &texts))
        })
        .collect();
    format!(
        "<div class=\"scroll\"><table>\n<thead><tr>{}</tr></thead>\n<tbody>{body}</tbody></table></div>\n",
        cells("th", &headings)
    )
}

/// A picture with its caption.
pub fn figure(figure: &Figure, caption: &str) -> String {
    // Inside HTML the namespace is known; naming it would look like a reference to elsewhere.
    let svg = figure
        .to_svg()
        .replacen(" xmlns=\"http://www.w3.org/2000/svg\"", "", 1);
    format!(
        "<figure>\n<div class=\"plot\">{svg}</div><figcaption>{}</figcaption>\n</figure>\n",
        escape(caption)
    )
}

/// The text with its first letter large.
pub fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| {
        first.to_uppercase().chain(letters).collect()
    })
}

/// The text with what HTML takes for its own put in other words.
pub fn escape(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_are_escaped_and_numbers_marked() {
        let text = table(
            &[("name", false), ("gain", true)],
            &[vec!["a < b".into(), "1".into()]],
        );
        assert!(
            text.contains("<td>a &lt; b</td><td class=\"n\">1</td>"),
            "{text}"
        );
        assert!(
            text.contains("<th>name</th><th class=\"n\">gain</th>"),
            "{text}"
        );
    }
}
