//! Placements from files in the folder of the model.

use npyz::WriterBuilder;
use rayweave_math::{Affine, Vec3};
use rayweave_model::Solid;
use rayweave_scene::{Diagnostics, Scene, load};
use std::path::{Path, PathBuf};

const MODEL: &str = "rayweave = 1\n[solid.s]\nsphere = { radius = 1 }\n\
    [solid.p]\nplace = { solid = 's', file = 'maps.npy' }\n";

/// A temporary folder for each test, removed at the end.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Folder {
        let path = std::env::temp_dir().join(format!("rayweave-files-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&path).unwrap();
        std::fs::write(path.join("model.toml"), MODEL).unwrap();
        Folder(path)
    }

    fn maps(&self) -> PathBuf {
        self.0.join("maps.npy")
    }

    fn load(&self) -> Result<Scene, Diagnostics> {
        load(self.0.join("model.toml"), &[]).map(|(_, scene)| scene)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

fn write<T: npyz::AutoSerialize + Copy>(path: &Path, shape: &[u64], order: npyz::Order, numbers: &[T]) {
    let options = npyz::WriteOptions::new().default_dtype().shape(shape).order(order);
    let mut writer = options.writer(std::fs::File::create(path).unwrap()).begin_nd().unwrap();
    writer.extend(numbers.iter().copied()).unwrap();
    writer.finish().unwrap();
}

fn expected(maps: Vec<Affine>) -> Solid {
    let ball: Solid = rayweave_shape::primitive::build("sphere", &[("radius", 1.0.into())]).unwrap().into();
    ball.named("s").place(maps).named("p")
}

#[test]
fn translations_and_matrices() {
    let folder = Folder::new("good");
    write(&folder.maps(), &[2, 3], npyz::Order::C, &[1.0, 2.0, 3.0, -4.0, 0.5, 1e9]);
    let maps = [Vec3::new(1.0, 2.0, 3.0), Vec3::new(-4.0, 0.5, 1e9)].map(Affine::translate);
    assert_eq!(folder.load().unwrap().solid("p"), Some(&expected(maps.to_vec())));
    let turn = Affine::rotation(Vec3::ONE, 40.0).then(&Affine::translate(Vec3::X));
    let numbers = turn.to_rows().concat();
    write(&folder.maps(), &[1, 4, 4], npyz::Order::C, &numbers);
    assert_eq!(folder.load().unwrap().solid("p"), Some(&expected(vec![turn])));
    write::<f64>(&folder.maps(), &[0, 3], npyz::Order::C, &[]);
    assert_eq!(folder.load().unwrap().solid("p"), Some(&expected(vec![])));
}

#[test]
fn invalid_placement_files_are_rejected() {
    let folder = Folder::new("bad");
    let check = |expected: &str| {
        let problems = folder.load().unwrap_err();
        let found: Vec<&str> = problems.iter().map(|problem| problem.message()).collect();
        assert_eq!(found, [format!("the placements in `maps.npy` cannot be used: {expected}.")]);
    };
    check("there is no such file");
    write(&folder.maps(), &[2, 2], npyz::Order::C, &[1.0; 4]);
    check("its shape is [2, 2], but it must be (N, 3) or (N, 4, 4)");
    write(&folder.maps(), &[1, 3], npyz::Order::C, &[1.0f32; 3]);
    check("its numbers are <f4, but must be float64");
    write(&folder.maps(), &[2, 3], npyz::Order::Fortran, &[1.0; 6]);
    check("its order is Fortran's, but must be C");
    write(&folder.maps(), &[2, 3], npyz::Order::C, &[1.0, 2.0, 3.0, 4.0, f64::NAN, 6.0]);
    check("transform 1 of the file: the transform has an entry that is NaN or infinite");
    write(&folder.maps(), &[1, 4, 4], npyz::Order::C, &[1.0; 16]);
    check("the last row of matrix 0 is not 0, 0, 0, 1");
    write(&folder.maps(), &[2, 3], npyz::Order::C, &[1.0; 6]);
    let whole = std::fs::read(folder.maps()).unwrap();
    std::fs::write(folder.maps(), &whole[..whole.len() - 8]).unwrap();
    check("it ends too early");
    let header = String::from_utf8_lossy(&whole[..128]).replace("(2, 3)", "(9999999999, 3)");
    std::fs::write(folder.maps(), header.as_bytes()).unwrap();
    assert!(folder.load().is_err());
    std::fs::write(folder.maps(), b"not an array").unwrap();
    assert!(folder.load().unwrap_err().to_string().contains("not an NPY file"));
    std::fs::write(folder.maps(), b"").unwrap();
    assert!(folder.load().is_err());
}

const CUBE: &str = "OFF\n8 6 0\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 0 1\n1 0 1\n0 1 1\n1 1 1\n\
    4 0 2 3 1\n4 4 5 7 6\n4 0 1 5 4\n4 2 6 7 3\n4 0 4 6 2\n4 1 3 7 5\n";

/// The problems of a model whose mesh is in a file with this text.
fn mesh_problems(name: &str, text: &str) -> Result<Scene, String> {
    let folder = Folder::new(&format!("mesh-{name}"));
    std::fs::write(folder.0.join("part.off"), text).unwrap();
    let model = "rayweave = 1\n[solid.part]\nmesh = { file = 'part.off' }\n";
    std::fs::write(folder.0.join("model.toml"), model).unwrap();
    folder.load().map_err(|problems| problems.to_string())
}

#[test]
fn meshes_come_from_files_in_the_folder_of_the_model() {
    let scene = mesh_problems("mesh", CUBE).unwrap();
    let corners =
        CUBE.lines().skip(2).take(8).map(|line| line.split(' ').map(|x| x.parse().unwrap()).collect());
    let corners: Vec<Vec<f64>> = corners.collect();
    let arguments = scene.regions[0].solid.to_string();
    assert!(corners.iter().all(|corner| arguments.contains(&format!("{corner:?}"))), "{arguments}");
    // first a face is missing; then a face refers to a vertex that does not exist
    let open = mesh_problems("open", &CUBE.replace("8 6 0", "8 5 0")).unwrap_err();
    assert!(
        open.contains("the mesh in `part.off` is not a solid: the mesh is not closed: 4 edges"),
        "{open}"
    );
    assert!(open.contains("holes: 1 (the first: (1, 0.5, 0.5), 4 edges)"), "{open}");
    let bad = mesh_problems("bad", &CUBE.replace("4 1 3 7 5", "4 1 3 8 5")).unwrap_err();
    assert!(bad.contains("line 16: triangle 10 refers to vertex 8"), "{bad}");
}

#[test]
fn a_mesh_has_a_file_or_its_numbers() {
    let problem = |table: &str| {
        let text = format!("rayweave = 1\n[solid.part]\nmesh = {table}\n");
        rayweave_scene::parse(&text).unwrap_err().to_string()
    };
    assert!(problem("{ file = 'nowhere.stl' }").contains("there is no such file"));
    assert!(problem("{ file = 'part.xyz' }").contains("is unknown: the known extensions are"));
    assert!(problem("{ file = 'part.off', repair = 1 }").contains("true or false"));
    assert!(problem("{ file = 3 }").contains("the name of a file"));
    let both = problem("{ file = 'part.stl', vertices = [[0, 0, 0]] }");
    assert!(both.contains("cannot be combined with `file`"), "{both}");
}
