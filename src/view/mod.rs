//! What people look at: pages that open from disk, offline, in any browser, and the previews beside them.
//!
//! ```text
//! a finished map                                        map::product
//!    | turned to the viewer, measured by triangle        frame, fields
//!    |------ preview ---> preview.png                    preview, scale, palette
//!    v
//!  Scene   surfaces, panels, marks                       map_scene, surface, carried_uv, image
//!    | stand-ins where it is too large for a page        stand_in
//!    | packed                                            surface, base64
//!    v
//!  Page    the viewer, cards with the numbers            page, map_page, cards, web/viewer/
//!    v
//! report.html
//!
//! rows of a batch --- batch ---> batch.html              web/batch/
//! ```
//!
//! Every page is one self-contained file. Text from outside is escaped wherever it goes (`html`); no page names an address.
//! Apart from times and the command the same result gives the same bytes, on any number of threads.

mod base64;
pub mod batch;
pub mod cards;
mod carried_uv;
pub mod fields;
pub mod frame;
mod html;
pub mod image;
pub mod map_page;
mod map_scene;
pub mod page;
mod palette;
mod preview;
mod scale;
pub mod scene;
pub mod stand_in;
pub mod surface;

pub use batch::{BatchRow, BatchStatus, batch_page};
pub use map_page::MapPictures;
