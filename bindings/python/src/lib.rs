//! The Python package rayweave.
