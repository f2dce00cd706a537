//! The colours of best actions.

use crate::record::colours::SCALE;

/// Returns the colour of a share, from 0 (far from the goal) to 1 (near the goal).
pub(super) fn shade(near: f64) -> u32 {
    let [far, middle, nearest] = SCALE;
    if near < 0.5 {
        blend(far, middle, 2.0 * near)
    } else {
        blend(middle, nearest, 2.0 * near - 1.0)
    }
}

/// Returns a blend of two colours. `share` ranges from 0 to 1.
fn blend(from: u32, to: u32, share: f64) -> u32 {
    let part = |shift: u32| {
        let [from, to] = [from, to].map(|rgb| f64::from(rgb >> shift & 0xff));
        let part = (from + (to - from) * share.clamp(0.0, 1.0)).round() as u32;
        part << shift
    };
    part(16) | part(8) | part(0)
}

/// Formats the colour `0xRRGGBB` for CSS and SVG.
pub(crate) fn css(rgb: u32) -> String {
    format!("#{rgb:06x}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_get_darker_toward_the_goal() {
        // Relative luminance as defined by WCAG 2.
        let luminance = SCALE.map(|rgb| {
            let part = |shift: u32| {
                let part = f64::from(rgb >> shift & 0xff) / 255.0;
                if part <= 0.04045 {
                    part / 12.92
                } else {
                    ((part + 0.055) / 1.055).powf(2.4)
                }
            };
            0.2126 * part(16) + 0.7152 * part(8) + 0.0722 * part(0)
        });
        // A contrast of at least 1.5 is visible without hue.
        for pair in luminance.windows(2) {
            assert!((pair[0] + 0.05) / (pair[1] + 0.05) > 1.5, "{luminance:?}");
        }
    }
}
