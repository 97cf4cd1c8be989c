//! Evaluators on the CPU: what a ray meets in a compiled model.
