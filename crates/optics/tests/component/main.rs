//! Components against closed forms, through the engine.

mod concentrators;
mod lenses;
mod mirrors;
mod prisms;
mod probe;
mod pyrayt;
mod sheets;
