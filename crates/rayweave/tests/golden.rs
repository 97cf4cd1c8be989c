//! Golden pictures: rendered models compared with reviewed pictures.
//!
//! `models/NAME.png` is the picture of `models/NAME.toml` by `rayweave render`; `tests/golden/` contains
//! small pictures of other views, styles and kinds. `cargo xtask golden --accept` rewrites all of them:
//! review the differences before committing.

use rayweave::picture::{Picture, PictureKind, PictureOptions, arrange};
use rayweave::render::{Image, Run, Size, Style, View, png};
use rayweave::scene::load;
use rayweave::{Compiled, Weave};
use std::fs;
use std::path::{Path, PathBuf};

/// Channels that differ by at most this count as equal: a change in the last bit of a root changes shading by
/// less than a level, and rounding to levels adds one.
const LEVELS: u8 = 2;

/// The fraction of pixels that may differ by more: where a change in the last bit of a root moves a sample
/// across an edge, a pixel changes by a ninth of its contrast.
const PART: f64 = 0.0005;

/// The environment variable that makes the test write pictures instead of comparing them.
const ACCEPT: &str = "RAYWEAVE_ACCEPT_GOLDEN";

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// The names of all models.
fn models() -> Vec<String> {
    let files = fs::read_dir(root().join("models")).unwrap();
    let names = files.filter_map(|file| {
        let path = file.unwrap().path();
        let is_model = path.extension().is_some_and(|extension| extension == "toml");
        is_model.then(|| path.file_stem().unwrap().to_string_lossy().into_owned())
    });
    let mut names: Vec<String> = names.collect();
    names.sort();
    names
}

/// The PNG file of a model's picture.
fn draw(model: &str, kind: PictureKind, options: &PictureOptions) -> Vec<u8> {
    let path = root().join("models").join(model).with_extension("toml");
    let (_, scene) = load(&path, &[]).unwrap();
    let compiled = Compiled::named(&scene, None).unwrap();
    let (camera, settings) = arrange(&scene, &compiled, options).unwrap();
    let weave = Weave::new(compiled.program.clone());
    Picture::draw(kind, &weave, &camera, &settings, &mut Run::default()).unwrap().to_png()
}

/// Compares a picture with the golden one and returns the problem, if any; writes the golden file instead if
/// [`ACCEPT`] is set.
fn compare(golden: &Path, drawn: &[u8]) -> Option<String> {
    if std::env::var_os(ACCEPT).is_some_and(|value| value == "1") {
        // equal pixels can be encoded as different bytes: files with equal pixels are not rewritten
        if difference(&fs::read(golden).unwrap_or_default(), drawn).is_some() {
            fs::create_dir_all(golden.parent()?).unwrap();
            fs::write(golden, drawn).unwrap();
        }
        return None;
    }
    let problem = match fs::read(golden) {
        Err(error) => format!("cannot be read: {error}."),
        Ok(accepted) => difference(&accepted, drawn)?,
    };
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("golden");
    let seen = folder.join(golden.file_name()?);
    fs::create_dir_all(&folder).unwrap();
    fs::write(&seen, drawn).unwrap();
    Some(format!("{}: {problem}; see {}", golden.display(), seen.display()))
}

/// The difference between two pictures, if it exceeds the tolerance.
fn difference(accepted: &[u8], drawn: &[u8]) -> Option<String> {
    let decoded = [accepted, drawn].map(png::decode);
    let [Ok(accepted), Ok(drawn)] = decoded else {
        return Some("cannot be decoded as a picture".to_owned());
    };
    if accepted.size() != drawn.size() {
        return Some(format!("has the size {:?}, but the drawn picture {:?}", accepted.size(), drawn.size()));
    }
    let apart = |a: &[u8; 4], b: &[u8; 4]| a.iter().zip(b).map(|(a, b)| a.abs_diff(*b)).max().unwrap_or(0);
    let differences = || accepted.values().iter().zip(drawn.values()).map(|(a, b)| apart(a, b));
    let many = differences().filter(|&apart| apart > LEVELS).count();
    let most = (PART * accepted.values().len() as f64) as usize;
    (many > most).then(|| {
        let (at, largest) = differences().enumerate().max_by_key(|&(_, apart)| apart).unwrap_or((0, 0));
        let (x, y) = (at % accepted.width(), at / accepted.width());
        format!(
            "{many} pixels differ by more than {LEVELS} levels (at most {most} may), most at ({x}, {y}): {largest}"
        )
    })
}

fn check(pictures: impl IntoIterator<Item = (PathBuf, Vec<u8>)>) {
    let problems = pictures.into_iter().filter_map(|(golden, drawn)| compare(&golden, &drawn));
    let problems: Vec<String> = problems.collect();
    let advice = "if the change is intended, accept it with 'cargo xtask golden --accept'";
    assert!(problems.is_empty(), "{}\n{advice}", problems.join("\n"));
}

#[test]
fn models_look_like_their_pictures() {
    let names = models();
    assert!(names.len() >= 10, "{names:?}");
    check(names.iter().map(|name| {
        let golden = root().join("models").join(name).with_extension("png");
        (golden, draw(name, PictureKind::Colour, &PictureOptions::default()))
    }));
}

#[test]
fn views_styles_and_kinds() {
    let small = PictureOptions { size: Size::new(240, 180).ok(), ..PictureOptions::default() };
    let view = |view| PictureOptions { view: Some(view), ..small };
    let style = |style| PictureOptions { style: Some(style), ..small };
    let shadows = PictureOptions { shadows: Some(true), ..small };
    let colour = PictureKind::Colour;
    let cases = [
        ("bracket", "front", colour, view(View::Front)),
        ("bracket", "left", colour, view(View::Left)),
        ("bracket", "top", colour, view(View::Top)),
        ("bracket", "iso", colour, view(View::Iso)),
        ("gear", "bottom", colour, view(View::Bottom)),
        ("classic", "shadows", colour, shadows),
        ("annulus", "headlight", colour, PictureOptions { style: Some(Style::Headlight), ..shadows }),
        ("gallery", "flat", colour, PictureOptions { samples: Some(1), ..style(Style::Flat) }),
        ("die", "without-edges", colour, PictureOptions { edges: Some(false), ..small }),
        ("tiles", "id", PictureKind::Id, view(View::Back)),
    ];
    check(cases.into_iter().map(|(model, what, kind, options)| {
        let golden = root().join("tests/golden").join(format!("{model}-{what}.png"));
        (golden, draw(model, kind, &options))
    }));
}

#[test]
fn differences_are_found() {
    let size = Size::new(100, 40).unwrap();
    let grey = |level: u8| Image::filled(size, [level, level, level, 255]);
    assert_eq!(difference(&png::encode(&grey(100)), &png::encode(&grey(102))), None);
    assert!(difference(&png::encode(&grey(100)), &png::encode(&grey(103))).is_some());
    let mut spots = grey(100);
    spots.values_mut()[7] = [255; 4];
    spots.values_mut()[207] = [255; 4];
    assert_eq!(difference(&png::encode(&grey(100)), &png::encode(&spots)), None);
    spots.values_mut()[311] = [100, 100, 100, 0];
    let problem = difference(&png::encode(&grey(100)), &png::encode(&spots)).unwrap();
    assert_eq!(problem, "3 pixels differ by more than 2 levels (at most 2 may), most at (11, 3): 255");
    let other = Image::filled(Size::new(40, 100).unwrap(), [0; 4]);
    assert!(difference(&png::encode(&grey(100)), &png::encode(&other)).is_some());
    assert!(difference(b"", &png::encode(&other)).is_some());
}
