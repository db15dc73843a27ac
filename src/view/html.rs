//! Text and data from outside, made safe to stand in a page.

use serde::Serialize;

/// Styles and the light and dark colours that all pages share.
pub const THEME_CSS: &str = include_str!("web/theme.css");
/// The switch between light and dark.
pub const THEME_JS: &str = include_str!("web/theme.js");

/// Text that stands for itself in HTML, between tags and in quoted attributes.
pub fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            c if c.is_control() && !c.is_whitespace() => out.push('\u{fffd}'),
            c => out.push(c),
        }
    }
    out
}

/// A value as JSON that can stand in a `script` element: whatever it holds cannot end the element.
pub fn script_data(value: &impl Serialize) -> String {
    let text = serde_json::to_string(value).expect("pages hold plain data with string keys");
    // All of these occur only inside of JSON's strings, where an escape stands for the same character.
    [("<", "\\u003c"), (">", "\\u003e"), ("&", "\\u0026"), ("\u{2028}", "\\u2028"), ("\u{2029}", "\\u2029")]
        .into_iter()
        .fold(text, |text, (from, to)| text.replace(from, to))
}

/// A relative link to a file below the page: every byte that is not plain is percent-encoded, folders stay.
pub fn relative_link(path: &str) -> String {
    let mut out = String::from("./");
    for &byte in path.as_bytes() {
        match byte {
            b'A'..=b'Z' | b'a'..=b'z' | b'0'..=b'9' | b'-' | b'_' | b'.' | b'~' | b'/' => out.push(byte as char),
            _ => out.push_str(&format!("%{byte:02X}")),
        }
    }
    out
}

/// Puts parts into a template: `{{name}}` becomes the part with this name.
///
/// Parts are not searched again, so that nothing that stands in one of them counts as a place.
pub fn fill(template: &str, parts: &[(&str, &str)]) -> String {
    let mut out = String::with_capacity(template.len() + parts.iter().map(|(_, part)| part.len()).sum::<usize>());
    let mut rest = template;
    while let Some((before, after)) = rest.split_once("{{") {
        let (name, after) = after.split_once("}}").expect("templates are ours, and close what they open");
        let part = parts.iter().find(|(key, _)| *key == name).map(|(_, part)| *part);
        out.push_str(before);
        out.push_str(part.expect("templates are ours, and name parts that there are"));
        rest = after;
    }
    out + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_and_data_cannot_leave_their_place() {
        let hostile = "</script><script>alert('1 & 2')\u{2028}\"\u{7}";
        assert_eq!(escape(hostile).matches(['<', '>', '"', '\'', '\u{7}']).count(), 0);
        let data = script_data(&[hostile]);
        assert_eq!(data.matches(['<', '>', '&', '\u{2028}']).count(), 0);
        let back: Vec<String> = serde_json::from_str(&data).expect("still JSON");
        assert_eq!(back, [hostile]);
    }

    #[test]
    fn links_stay_below_the_page() {
        assert_eq!(relative_link("a b/ä?#.html"), "./a%20b/%C3%A4%3F%23.html");
        assert_eq!(relative_link("javascript:x"), "./javascript%3Ax");
    }

    #[test]
    fn parts_are_not_searched_for_places() {
        assert_eq!(fill("<{{a}}|{{b}}>", &[("a", "{{b}}"), ("b", "2")]), "<{{b}}|2>");
    }
}
