//! JSON of bounded size.

/// The longest JSON text that is parsed into a tree. The tree takes up to thirty times as much
/// memory. Our layouts and messages are far shorter.
const MAX_TREE_BYTES: usize = 1 << 20;

/// Parses a JSON text. Returns `None` if the text is invalid or too long.
pub fn json_tree(text: &[u8]) -> Option<serde_json::Value> {
    (text.len() <= MAX_TREE_BYTES).then(|| serde_json::from_slice(text).ok())?
}
