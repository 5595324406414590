//! What pages with pictures share.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

/// The style of a page, light and dark: cards are sections, `.pictures` a grid of them, `.wide` what may be wider than the page.
pub const STYLE: &str = include_str!("page.css");

/// The bytes of a picture of a kind, `svg+xml` or `png`, as the source of an image that is not loaded.
pub fn data_uri(kind: &str, bytes: impl AsRef<[u8]>) -> String {
    format!("data:image/{kind};base64,{}", STANDARD.encode(bytes))
}
