//! The suite that every Rayweave evaluator passes.
