//! Jobs beside the main one: they start from a finished map, or reuse the rooms that make it.
//!
//! | job | what |
//! | --- | --- |
//! | [`rebuild`] | a geometry image read back as a watertight mesh |

pub mod rebuild;
mod whole_file;
