//! Studies: whole, in tasks; interrupted, mixed up, and on files that come late.

mod desk;
mod episodes;
mod extension;
#[cfg(feature = "long")]
mod late_files;
mod own_agents;
mod reports;
#[cfg(all(unix, feature = "long"))]
mod sharing;
mod studies;
#[cfg(unix)]
mod tasks;
