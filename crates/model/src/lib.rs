//! Solids as boolean expressions, compiled once into a flat program.
