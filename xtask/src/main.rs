//! Chores of the repository: tests, tidy checks, layers, new primitives.

fn main() {}
