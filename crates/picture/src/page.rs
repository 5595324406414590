//! The style of pages with pictures, and images inside them.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

/// The style of a page, light and dark: cards are sections, `.pictures` is a grid of pictures, `.wide` an element that
/// may be wider than the page.
pub const STYLE: &str = include_str!("page.css");

/// The bytes of a picture of a kind, `svg+xml` or `png`, as the source of an image that is not loaded.
pub fn data_uri(kind: &str, bytes: impl AsRef<[u8]>) -> String {
    format!("data:image/{kind};base64,{}", STANDARD.encode(bytes))
}
