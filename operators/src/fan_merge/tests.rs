//! Laws of fan-merge.
