//! Fixed colour scales: what a value looks like is the same in every report.
//!
//! Both ramps keep their order in grey and for the common kinds of colour blindness: the sequential one rises in lightness
//! throughout, the diverging one leads from blue over a light middle to orange. The colours are our own.

use serde::Serialize;

/// Dark blue, green, yellow: from little to much.
const RISING: [u32; 7] = [0x2d1a55, 0x33478c, 0x2b7591, 0x2c9d85, 0x5fc166, 0xb0da3f, 0xfbe83a];
/// Blue, light grey, orange: from shrunk over kept to stretched; steep in the middle, where most of a good map lies.
const DIVERGING: [u32; 7] = [0x0a2a5e, 0x1f5fa8, 0x6aaade, 0xf1f0ec, 0xf0a04b, 0xc05a0c, 0x632800];

/// How values lie on a scale.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Spacing {
    /// Evenly.
    Linear,
    /// Evenly by ratio.
    Log,
}

/// A measure with its scale.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Scale {
    /// The measure's short name.
    pub name: &'static str,
    /// What it says, in a sentence.
    pub about: &'static str,
    /// What stands behind its numbers.
    pub unit: &'static str,
    /// How values lie on it.
    pub spacing: Spacing,
    /// The values at the ends of the colours; what lies beyond has the end's colour.
    pub ends: [f64; 2],
    /// The least and the largest value that a page can tell apart.
    pub range: [f64; 2],
    /// Values to be written beside it.
    pub ticks: &'static [f64],
    /// Its colours from end to end, evenly spaced, sRGB codes.
    pub ramp: &'static [u32],
}

/// The measures of a triangle's map, in the order of [`super::fields::Values`].
pub const SCALES: [Scale; 3] = [
    Scale {
        name: "Stretch",
        about: "E_L2 of every triangle: 1 keeps lengths on average, 2 doubles them",
        unit: "",
        spacing: Spacing::Log,
        ends: [0.25, 4.0],
        range: [1.0 / 64.0, 64.0],
        ticks: &[0.25, 0.5, 1.0, 2.0, 4.0],
        ramp: &DIVERGING,
    },
    Scale {
        name: "Angle",
        about: "by how much a triangle's angles change, mean of three",
        unit: "\u{b0}",
        spacing: Spacing::Linear,
        ends: [0.0, 45.0],
        range: [0.0, 180.0],
        ticks: &[0.0, 15.0, 30.0, 45.0],
        ramp: &RISING,
    },
    Scale {
        name: "Area",
        about: "area after the map by area before, both surfaces made equally large",
        unit: "\u{d7}",
        spacing: Spacing::Log,
        ends: [0.25, 4.0],
        range: [1.0 / 4096.0, 4096.0],
        ticks: &[0.25, 0.5, 1.0, 2.0, 4.0],
        ramp: &DIVERGING,
    },
];

impl Scale {
    /// How far a value lies along an interval of the scale, 0 to 1.
    fn share(&self, [low, high]: [f64; 2], value: f64) -> f64 {
        let along = |x: f64| if self.spacing == Spacing::Log { x.log2() } else { x };
        let t = (along(value) - along(low)) / (along(high) - along(low));
        if t.is_nan() { 1.0 } else { t.clamp(0.0, 1.0) }
    }

    /// The place of a value in the scale's range in steps of 1/65534; 65535 for what is not finite.
    pub fn quantised(&self, value: f64) -> u16 {
        if value.is_finite() { (self.share(self.range, value) * 65534.0).round() as u16 } else { u16::MAX }
    }

    /// The sRGB colour of a value, each channel 0 to 255.
    pub fn color(&self, value: f64) -> [f64; 3] {
        let at = self.share(self.ends, value) * (self.ramp.len() - 1) as f64;
        let i = (at as usize).min(self.ramp.len() - 2);
        let [a, b] = [self.ramp[i], self.ramp[i + 1]].map(channels);
        std::array::from_fn(|k| a[k] + (b[k] - a[k]) * (at - i as f64))
    }
}

/// The channels of an sRGB code, 0 to 255.
fn channels(code: u32) -> [f64; 3] {
    [16, 8, 0].map(|shift| f64::from(code >> shift & 255))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rec. 709 weights; good enough to order greys.
    fn lightness(code: u32) -> f64 {
        let [r, g, b] = channels(code);
        0.2126 * r + 0.7152 * g + 0.0722 * b
    }

    #[test]
    fn ramps_are_ordered_in_grey() {
        assert!(RISING.windows(2).all(|w| lightness(w[0]) < lightness(w[1])));
        assert!(DIVERGING[..4].windows(2).all(|w| lightness(w[0]) < lightness(w[1])));
        assert!(DIVERGING[3..].windows(2).all(|w| lightness(w[0]) > lightness(w[1])));
    }

    #[test]
    fn values_meet_their_colours_and_steps() {
        let stretch = SCALES[0];
        assert_eq!(stretch.color(1.0), channels(DIVERGING[3]));
        assert_eq!(stretch.color(0.0), channels(DIVERGING[0]));
        assert_eq!(stretch.color(1e9), channels(DIVERGING[6]));
        assert_eq!(
            [stretch.quantised(1.0), stretch.quantised(64.0), stretch.quantised(f64::NAN)],
            [32767, 65534, 65535]
        );
        assert!(SCALES.iter().all(|s| s.ticks.iter().all(|t| (s.ends[0]..=s.ends[1]).contains(t))));
    }
}
