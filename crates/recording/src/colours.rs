//! The colours of actions, in drawings and pictures.

/// Colours of best actions as `0xRRGGBB`, by distance to the goal along the policy: far, halfway,
/// near. Their lightness decreases, so that the order is visible to colour-blind viewers.
pub const SCALE: [u32; 3] = [0xe6ac00, 0x1f8f8a, 0x45106b];
/// The colour of best actions that do not lead to a goal, as `0xRRGGBB`.
pub const NO_GOAL: u32 = 0x9aa3b0;
/// The colour of action values below 0, as `0xRRGGBB`.
pub const BELOW: u32 = 0xc8352b;
/// The colour of action values above 0, as `0xRRGGBB`.
pub const ABOVE: u32 = 0x2f6fd6;
