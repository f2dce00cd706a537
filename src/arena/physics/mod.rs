//! The maze as a physics simulation.
