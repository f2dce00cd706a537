//! The program as its users run it, on whatever files, disks and arguments.

#[cfg(all(unix, feature = "long"))]
mod budget;
mod command_line;
mod config;
mod disks;
#[cfg(feature = "long")]
mod docs;
mod escapes;
#[cfg(feature = "long")]
mod extremes;
mod faults;
mod hostile;
mod overwriting;
mod interrupted;
mod resume;
mod robustness;
mod signals;
mod train;
#[cfg(all(unix, feature = "long"))]
mod unpacked;
