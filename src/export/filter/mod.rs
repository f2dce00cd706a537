//! The filter of misread percepts: the places that it knows as a table, and a belief over them.
//!
//! What is exported is the filter that no longer learns, as [`Frozen`](crate::agent::Frozen) has it.

pub(super) mod c99;
mod places;
pub(super) mod python;
pub(super) mod rust;
mod usage;

pub(super) use places::Filter;

/// What a filter adds to an exported file; by default nothing.
#[derive(Default)]
pub(super) struct Addition {
    /// To the comment at the beginning: how to use it, and what it takes.
    pub usage: String,
    /// To the end.
    pub code: String,
}
