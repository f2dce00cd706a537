//! What is learned, how, how well, and what becomes of it.

mod ceilings;
mod driving;
mod examples;
mod exporting;
mod history;
mod knowledge;
mod learned;
mod mechanisms;
mod paper;
mod readings;
mod readme;
mod rules;
mod rules_decide;
mod trust;
mod xcs_invariants;
