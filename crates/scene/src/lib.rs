//! Model files: documents, diagnostics with source spans, the native TOML format.
