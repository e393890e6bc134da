//! The program: arguments to one of its jobs. See `cli`.

fn main() {}
