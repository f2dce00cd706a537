//! JSON of bounded size.

/// The longest JSON text that is held as a tree, which takes up to thirty times as much. Layouts and
/// messages of ours are far shorter.
const LONGEST_TREE: usize = 1 << 20;

/// A JSON text as a tree; `None` for what is none, or too long to be held so.
pub fn json_tree(text: &[u8]) -> Option<serde_json::Value> {
    (text.len() <= LONGEST_TREE).then(|| serde_json::from_slice(text).ok())?
}
