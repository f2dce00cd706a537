//! The comment that an exported file begins with.

use super::{Provenance, QuantisedPolicy};

/// How a language writes comments.
pub(super) struct Comments {
    /// What each line begins with.
    line: &'static str,
    /// What parts a sentence that is too long for one line of some languages.
    fold: &'static str,
    /// How far lists stand to the right.
    indent: &'static str,
}

pub(super) const C: Comments = Comments {
    line: " * ",
    fold: "\n",
    indent: "  ",
};

pub(super) const RUST: Comments = Comments {
    line: "// ",
    fold: " ",
    indent: "",
};

pub(super) const PYTHON: Comments = Comments {
    line: "# ",
    fold: " ",
    indent: "",
};

impl Comments {
    /// A text as lines of a comment.
    pub fn of(&self, text: &str) -> String {
        let line = |line| format!("{}{line}", self.line).trim_end().to_owned() + "\n";
        text.lines().map(line).collect()
    }

    /// Where the policy comes from, and how it was compared.
    pub fn head(&self, quantised: &QuantisedPolicy, provenance: &Provenance) -> String {
        self.of(&format!(
            "{}\n{} rules vote in whole numbers. Compared with the run's own{}greedy choice in {}: the same.",
            provenance.lines().join("\n"),
            quantised.votes().len(),
            self.fold,
            quantised.compared()
        ))
    }

    /// What each bit of a percept says, which has so many; `how` tells how they are numbered, `number`
    /// numbers one.
    pub fn bits(
        &self,
        width: usize,
        provenance: &Provenance,
        how: &str,
        number: impl Fn(usize) -> String,
    ) -> String {
        let bit = |bit| format!("\n{}{}  {}", self.indent, number(bit), provenance.bit(bit));
        let bits: String = (0..width).map(bit).collect();
        self.of(&format!("\nBits of a percept{how}:{bits}"))
    }

    /// The same of percepts that are bytes.
    pub fn bits_of_bytes(&self, quantised: &QuantisedPolicy, provenance: &Provenance) -> String {
        let how = "; bit i is bit i % 8 of byte i / 8";
        self.bits(quantised.width(), provenance, how, |bit| format!("{bit:3}"))
    }
}
