//! Prints the page `docs/reference/scene-keys.md`.

fn main() {
    print!("{}", steklov_document::reference());
}
