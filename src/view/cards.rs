//! The numbers of a report as HTML: tables, bars, lists.

use super::html::escape;
use super::page::Card;
use std::collections::BTreeMap;

/// A table; the first row is its head, the first cell of every row a name, the others are numbers.
pub fn table(rows: &[Vec<String>]) -> String {
    let cells = |row: &[String], tag: &str| -> String {
        row.iter().map(|cell| format!("<{tag}>{}</{tag}>", escape(cell))).collect()
    };
    let Some((head, body)) = rows.split_first() else { return String::new() };
    let body: String = body.iter().map(|row| format!("<tr>{}</tr>", cells(row, "td"))).collect();
    format!(
        "<div class=\"scroll\"><table><thead><tr>{}</tr></thead><tbody>{body}</tbody></table></div>",
        cells(head, "th")
    )
}

/// Names and what belongs to them.
pub fn facts(list: &[(&str, String)]) -> String {
    let entry = |(name, value): &(&str, String)| format!("<dt>{}</dt><dd>{}</dd>", escape(name), escape(value));
    format!("<dl>{}</dl>", list.iter().map(entry).collect::<String>())
}

/// Seconds per stage as bars in the order given, stages without time left out, and the sum.
pub fn seconds(seconds: &BTreeMap<&'static str, f64>, order: &[&str]) -> Card {
    let total = seconds.get("total").copied().unwrap_or(0.0);
    let place = |name: &str| order.iter().position(|o| *o == name).unwrap_or(order.len());
    let mut stages: Vec<(&str, f64)> = seconds.iter().filter(|(n, _)| **n != "total").map(|(n, s)| (*n, *s)).collect();
    stages.sort_by_key(|(name, _)| place(name));
    let longest = stages.iter().map(|(_, s)| *s).fold(f64::MIN_POSITIVE, f64::max);
    let bar = |(name, s): &(&str, f64)| {
        format!(
            "<li><span>{}</span><i><b style=\"width:{:.1}%\"></b></i><span class=\"number\">{s:.2} s</span></li>",
            escape(name),
            s / longest * 100.0
        )
    };
    let bars: String = stages.iter().map(bar).collect();
    Card::new("Time", format!("<ul class=\"bars\">{bars}</ul><p class=\"soft\">{total:.2} s in all</p>"))
}

/// What a user should know; none without warnings.
pub fn warnings(list: &[String]) -> Option<Card> {
    let items: String = list.iter().map(|w| format!("<li>{}</li>", escape(w))).collect();
    let card = Card { wide: true, ..Card::new("Warnings", format!("<ul class=\"warnings\">{items}</ul>")) };
    (!list.is_empty()).then_some(card)
}

/// The command that made it; none if it is not known.
pub fn command(line: &str) -> Option<Card> {
    let card = Card::new("Made by", format!("<pre class=\"command\">{}</pre>", escape(line)));
    (!line.is_empty()).then_some(Card { wide: true, ..card })
}

/// The place where the script lists triangles that are turned over, and flies to them.
pub fn flips() -> Card {
    Card { wide: true, ..Card::new("Turned-over triangles", "<div id=\"flips\"></div>".to_owned()) }
}

/// The place where the script draws how distortion is spread.
pub fn histograms(below: String) -> Card {
    let html = format!("<div id=\"histograms\"></div>{below}");
    Card { wide: true, ..Card::new("Distortion", html) }
}

/// Pictures with captions; none without any.
pub fn figures(title: &'static str, about: &str, list: &[(String, String)]) -> Option<Card> {
    let figure = |(caption, address): &(String, String)| {
        let caption = escape(caption);
        format!("<figure><img src=\"{address}\" alt=\"{caption}\"><figcaption>{caption}</figcaption></figure>")
    };
    let items: String = list.iter().map(figure).collect();
    let html = format!("<p class=\"soft\">{}</p><div class=\"figures\">{items}</div>", escape(about));
    (!list.is_empty()).then_some(Card { wide: true, ..Card::new(title, html) })
}
