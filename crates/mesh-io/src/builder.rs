//! Collectors that turn the vertices and faces of a file into a mesh: an indexed one and one for triangle soups.

use crate::loaded::MeshObject;
use crate::{FileError, LoadedMesh, Location, ReadOptions};
use rayweave_math::Vec3;
use rayweave_mesh::{EarBudget, Mesh, MeshError, VertexWelder, triangulate_polygon};

/// Collector for formats with numbered vertices.
pub struct MeshBuilder<'a> {
    options: &'a ReadOptions,
    pub vertices: Vec<Vec3>,
    pub triangles: Vec<[u32; 3]>,
    /// Number of faces with more than three corners that do not lie in a plane.
    non_planar: usize,
    /// For all polygons of the file together.
    ears: EarBudget,
    pub warnings: Vec<String>,
    /// Names of objects and the index of their first triangle.
    pub object_starts: Vec<(String, usize)>,
}

impl<'a> MeshBuilder<'a> {
    pub fn new(options: &'a ReadOptions) -> MeshBuilder<'a> {
        MeshBuilder {
            options,
            vertices: Vec::new(),
            triangles: Vec::new(),
            non_planar: 0,
            ears: EarBudget::default(),
            warnings: Vec::new(),
            object_starts: Vec::new(),
        }
    }

    pub fn add_vertex(&mut self, point: Vec3, location: Location) -> Result<(), FileError> {
        if !point.to_array().iter().all(|x| x.abs() <= Mesh::MAX_COORDINATE) {
            let error = MeshError::Coordinate { index: self.vertices.len(), point };
            return Err(FileError::Mesh { location, error });
        }
        self.vertices.push(point);
        check_limit(self.options, "vertices", self.vertices.len() as u64, location)
    }

    /// Adds a face with three or more corners, given as vertex indices from 0.
    pub fn add_face(&mut self, corners: &[u64], location: Location) -> Result<(), FileError> {
        let (triangle, count) = (self.triangles.len(), self.vertices.len());
        if let Some(&vertex) = corners.iter().find(|&&vertex| vertex >= count as u64) {
            return Err(FileError::Mesh { location, error: MeshError::Index { triangle, vertex, count } });
        }
        let corner = |k: usize| corners[k] as u32;
        match corners.len() {
            count @ 0..3 => {
                let problem = format!("a face has {count} corners");
                return Err(FileError::syntax(location, problem, "a face needs at least three"));
            }
            3 => self.triangles.push([0, 1, 2].map(corner)),
            _ => {
                let corners: Vec<u32> = corners.iter().map(|&vertex| vertex as u32).collect();
                let (triangles, is_plane) = triangulate_polygon(&self.vertices, &corners, &mut self.ears);
                self.non_planar += usize::from(!is_plane);
                self.triangles.extend(triangles);
            }
        }
        check_limit(self.options, "triangles", self.triangles.len() as u64, location)
    }

    /// Starts an object: the following faces belong to it.
    pub fn start_object(&mut self, name: &str) {
        self.object_starts.push((name.trim().to_owned(), self.triangles.len()));
    }

    pub fn finish(mut self, location: Location) -> Result<LoadedMesh, FileError> {
        let objects = objects(std::mem::take(&mut self.object_starts), self.triangles.len());
        if self.non_planar > 0 {
            self.warnings.push(format!(
                "{} faces with more than three corners are not planar: their triangulation is not unique",
                self.non_planar
            ));
        }
        let mesh =
            Mesh::new(self.vertices, self.triangles).map_err(|error| FileError::Mesh { location, error })?;
        Ok(LoadedMesh { mesh, warnings: self.warnings, unit: None, objects })
    }
}

/// Collector for formats that repeat the coordinates of vertices (triangle soups). Equal points become one vertex.
#[derive(Default)]
pub struct TriangleSoup {
    welder: VertexWelder,
    pub triangles: Vec<[u32; 3]>,
}

impl TriangleSoup {
    pub fn add(&mut self, corners: [Vec3; 3]) {
        let triangle = corners.map(|point| self.welder.index(point));
        self.triangles.push(triangle);
    }

    pub fn finish(
        self,
        warnings: Vec<String>,
        object_starts: Vec<(String, usize)>,
        location: Location,
    ) -> Result<LoadedMesh, FileError> {
        let objects = objects(object_starts, self.triangles.len());
        let mesh = Mesh::new(self.welder.into_vertices(), self.triangles)
            .map_err(|error| FileError::Mesh { location, error })?;
        Ok(LoadedMesh { mesh, warnings, unit: None, objects })
    }
}

/// The objects that start at these triangles; objects without triangles are left out.
pub fn objects(starts: Vec<(String, usize)>, count: usize) -> Vec<MeshObject> {
    let ends: Vec<usize> = starts.iter().skip(1).map(|(_, start)| *start).chain([count]).collect();
    let object = |((name, start), end): ((String, usize), usize)| MeshObject { name, triangles: start..end };
    starts.into_iter().zip(ends).map(object).filter(|object| !object.triangles.is_empty()).collect()
}

/// Rejects a number of vertices or triangles above the limit of the options.
pub fn check_limit(
    options: &ReadOptions,
    what: &'static str,
    count: u64,
    location: Location,
) -> Result<(), FileError> {
    let limit = options.max_elements.min(Mesh::MAX_TRIANGLES as u64);
    match count > limit {
        true => Err(FileError::Mesh { location, error: MeshError::TooMany { what, count, limit } }),
        false => Ok(()),
    }
}
