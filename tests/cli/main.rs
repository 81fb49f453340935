//! The command `mtess` as a user meets it: every test runs the program itself, on meshes made for it, in a folder of
//! its own.

mod bisecting;
mod building;
mod extracting;
mod interrupting;
mod keeping;
mod kit;
mod looking;
mod refusing;
mod reproducing;
mod studying;
mod verifying;
