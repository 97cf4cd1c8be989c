//! Components against closed forms, through the engine.

mod arrays;
mod concentrators;
mod lenses;
mod light;
mod mirrors;
mod prisms;
mod probe;
mod pyrayt;
mod sheets;
mod spectrum;
mod torics;
