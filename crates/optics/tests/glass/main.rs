//! Tests of the module `glass`.

mod dispersion;
