//! HTML from arbitrary texts.

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
pub(crate) fn json(value: &impl serde::Serialize) -> String {
    // Values of the report have text keys only and finite or null numbers: nothing that serde_json refuses.
    serde_json::to_string(value).unwrap_or_else(|_| "null".to_owned()).replace('<', "\\u003c")
}

/// A template in which the text of each part replaces its mark `<!--@name-->`. Marks without a part are removed.
pub(crate) fn filled(template: &str, parts: &[(&str, &str)]) -> String {
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
