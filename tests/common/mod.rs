//! What several tests share. Not every test uses all of it.
#![allow(dead_code)]

pub mod scripted;
pub mod trial;
