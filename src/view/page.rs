//! `report.html`: the viewer with a scene, and cards with the numbers below it.

use super::base64::base64;
use super::html::{THEME_CSS, THEME_JS, escape, fill};

const TEMPLATE: &str = include_str!("web/viewer/viewer.html");
const STYLES: [&str; 2] = [include_str!("web/viewer/viewer.css"), include_str!("web/viewer/cards.css")];

/// The shaders by the name that the scripts ask for.
const SHADERS: [(&str, &str); 6] = [
    ("surface.vert", include_str!("web/viewer/surface.vert.glsl")),
    ("surface.frag", include_str!("web/viewer/surface.frag.glsl")),
    ("line.vert", include_str!("web/viewer/line.vert.glsl")),
    ("line.frag", include_str!("web/viewer/line.frag.glsl")),
    ("dot.vert", include_str!("web/viewer/dot.vert.glsl")),
    ("dot.frag", include_str!("web/viewer/dot.frag.glsl")),
];

/// The viewer's scripts, one idea each, in the order in which they build on each other; all share one scope.
const SCRIPTS: [&str; 17] = [
    include_str!("web/viewer/math.js"),
    include_str!("web/viewer/data.js"),
    include_str!("web/viewer/gl.js"),
    include_str!("web/viewer/surface.js"),
    include_str!("web/viewer/lines.js"),
    include_str!("web/viewer/dots.js"),
    include_str!("web/viewer/camera.js"),
    include_str!("web/viewer/pick.js"),
    include_str!("web/viewer/draw.js"),
    include_str!("web/viewer/hover.js"),
    include_str!("web/viewer/panels.js"),
    include_str!("web/viewer/flight.js"),
    include_str!("web/viewer/gestures.js"),
    include_str!("web/viewer/scales.js"),
    include_str!("web/viewer/flips.js"),
    include_str!("web/viewer/controls.js"),
    include_str!("web/viewer/main.js"),
];

/// One block of numbers below the viewer.
#[derive(Clone, Debug, PartialEq)]
pub struct Card {
    /// Its heading.
    pub title: &'static str,
    /// Its content: HTML, everything from outside escaped.
    pub html: String,
    /// True for one that takes the page's whole width.
    pub wide: bool,
}

/// What stands in a page.
#[derive(Clone, Debug)]
pub struct Page<'a> {
    /// The heading.
    pub title: String,
    /// The verdict in a few words, and whether it is good.
    pub verdict: (String, bool),
    /// What the viewer shows: [`super::scene::Scene::data`].
    pub scene: &'a str,
    /// A sentence about what is shown, if it is not all there is.
    pub note: Option<String>,
    /// The numbers.
    pub cards: Vec<Card>,
}

impl Page<'_> {
    /// The page, complete and self-contained.
    pub fn html(&self) -> String {
        let shader = |(name, text): (&str, &str)| format!("<script type=\"x-shader\" id=\"{name}\">{text}</script>\n");
        let (verdict, is_good) = &self.verdict;
        let note = self.note.as_deref().map_or(String::new(), |note| format!("<p class=\"note\">{}</p>", escape(note)));
        fill(
            TEMPLATE,
            &[
                ("title", &escape(&self.title)),
                ("theme", THEME_CSS),
                ("style", &STYLES.concat()),
                ("switch", THEME_JS),
                ("verdict", &escape(verdict)),
                ("kind", if *is_good { "good" } else { "bad" }),
                ("note", &note),
                ("cards", &self.cards.iter().map(Card::html).collect::<String>()),
                ("shaders", &SHADERS.map(shader).concat()),
                ("scene", self.scene),
                ("script", &SCRIPTS.concat()),
            ],
        )
    }
}

impl Card {
    /// A card of usual width.
    pub fn new(title: &'static str, html: String) -> Self {
        Card { title, html, wide: false }
    }

    fn html(&self) -> String {
        let class = if self.wide { "card block wide" } else { "card block" };
        format!("<section class=\"{class}\"><h2>{}</h2>{}</section>\n", escape(self.title), self.html)
    }
}

/// A `data:` address of an image file's bytes; the type is `png` or `jpeg`.
pub fn image_address(kind: &str, bytes: &[u8]) -> String {
    format!("data:image/{kind};base64,{}", base64(bytes))
}
