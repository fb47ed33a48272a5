//! The `splatline` command.

fn main() {}
