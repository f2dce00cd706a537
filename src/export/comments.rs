//! The leading comment of an exported file.

use super::{Provenance, QuantisedPolicy};

/// The comment syntax of a language.
pub(super) struct Comments {
    /// The prefix of each line.
    line: &'static str,
    /// The separator where a sentence is too long for one line in some languages.
    fold: &'static str,
    /// The indentation of lists.
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
    /// Formats a text as comment lines.
    pub fn of(&self, text: &str) -> String {
        let line = |line| format!("{}{line}", self.line).trim_end().to_owned() + "\n";
        text.lines().map(line).collect()
    }

    /// Returns the origin of the policy and the result of the comparison.
    pub fn head(&self, quantised: &QuantisedPolicy, provenance: &Provenance) -> String {
        self.of(&format!(
            "{}\n{} rules vote with integers. Compared with the run's own{}greedy choice in {}: the same.",
            provenance.lines().join("\n"),
            quantised.votes().len(),
            self.fold,
            quantised.compared()
        ))
    }

    /// Lists the meaning of each of the `width` bits of a percept. `how` describes the numbering,
    /// and `number` formats the number of a bit.
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

    /// Like [`Self::bits`], for percepts that are bytes.
    pub fn bits_of_bytes(&self, quantised: &QuantisedPolicy, provenance: &Provenance) -> String {
        let how = "; bit i is bit i % 8 of byte i / 8";
        self.bits(quantised.width(), provenance, how, |bit| format!("{bit:3}"))
    }
}
