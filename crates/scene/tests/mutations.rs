//! Fuzzing: mutated files give diagnostics with positions, never a panic.

use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use rayweave_scene::{Document, parse};
use std::path::Path;

fn models() -> Vec<String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../models");
    let mut files: Vec<_> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.retain(|path| path.extension().is_some_and(|extension| extension == "toml"));
    files.sort();
    files.iter().map(|path| std::fs::read_to_string(path).unwrap()).collect()
}

/// Characters with a meaning in one of the languages of a file.
const CHARACTERS: &[char] = &[
    '"',
    '\'',
    '[',
    ']',
    '{',
    '}',
    '(',
    ')',
    '=',
    ',',
    '.',
    '#',
    '\n',
    '\r',
    '\\',
    '-',
    '+',
    '*',
    '/',
    '^',
    '|',
    '&',
    '~',
    '_',
    '0',
    '9',
    'e',
    'x',
    '\u{e4}',
    '\u{1f600}',
    '\0',
    ' ',
];

fn mutate(text: &str, rng: &mut ChaCha8Rng) -> String {
    let mut chars: Vec<char> = text.chars().collect();
    for _ in 0..rng.random_range(1..4) {
        let at = rng.random_range(0..chars.len());
        let end = (at + rng.random_range(1..20)).min(chars.len());
        match rng.random_range(0..5) {
            0 => chars[at] = CHARACTERS[rng.random_range(0..CHARACTERS.len())],
            1 => chars.insert(at, CHARACTERS[rng.random_range(0..CHARACTERS.len())]),
            2 => drop(chars.drain(at..end)),
            3 => {
                let piece: Vec<char> = chars[at..end].to_vec();
                let to = rng.random_range(0..=chars.len());
                chars.splice(to..to, piece);
            }
            _ => chars.truncate(chars.len() - chars.len() / rng.random_range(2..50)),
        }
        if chars.is_empty() {
            chars.push('\n');
        }
    }
    chars.into_iter().collect()
}

#[test]
fn damaged_models_are_diagnosed() {
    let mut rng = ChaCha8Rng::seed_from_u64(11);
    let (mut good, mut bad) = (0, 0);
    for model in models() {
        for _ in 0..150 {
            let text = mutate(&model, &mut rng);
            match parse(&text) {
                Ok((document, scene)) => {
                    good += 1;
                    let again =
                        parse(&document.to_toml()).unwrap_or_else(|problems| panic!("{text}\n{problems}"));
                    assert_eq!(again, (document, scene.clone()), "{text}");
                    let rebuilt = parse(&Document::from_scene(&scene).to_toml());
                    assert_eq!(rebuilt.unwrap().1.regions, scene.regions, "{text}");
                }
                Err(problems) => {
                    bad += 1;
                    assert!(problems.has_errors());
                    assert!(!problems.to_string().is_empty());
                    for problem in problems.iter() {
                        let span = problem.span();
                        assert!(
                            span.is_none_or(|span| span.start() <= span.end() && span.end() <= text.len()),
                            "{problem:?}"
                        );
                    }
                }
            }
        }
    }
    assert!(good > 50 && bad > 500, "{good} {bad}");
}
