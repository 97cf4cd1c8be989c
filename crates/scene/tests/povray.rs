//! POV-Ray export: a small parser reads the text back, and random points are compared with the
//! solids.

use rand::{RngExt, SeedableRng, rngs::ChaCha8Rng};
use rayweave_math::{Affine, Mat3, Vec3};
use rayweave_model::{Evaluator, Program, Solid};
use rayweave_scene::{Scene, SceneRegion, parse};
use rayweave_shape::primitive::Primitive;
use rayweave_trace::Weave;
use std::sync::Arc;

/// A POV-Ray object that supports membership tests.
#[derive(Debug)]
enum Object {
    Sphere(Vec3, f64),
    Box(Vec3, Vec3),
    Plane(Vec3, f64),
    /// Base point and radius, cap point and radius.
    Cone([(Vec3, f64); 2]),
    Torus(f64, f64),
    /// Squares, mixed products (xy, xz, yz), linear factors, constant.
    Quadric([Vec3; 3], f64),
    /// Corners of triangles.
    Mesh(Vec<[Vec3; 3]>),
    Union(Vec<Object>),
    Intersection(Vec<Object>),
    Difference(Vec<Object>),
    /// `p -> inner(map^-1 p)`.
    Moved(Affine, Box<Object>),
    Inverse(Box<Object>),
}

impl Object {
    fn holds(&self, p: Vec3) -> bool {
        match self {
            Object::Sphere(centre, radius) => p.distance(*centre) < *radius,
            Object::Box(lo, hi) => p.cmpgt(*lo).all() && p.cmplt(*hi).all(),
            Object::Plane(normal, distance) => p.dot(*normal) < distance * normal.length(),
            Object::Cone([(base, r1), (cap, r2)]) => {
                let axis = *cap - *base;
                let part = (p - *base).dot(axis) / axis.length_squared();
                let offset = (p - *base - part * axis).length();
                part > 0.0 && part < 1.0 && offset < r1 + part * (r2 - r1)
            }
            Object::Torus(major, minor) => (p.x.hypot(p.z) - major).hypot(p.y) < *minor,
            Object::Quadric([squares, mixed, linear], constant) => {
                let products = Vec3::new(p.x * p.y, p.x * p.z, p.y * p.z);
                squares.dot(p * p) + mixed.dot(products) + linear.dot(p) + constant < 0.0
            }
            Object::Mesh(triangles) => winding(triangles, p).rem_euclid(2.0) == 1.0,
            Object::Union(all) => all.iter().any(|one| one.holds(p)),
            Object::Intersection(all) => all.iter().all(|one| one.holds(p)),
            Object::Difference(all) => all[0].holds(p) && !all[1..].iter().any(|one| one.holds(p)),
            Object::Moved(map, inner) => inner.holds(map.inverse().unwrap().point(p)),
            Object::Inverse(inner) => !inner.holds(p),
        }
    }
}

/// Winding number of triangles about a point, by solid angles (A. Van Oosterom, J. Strackee, 1983).
fn winding(triangles: &[[Vec3; 3]], p: Vec3) -> f64 {
    let angle = |corners: &[Vec3; 3]| {
        let [a, b, c] = corners.map(|corner| corner - p);
        let [x, y, z] = [a, b, c].map(Vec3::length);
        let below = x * y * z + a.dot(b) * z + b.dot(c) * x + c.dot(a) * y;
        2.0 * a.dot(b.cross(c)).atan2(below)
    };
    (triangles.iter().map(angle).sum::<f64>() / (2.0 * std::f64::consts::TAU)).round()
}

/// Words, numbers and braces.
struct Reader<'a> {
    words: Vec<&'a str>,
    at: usize,
}

const KINDS: [&str; 12] = [
    "mesh2",
    "object",
    "sphere",
    "box",
    "plane",
    "cylinder",
    "cone",
    "torus",
    "quadric",
    "union",
    "intersection",
    "difference",
];

impl<'a> Reader<'a> {
    fn new(text: &'a str) -> Self {
        let words = text.split([' ', '\n', ',', '<', '>']).filter(|word| !word.is_empty()).collect();
        Reader { words, at: 0 }
    }

    fn next(&mut self) -> &'a str {
        self.at += 1;
        self.words[self.at - 1]
    }

    fn number(&mut self) -> f64 {
        let word = self.next();
        word.parse().unwrap_or_else(|_| panic!("{word} is not a number"))
    }

    fn vector(&mut self) -> Vec3 {
        Vec3::new(self.number(), self.number(), self.number())
    }

    /// Parses the object at the current position.
    fn object(&mut self) -> Object {
        let kind = self.next();
        assert_eq!(self.next(), "{");
        let own = match kind {
            "sphere" => Object::Sphere(self.vector(), self.number()),
            "box" => Object::Box(self.vector(), self.vector()),
            "plane" => Object::Plane(self.vector(), self.number()),
            "cylinder" => {
                let (base, cap, radius) = (self.vector(), self.vector(), self.number());
                Object::Cone([(base, radius), (cap, radius)])
            }
            "cone" => Object::Cone([(self.vector(), self.number()), (self.vector(), self.number())]),
            "torus" => Object::Torus(self.number(), self.number()),
            "quadric" => Object::Quadric([self.vector(), self.vector(), self.vector()], self.number()),
            "mesh2" => self.mesh(),
            "object" => self.object(),
            "union" => Object::Union(self.objects()),
            "intersection" => Object::Intersection(self.objects()),
            "difference" => Object::Difference(self.objects()),
            _ => panic!("{kind} is not an object"),
        };
        self.modified(own)
    }

    fn mesh(&mut self) -> Object {
        let list = |reader: &mut Self, name: &str| {
            assert!(reader.next() == name && reader.next() == "{");
            let count = reader.number() as usize;
            let all: Vec<Vec3> = (0..count).map(|_| reader.vector()).collect();
            assert_eq!(reader.next(), "}");
            all
        };
        let (points, faces) = (list(self, "vertex_vectors"), list(self, "face_indices"));
        assert_eq!(self.next(), "inside_vector");
        self.vector();
        Object::Mesh(faces.iter().map(|face| face.to_array().map(|k| points[k as usize])).collect())
    }

    fn objects(&mut self) -> Vec<Object> {
        let mut all = Vec::new();
        while self.words.get(self.at).is_some_and(|word| KINDS.contains(word)) {
            all.push(self.object());
        }
        all
    }

    /// Parses modifiers up to the closing brace.
    fn modified(&mut self, mut own: Object) -> Object {
        loop {
            own = match self.next() {
                "}" => return own,
                "inverse" => Object::Inverse(own.into()),
                "translate" => Object::Moved(Affine::translate(self.vector()), own.into()),
                "matrix" => {
                    let [x, y, z, t] = std::array::from_fn(|_| self.vector());
                    Object::Moved(Affine { linear: Mat3::from_cols(x, y, z), translation: t }, own.into())
                }
                "bounded_by" => {
                    assert_eq!(self.next(), "{");
                    let bounds = self.object();
                    assert_eq!(self.next(), "}");
                    Object::Intersection(vec![own, bounds])
                }
                "texture" => {
                    assert!(self.next() == "{" && self.next().starts_with("Region") && self.next() == "}");
                    own
                }
                other => panic!("{other} is not a modifier"),
            };
        }
    }
}

/// The objects of a scene: those after the last line that declares a texture.
fn read(text: &str) -> Vec<Object> {
    let start = text.rfind("};\n").unwrap() + 3;
    let mut reader = Reader::new(&text[start..]);
    let all = reader.objects();
    assert_eq!(reader.at, reader.words.len(), "{text}");
    all
}

fn scene_of(solid: Solid) -> Scene {
    let (_, mut scene) = parse("rayweave = 1\n[solid.a]\nsphere = { radius = 1 }\n").unwrap();
    let colour = scene.regions[0].colour;
    scene.regions = vec![SceneRegion { name: "all".to_owned(), solid, medium: 1, colour }];
    scene
}

fn written(solid: &Solid) -> String {
    scene_of(solid.clone()).to_povray().unwrap().text
}

/// Compares membership at random points; points within rounding of a surface are too rare to occur.
fn check(solid: &Solid, rng: &mut ChaCha8Rng) {
    let text = written(solid);
    let objects = read(&text);
    let weave = Weave::new(Arc::new(Program::compile(solid).unwrap()));
    for _ in 0..200 {
        let p = Vec3::from_array(std::array::from_fn(|_| rng.random_range(-3.0..3.0)));
        assert_eq!(
            objects.iter().any(|one| one.holds(p)),
            weave.contains(p).unwrap(),
            "{p} in {solid}:\n{text}"
        );
    }
}

fn random_map(rng: &mut ChaCha8Rng) -> Affine {
    let mut vector = || Vec3::from_array(std::array::from_fn(|_| rng.random_range(-1.0..1.0)));
    let (axis, by, factors) = (vector(), vector(), vector() + 2.0 * Vec3::ONE);
    let degrees = rng.random_range(0.0..360.0);
    let turned = Affine::rotation(axis, degrees).then(&Affine::translate(by));
    match rng.random_range(0..4) {
        0 => Affine::translate(by),
        1 => turned,
        2 => Affine::scale(Vec3::splat(factors.x)).then(&turned),
        _ => Affine::scale(factors).then(&turned),
    }
}

/// An example of each shape that POV-Ray supports; others are rejected by name.
fn examples() -> Vec<Primitive> {
    let (shown, others): (Vec<Primitive>, Vec<Primitive>) =
        Primitive::examples().into_iter().partition(|one| scene_of(one.clone().into()).to_povray().is_ok());
    for one in others {
        let problem = scene_of(one.clone().into()).to_povray().unwrap_err().to_string();
        assert!(problem.contains(&format!("`{}`: POV-Ray has no object", one.name())), "{problem}");
    }
    assert!(shown.len() >= 15, "{shown:?}");
    shown
}

#[test]
fn every_shape_under_every_kind_of_map() {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    for primitive in examples() {
        let solid = Solid::from(primitive);
        check(&solid, &mut rng);
        for _ in 0..6 {
            check(&solid.apply(random_map(&mut rng)), &mut rng);
        }
    }
}

/// A tree of random operators over random shapes.
fn random_solid(rng: &mut ChaCha8Rng, depth: u32) -> Solid {
    if depth == 0 {
        let all = examples();
        let one = all[rng.random_range(0..all.len())].clone();
        return Solid::from(one).apply(random_map(rng));
    }
    let parts: Vec<Solid> = (0..rng.random_range(0..4)).map(|_| random_solid(rng, depth - 1)).collect();
    match rng.random_range(0..7) {
        0 => Solid::union(parts),
        1 => Solid::intersection(parts),
        2 => Solid::symmetric_difference(parts),
        3 => !random_solid(rng, depth - 1),
        4 => random_solid(rng, depth - 1).named("part"),
        5 => {
            let maps = [random_map(rng), random_map(rng)];
            random_solid(rng, depth - 1).place(maps)
        }
        _ => random_solid(rng, depth - 1) - random_solid(rng, depth - 1),
    }
}

#[test]
fn random_trees() {
    let mut rng = ChaCha8Rng::seed_from_u64(2);
    for _ in 0..150 {
        let solid = random_solid(&mut rng, 3);
        check(&solid, &mut rng);
    }
}

#[test]
fn outermost_unions_are_separate_objects() {
    let ball = Solid::from(Primitive::example("sphere").unwrap());
    let far = ball.translate([5.0, 0.0, 0.0]);
    let solid = (&ball | &far).named("two") | Solid::empty() | (&ball - &far);
    assert_eq!(read(&written(&solid)).len(), 3);
}

#[test]
fn camera_lights_and_colours() {
    let (_, scene) = parse(
        "rayweave = 1\n[solid.a]\nsphere = { radius = 1 }\n[[region]]\nsolid = \"a\"\ncolour = \"#ff0000\"\n\
         [camera]\nprojection = \"orthographic\"\nheight = 4\nposition = [0, -8, 0]\ntarget = [0, 0, 0]\nsize = [200, 100]\n\
         [[light]]\nposition = [1, 2, 3]\nintensity = 0.5\n[[light]]\ndirection = [0, 0, -1]\n\
         [render]\nshading = \"headlight\"\nedges = false\nshadows = true\nbackground = \"#000000\"\n",
    )
    .unwrap();
    let povray = scene.to_povray().unwrap();
    for piece in [
        "camera {\n  orthographic\n  location <0, -8, 0>\n  direction <0, 1, 0>\n  right <4, 0, 0> * 2\n",
        "light_source { <1, 2, 3>, rgb <0.5, 0.5, 0.5> }\n",
        "rgb <1, 1, 1> parallel point_at <0, 0, 0> }\n",
        "pigment { rgb <1, 0, 0> } finish { ambient 0.18 diffuse 0.82 }",
        "background { rgb <0, 0, 0> }\n",
    ] {
        // zeros may have a sign
        assert!(povray.text.replace("-0.0", "0").contains(piece), "{piece}\n{}", povray.text);
    }
    assert!(povray.losses.is_empty(), "{:?}", povray.losses);
    let plain = scene_of(Solid::from(Primitive::example("sphere").unwrap())).to_povray().unwrap();
    assert!(plain.text.contains("shadowless") && plain.losses.len() == 3, "{:?}", plain.losses);
}

#[test]
fn refusals() {
    let ball = Solid::from(Primitive::example("sphere").unwrap());
    let flat = scene_of(ball.scale(Vec3::new(1.0, 1.0, 0.0)));
    let problem = flat.to_povray().unwrap_err().to_string();
    assert!(problem.contains("region `all`") && problem.contains("singular"), "{problem}");
    let full = Solid::symmetric_difference((0..30).map(|k| ball.translate([f64::from(k), 0.0, 0.0])));
    let problem = scene_of(full).to_povray().unwrap_err().to_string();
    assert!(problem.contains("more than 1000000 parts"), "{problem}");
}

#[test]
fn deep_trees_need_no_stack() {
    let ball = Solid::from(Primitive::example("sphere").unwrap());
    let deep = (0..100_000).fold(ball.clone(), |all, _| !(all - ball.clone()));
    let run = move || scene_of(deep).to_povray().unwrap().text.len();
    let length = std::thread::Builder::new().stack_size(256 * 1024).spawn(run).unwrap().join().unwrap();
    assert!(length > 100_000 * 20);
}
