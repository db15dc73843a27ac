//! The distortion of single triangles, measured as [`crate::map::distortion`] does it for all.

use crate::map::distortion::DEGENERATE_SHARE;
use crate::mesh::metric;
use glam::DVec3;
use rayon::prelude::*;

/// L2 stretch; mean change of the angles in degrees; ratio of areas. Not a number for triangles that have no area before.
pub type Values = [f64; 3];

/// The measures of triangles under the affine maps that move their corners, after the scale that makes areas equal.
pub fn fields(triangles: &[[u32; 3]], before: &[DVec3], after: &[DVec3]) -> Vec<Values> {
    let corners = |points: &[DVec3], t: &[u32; 3]| t.map(|v| points[v as usize]);
    let total = |points: &[DVec3]| triangles.iter().map(|t| metric::area(corners(points, t))).sum::<f64>();
    let (all_before, all_after) = (total(before), total(after));
    let smallest = DEGENERATE_SHARE * all_before / triangles.len().max(1) as f64;
    let scale_sq = all_after / all_before;
    let one = |t: &[u32; 3]| {
        let (p, q) = (corners(before, t), corners(after, t));
        if metric::area(p) > smallest { measures(p, q, scale_sq) } else { [f64::NAN; 3] }
    };
    triangles.par_iter().map(one).collect()
}

fn measures(before: [DVec3; 3], after: [DVec3; 3], scale_sq: f64) -> Values {
    let (large, small) = metric::singular_values(before, after);
    let (angles, images) = (metric::angles(before), metric::angles(after));
    let turned = (0..3).map(|i| (angles[i] - images[i]).abs()).sum::<f64>() / 3.0;
    let stretch = ((large * large + small * small) / (2.0 * scale_sq)).sqrt();
    [stretch, turned.to_degrees(), metric::area(after) / metric::area(before) / scale_sq]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_square_that_is_widened_in_one_half() {
        let square = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0), (2.0, 2.0)].map(|(x, y)| DVec3::new(x, y, 0.0));
        let triangles = [[0, 1, 2], [0, 2, 3], [4, 4, 4]];
        let values = fields(&triangles, &square, &square.map(|p| p * 3.0));
        assert!(values[..2].iter().flatten().zip([1.0, 0.0, 1.0].iter().cycle()).all(|(a, b)| (a - b).abs() < 1e-6));
        assert!(values[2].iter().all(|x| x.is_nan()));
        let wide = fields(&triangles[..2], &square, &square.map(|p| DVec3::new(2.0 * p.x, p.y, 0.0)));
        assert!((wide[0][0] - (2.5f64 / 2.0).sqrt()).abs() < 1e-12 && (wide[0][2] - 1.0).abs() < 1e-12);
    }
}
