//! Features walk to their places through the disc itself, the mesh giving way: no vertex is added.
//!
//! Each step is the Newton step of the relaxation with the features' ways prescribed, cut back before any triangle folds.
//! Where features would have to pass each other the way ends early; what is left is for the base mesh to warp.

use super::relax::pull;
use super::sheet::Sheet;
use crate::error::Result;
use crate::gpu::Compute;

/// Steps at most.
const STEPS: usize = 40;
/// A step of a smaller share of the way is a slow one.
const SLOW: f64 = 0.03;
/// So many slow steps end the walk.
const PATIENCE: usize = 4;

/// Walks as far as it goes; true if all features are at their places, exactly.
pub fn walk(sheet: &mut Sheet, compute: &Compute) -> Result<bool> {
    let even = vec![1.0; sheet.triangles.len()];
    let mut slow = 0;
    for _ in 0..STEPS {
        if sheet.is_met() {
            return Ok(true);
        }
        if pull(sheet, compute, &even)? < SLOW {
            slow += 1;
            if slow > PATIENCE {
                break;
            }
        }
    }
    Ok(sheet.is_met())
}
