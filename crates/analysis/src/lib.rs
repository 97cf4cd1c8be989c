//! Questions about geometry, asked of any evaluator.
