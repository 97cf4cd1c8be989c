//! Queries of trees against brute force and against an oracle in rational numbers.

mod common;
mod points;
mod rays;
mod streams;
