//! Tables of results: CSV, NPY and Parquet, written in chunks and renamed when complete.
