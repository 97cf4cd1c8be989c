//! Tables and ray files, through the public interface.

mod atomic;
mod csv;
mod folder;
mod npy;
#[cfg(feature = "parquet")]
mod parquet;
mod rays_csv;
mod rays_npy;
mod table;
