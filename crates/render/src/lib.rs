//! Pictures of models: cameras, shading, edges, depth, normals, ids.
