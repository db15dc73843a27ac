//! What a job's results depend on, in one number: the bytes of its inputs, the options and the version. Not where the files
//! lie, and not the device, which makes no difference beyond its tolerance.

use crate::error::{Error, Result};
use crate::pipeline::inputs::files_behind;
use crate::pipeline::job::{MapJob, MapOptions};
use serde::{Deserialize, Serialize};
use std::collections::HashMap;
use std::fmt;
use std::fs::File;
use std::path::{Path, PathBuf};

/// The file in a job's folder that holds its fingerprint.
pub const SEAL_FILE: &str = "job.json";

/// A job's fingerprint.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fingerprint(blake3::Hash);

/// The content of [`SEAL_FILE`].
#[derive(Serialize, Deserialize)]
struct Seal {
    id: String,
    version: String,
    fingerprint: String,
}

impl Fingerprint {
    /// The file that marks results as the job's: its name and its bytes.
    pub fn seal(&self, id: &str) -> (String, Vec<u8>) {
        let seal =
            Seal { id: id.to_owned(), version: env!("CARGO_PKG_VERSION").to_owned(), fingerprint: self.to_string() };
        let mut bytes = serde_json::to_vec_pretty(&seal).expect("three strings by name");
        bytes.push(b'\n');
        (SEAL_FILE.to_owned(), bytes)
    }

    /// True if the content of a [`SEAL_FILE`] bears this fingerprint.
    pub fn is_sealed_by(&self, seal: &[u8]) -> bool {
        serde_json::from_slice(seal).is_ok_and(|seal: Seal| seal.fingerprint == self.to_string())
    }
}

impl fmt::Display for Fingerprint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.0.to_hex().as_str())
    }
}

/// Takes fingerprints; a file that several jobs share is read once.
pub struct Fingerprints {
    common: String,
    known: HashMap<PathBuf, blake3::Hash>,
}

impl Fingerprints {
    /// For jobs with these options.
    pub fn new(options: &MapOptions) -> Self {
        // What `Debug` prints may change with the version, which is part of the fingerprint anyway.
        let common = format!("homeo {} {options:?}", env!("CARGO_PKG_VERSION"));
        Fingerprints { common, known: HashMap::new() }
    }

    /// The fingerprint of a job.
    ///
    /// # Errors
    /// Input, if one of its files cannot be read.
    pub fn of(&mut self, job: &MapJob) -> Result<Fingerprint> {
        let MapJob { source, target, landmarks, target_landmarks, hint, texture, out: _ } = job;
        let mut hasher = blake3::Hasher::new();
        hasher.update(self.common.as_bytes());
        let roles = [
            ("source", Some(source)),
            ("target", Some(target)),
            ("landmarks", Some(landmarks)),
            ("target_landmarks", target_landmarks.as_ref()),
            ("hint", hint.as_ref()),
            ("texture", texture.as_ref()),
        ];
        for (role, path) in roles.into_iter().filter_map(|(role, path)| Some((role, path?))) {
            for file in files_behind(path)? {
                // The extension tells the format; where the file lies makes no difference.
                let extension = file.extension().unwrap_or_default().to_string_lossy();
                hasher.update(format!("\n{role} {extension} ").as_bytes());
                hasher.update(self.content(&file)?.as_bytes());
            }
        }
        Ok(Fingerprint(hasher.finalize()))
    }

    fn content(&mut self, path: &Path) -> Result<blake3::Hash> {
        if let Some(known) = self.known.get(path) {
            return Ok(*known);
        }
        let mut hasher = blake3::Hasher::new();
        let read = File::open(path).and_then(|file| hasher.update_reader(file).map(|_| ()));
        read.map_err(|e| Error::io(path, &e))?;
        let hash = hasher.finalize();
        self.known.insert(path.to_owned(), hash);
        Ok(hash)
    }
}
