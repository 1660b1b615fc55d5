//! HTML from arbitrary texts.

use std::fmt::Write as _;

/// A text with all characters that have a meaning in HTML replaced.
pub(crate) fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            c => out.push(c),
        }
    }
    out
}

/// JSON for a script element: no end tag and no comment can begin in it.
pub(super) fn json(value: &impl serde::Serialize) -> String {
    // Values of the report have text keys only and finite or null numbers: nothing that serde_json refuses.
    serde_json::to_string(value).unwrap_or_else(|_| "null".to_owned()).replace('<', "\\u003c")
}

/// A cell: its text, and the place to which a click leads.
pub(super) struct TableCell {
    text: String,
    class: &'static str,
    place: Option<usize>,
}

impl TableCell {
    /// Words, aligned left.
    pub(super) fn words(text: impl Into<String>) -> Self {
        Self { text: text.into(), class: "", place: None }
    }

    /// A figure, aligned right.
    pub(super) fn figure(text: impl Into<String>) -> Self {
        Self { text: text.into(), class: "n", place: None }
    }

    /// With another class.
    pub(super) fn class(self, class: &'static str) -> Self {
        Self { class, ..self }
    }

    /// As a button to a place.
    pub(super) fn place(self, place: Option<usize>) -> Self {
        Self { place, ..self }
    }
}

/// A table with one heading per column; `n` before a heading aligns the column right.
pub(super) fn table(caption: &str, headings: &[&str], rows: &[Vec<TableCell>]) -> String {
    let mut out = String::new();
    // Writing to a string cannot fail.
    let _ = write_table(&mut out, caption, headings, rows);
    out
}

fn write_table(out: &mut String, caption: &str, headings: &[&str], rows: &[Vec<TableCell>]) -> std::fmt::Result {
    write!(out, "<div class=scroll><table><caption>{}</caption><thead><tr>", escaped(caption))?;
    for (k, heading) in headings.iter().enumerate() {
        let right = rows.first().and_then(|r| r.get(k)).is_some_and(|c| c.class.starts_with('n'));
        write!(out, "<th scope=col{}>{}</th>", if right { " class=n" } else { "" }, escaped(heading))?;
    }
    out.push_str("</tr></thead><tbody>\n");
    for row in rows {
        out.push_str("<tr>");
        for (k, cell) in row.iter().enumerate() {
            let (open, close) = if k == 0 { ("<th scope=row", "</th>") } else { ("<td", "</td>") };
            write!(
                out,
                "{open}{}>",
                if cell.class.is_empty() { String::new() } else { format!(" class=\"{}\"", cell.class) }
            )?;
            match cell.place {
                Some(place) => {
                    write!(out, "<button type=button class=jump data-place={place}>{}</button>", escaped(&cell.text))?;
                }
                None => out.push_str(&escaped(&cell.text)),
            }
            out.push_str(close);
        }
        out.push_str("</tr>\n");
    }
    out.push_str("</tbody></table></div>\n");
    Ok(())
}

/// A template in which the text of each part replaces its mark `<!--@name-->`. Marks without a part are removed.
pub(super) fn filled(template: &str, parts: &[(&str, &str)]) -> String {
    let mut out = String::with_capacity(template.len() + parts.iter().map(|p| p.1.len()).sum::<usize>());
    let mut rest = template;
    while let Some(start) = rest.find("<!--@") {
        let (before, mark) = rest.split_at(start);
        out.push_str(before);
        let Some(end) = mark.find("-->") else {
            rest = mark;
            break;
        };
        let name = &mark["<!--@".len()..end];
        out.push_str(parts.iter().find(|p| p.0 == name).map_or("", |p| p.1));
        rest = &mark[end + "-->".len()..];
    }
    out.push_str(rest);
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_cannot_become_markup() {
        let hostile = "</script><img src=x onerror='a'>&\"<!--@json-->";
        let row = vec![TableCell::words(hostile), TableCell::figure(hostile).place(Some(3))];
        let page = table(hostile, &[hostile], &[row]);
        assert!(!page.contains("<img") && !page.contains("</script") && !page.contains("onerror='"));
        assert!(!json(&hostile).contains('<'));
        let back: String = serde_json::from_str(&json(&hostile)).unwrap();
        assert_eq!(back, hostile);
    }

    #[test]
    fn marks_are_filled_once() {
        let parts = [("a", "<!--@b-->"), ("b", "2")];
        assert_eq!(filled("x<!--@a-->y<!--@b-->z<!--@c-->", &parts), "x<!--@b-->y2z");
    }
}
