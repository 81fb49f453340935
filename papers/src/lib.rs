//! The study engine and the reproduced papers, with what they measure and draw with.

pub mod distance;
pub mod html;
pub mod plot;
pub mod study;
