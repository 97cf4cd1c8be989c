//! Exact ray tracing through constructive solid geometry.
