//! File formats over bytes.
