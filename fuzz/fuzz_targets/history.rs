//! Any bytes as `history`: refused, or held together.

#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| mt_tests::chew::by_name("history")(bytes));
