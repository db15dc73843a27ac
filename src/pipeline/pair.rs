//! A pair on its way through the stages.

use super::job::Outputs;
use crate::error::Result;
use crate::mesh::simplify::Simplified;
use crate::stage::check::Checked;

/// What every stage may look at, and what the last stage made.
pub struct Pair<T> {
    /// What is wanted of the map.
    pub outputs: Outputs,
    /// The meshes and landmarks.
    pub checked: Checked,
    /// What the meshes were simplified from, while the stages see simple ones.
    pub whole: Option<Box<Whole>>,
    /// The product of the last stage.
    pub made: T,
}

/// A pair as it was given, and the way there from the simple one.
pub struct Whole {
    /// The meshes and landmarks.
    pub checked: Checked,
    /// Both simplified meshes.
    pub simplified: [Simplified; 2],
}

impl<T> Pair<T> {
    /// Puts the product of the next stage in the place of the last one's.
    pub fn then<U>(self, stage: impl FnOnce(&Checked, T) -> Result<U>) -> Result<Pair<U>> {
        let made = stage(&self.checked, self.made)?;
        Ok(Pair { outputs: self.outputs, checked: self.checked, whole: self.whole, made })
    }
}
