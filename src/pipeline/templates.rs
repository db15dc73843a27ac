//! Source meshes that several jobs share, such as one template for many targets: each is read and checked once.

use super::job::MapJob;
use crate::error::Result;
use crate::mesh::io::{MeshFile, read_mesh};
use crate::stage::check::{LoadedMesh, inspect};
use std::collections::{HashSet, VecDeque};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

/// So many are kept, the least recently used is dropped for another: more cost memory that the jobs' budget does not see.
const KEPT: usize = 4;

/// The meshes at hand; as a default none is shared.
#[derive(Default)]
pub struct Templates {
    shared: HashSet<PathBuf>,
    /// The most recently used last.
    kept: Mutex<VecDeque<(PathBuf, Arc<Template>)>>,
}

#[derive(Default)]
struct Template {
    file: OnceLock<Result<MeshFile>>,
    checked: OnceLock<Result<LoadedMesh>>,
}

impl Templates {
    /// The sources that more than one of the jobs has.
    pub fn shared_by<'a>(jobs: impl IntoIterator<Item = &'a MapJob>) -> Self {
        let mut seen = HashSet::new();
        let again = jobs.into_iter().filter(|job| !seen.insert(&job.source));
        Templates { shared: again.map(|job| job.source.clone()).collect(), kept: Mutex::default() }
    }

    /// The mesh at `path`, if it is shared: read now or before.
    ///
    /// Not to be called on a thread of rayon's pool, which may take up another job while it reads, and wait for itself.
    pub fn read(&self, path: &Path) -> Option<Result<MeshFile>> {
        let template = self.template(path)?;
        Some(template.file.get_or_init(|| read_mesh(path)).clone())
    }

    /// What the check says of a mesh, if it is shared: now or before. Not on a thread of rayon's pool either.
    pub fn inspect(&self, file: &MeshFile) -> Option<Result<LoadedMesh>> {
        let template = self.template(&file.path)?;
        Some(template.checked.get_or_init(|| inspect(file.clone())).clone())
    }

    fn template(&self, path: &Path) -> Option<Arc<Template>> {
        if !self.shared.contains(path) {
            return None;
        }
        let mut kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        let place = kept.iter().position(|(known, _)| known == path);
        let entry = place.and_then(|i| kept.remove(i)).unwrap_or_else(|| (path.to_owned(), Arc::default()));
        let template = entry.1.clone();
        kept.push_back(entry);
        if kept.len() > KEPT {
            kept.pop_front();
        }
        Some(template)
    }
}
