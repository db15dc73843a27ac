//! Images that a glTF file can hold, as the bytes of their own files.

/// The first bytes of the two formats, and their names.
const FORMATS: [(&[u8], &str); 2] = [(b"\x89PNG\r\n\x1a\n", "image/png"), (b"\xff\xd8\xff", "image/jpeg")];

/// A PNG or JPEG file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TextureImage {
    bytes: Vec<u8>,
    mime_type: &'static str,
}

impl TextureImage {
    /// The file with these bytes; None if they do not begin like PNG or JPEG.
    pub fn new(bytes: Vec<u8>) -> Option<Self> {
        let mime_type = FORMATS.iter().find(|(magic, _)| bytes.starts_with(magic))?.1;
        Some(TextureImage { bytes, mime_type })
    }

    /// The bytes of the file.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// `image/png` or `image/jpeg`.
    pub fn mime_type(&self) -> &'static str {
        self.mime_type
    }
}
