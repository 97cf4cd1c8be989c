//! Surfaces and primitive solids: roots along a ray, sense, normal.
