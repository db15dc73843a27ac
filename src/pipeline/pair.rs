//! A pair on its way through the stages.

use super::job::Outputs;
use crate::error::Result;
use crate::stage::check::Checked;

/// What every stage may look at, and what the last stage made.
pub struct Pair<T> {
    /// What is wanted of the map.
    pub outputs: Outputs,
    /// The meshes and landmarks.
    pub checked: Checked,
    /// The product of the last stage.
    pub made: T,
}

impl<T> Pair<T> {
    /// Puts the product of the next stage in the place of the last one's.
    pub fn then<U>(self, stage: impl FnOnce(&Checked, T) -> Result<U>) -> Result<Pair<U>> {
        let made = stage(&self.checked, self.made)?;
        Ok(Pair { outputs: self.outputs, checked: self.checked, made })
    }
}
