//! Images of plain numbers: depth, normals and ids.

use crate::columns::Columns;
use crate::extent::{Extent, TileSize};
use crate::sample::PicturePoints;
use crate::{Camera, PixelGrid, RenderError, Run, Size, sweep};
use fearless_simd::Level;
use rayweave_model::{Evaluator, LeafKind, Program};

/// The kind of id that [`ids`] returns.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum IdKind {
    /// The number of the region, from 1; 0, the world's number, for a miss.
    #[default]
    Region,
    /// The number of the leaf ([`rayweave_model::LeafId`]), from 0; -1 for a miss.
    Leaf,
    /// The number of the face in [`rayweave_model::Program::facets`], from 0; -1 for a miss.
    Face,
    /// The number of the placement ([`rayweave_model::PlacementId`]), from 0 for the model itself; -1 for a
    /// miss.
    Placement,
}

/// The distance to the first surface at the centre of each pixel: t along the unit ray of the camera
/// ([`Camera::ray`]), > 0; +inf for a miss.
///
/// # Errors
/// The run was cancelled.
pub fn depth<E: Evaluator>(
    evaluator: &E,
    camera: &Camera,
    size: Size,
    run: &mut Run<'_>,
) -> Result<PixelGrid<f64>, RenderError> {
    let mut depth = PixelGrid::filled(size, f64::INFINITY);
    let bands = Bands { evaluator, camera, size, with_normals: false };
    bands.trace(run, bands.of(&mut depth), |depth, at, rays, i| depth[at] = rays.hits.t[i])?;
    Ok(depth)
}

/// The unit normal of the first surface at the centre of each pixel, outward of the solid that is entered or
/// left: towards the camera where it sees a region from outside, away from it where it looks out of a region
/// into the world. NaN for a miss.
///
/// # Errors
/// The run was cancelled.
pub fn normals<E: Evaluator>(
    evaluator: &E,
    camera: &Camera,
    size: Size,
    run: &mut Run<'_>,
) -> Result<PixelGrid<[f64; 3]>, RenderError> {
    let mut normals = PixelGrid::filled(size, [f64::NAN; 3]);
    let bands = Bands { evaluator, camera, size, with_normals: true };
    bands.trace(run, bands.of(&mut normals), |normals, at, rays, i| {
        normals[at] = rays.normal(i).to_array();
    })?;
    Ok(normals)
}

/// The id of the first surface at the centre of each pixel; see [`IdKind`].
///
/// # Errors
/// The run was cancelled.
pub fn ids<E: Evaluator>(
    evaluator: &E,
    camera: &Camera,
    size: Size,
    kind: IdKind,
    run: &mut Run<'_>,
) -> Result<PixelGrid<i32>, RenderError> {
    let numbers = Numbers::new(kind, evaluator.program());
    let mut ids = PixelGrid::filled(size, numbers.miss());
    let bands = Bands { evaluator, camera, size, with_normals: false };
    bands.trace(run, bands.of(&mut ids), |ids, at, rays, i| ids[at] = numbers.of(rays, i))?;
    Ok(ids)
}

/// Depth, normal and id of the first surface at the centre of each pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct Geometry {
    /// See [`depth`].
    pub depth: PixelGrid<f64>,
    /// See [`normals`].
    pub normals: PixelGrid<[f64; 3]>,
    /// See [`ids`].
    pub ids: PixelGrid<i32>,
}

/// [`depth`], [`normals`] and [`ids`] in one pass.
///
/// # Errors
/// The run was cancelled.
pub fn geometry<E: Evaluator>(
    evaluator: &E,
    camera: &Camera,
    size: Size,
    kind: IdKind,
    run: &mut Run<'_>,
) -> Result<Geometry, RenderError> {
    let numbers = Numbers::new(kind, evaluator.program());
    let mut all = Geometry {
        depth: PixelGrid::filled(size, f64::INFINITY),
        normals: PixelGrid::filled(size, [f64::NAN; 3]),
        ids: PixelGrid::filled(size, numbers.miss()),
    };
    let bands = Bands { evaluator, camera, size, with_normals: true };
    let pieces = bands.of(&mut all.depth).zip(bands.of(&mut all.normals)).zip(bands.of(&mut all.ids));
    bands.trace(run, pieces, |((depth, normals), ids), at, rays, i| {
        depth[at] = rays.hits.t[i];
        normals[at] = rays.normal(i).to_array();
        ids[at] = numbers.of(rays, i);
    })?;
    Ok(all)
}

/// The ids of one kind.
struct Numbers {
    kind: IdKind,
    /// The leaf of each face, for [`IdKind::Leaf`].
    leaves: Vec<i32>,
}

impl Numbers {
    fn new(kind: IdKind, program: &Program) -> Numbers {
        let mut leaves = Vec::new();
        if kind == IdKind::Leaf {
            leaves.resize(program.facets().len(), -1);
            for leaf in program.leaves() {
                if let LeafKind::Shape { facets } = leaf.kind() {
                    leaves[facets.start as usize..facets.end as usize].fill(leaf.id().0 as i32);
                }
            }
        }
        Numbers { kind, leaves }
    }

    fn miss(&self) -> i32 {
        match self.kind {
            IdKind::Region => 0,
            IdKind::Leaf | IdKind::Face | IdKind::Placement => -1,
        }
    }

    /// The id of a ray that hits something. (Compiling rejects models with more than 2^31 objects of any
    /// kind.)
    #[inline]
    fn of(&self, rays: &Columns, i: usize) -> i32 {
        match self.kind {
            IdKind::Region => rays.seen(i).0 as i32,
            IdKind::Leaf => self.leaves[rays.hits.face[i] as usize],
            IdKind::Face => rays.hits.face[i],
            IdKind::Placement => rays.hits.placement[i] as i32,
        }
    }
}

/// One ray per pixel, in bands of rows.
struct Bands<'a, E> {
    evaluator: &'a E,
    camera: &'a Camera,
    size: Size,
    with_normals: bool,
}

impl<E: Evaluator> Bands<'_, E> {
    fn tiles(&self) -> TileSize {
        TileSize::new(self.evaluator.preferred_batch(), self.size)
    }

    /// Splits a plane into bands.
    fn of<'p, T>(&self, plane: &'p mut PixelGrid<T>) -> std::slice::ChunksMut<'p, T> {
        plane.values_mut().chunks_mut(self.tiles().height * self.size.width())
    }

    /// Calls `put` for each pixel whose ray hits something, with its band, its index in the band, the rays with their hits,
    /// and the index of its ray there.
    fn trace<B: Send>(
        &self,
        run: &mut Run<'_>,
        bands: impl ExactSizeIterator<Item = B> + Send,
        put: impl Fn(&mut B, usize, &Columns, usize) + Sync,
    ) -> Result<(), RenderError> {
        let extent = Extent::new(self.camera, self.size, &self.evaluator.program().bounds());
        let (width, height, level) = (self.size.width(), self.size.height(), Level::new());
        let tiles = self.tiles();
        let scratch = || (self.evaluator.scratch(), Columns::default(), PicturePoints::default());
        run.each(0.0..1.0, bands.enumerate(), scratch, |(scratch, rays, points), (number, mut band)| {
            let first = number * tiles.height;
            for tile in extent.tiles(tiles, first..(first + tiles.height).min(height)) {
                tile.centres(width, points);
                sweep::rays(level, self.camera, self.size, &points.places, rays);
                let pixels = points.rays(self.camera.pixel_camera(self.size));
                rays.trace_pixels(self.evaluator, &pixels, self.with_normals, scratch);
                let mut ray = 0;
                for part in &tile.parts {
                    for x in part.columns.clone() {
                        if rays.is_hit(ray) {
                            put(&mut band, (part.row - first) * width + x, rays, ray);
                        }
                        ray += 1;
                    }
                }
            }
        })
    }
}
