//! The sRGB transfer curve (IEC 61966-2-1).

/// Linear light of an sRGB value, both in [0, 1].
pub fn decode(x: f32) -> f32 {
    if x <= 0.040_45 { x / 12.92 } else { ((x + 0.055) / 1.055).powf(2.4) }
}

/// The sRGB value of linear light, both in [0, 1].
pub fn encode(x: f32) -> f32 {
    if x <= 0.003_130_8 { x * 12.92 } else { 1.055 * x.powf(1.0 / 2.4) - 0.055 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_byte_comes_back() {
        for byte in 0..=255u8 {
            let x = f32::from(byte) / 255.0;
            assert_eq!((encode(decode(x)) * 255.0).round() as u8, byte);
        }
    }
}
