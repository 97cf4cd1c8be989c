//! Rays from CSV files.

use std::fmt::Write;
use std::io::{self, Read};

use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use rayweave_table::{Progress, RayChunk, RayProblems, RayReader, TableError};

use crate::folder::Folder;

/// All rays of a text, read in chunks of 3.
fn rays(text: impl AsRef<[u8]>) -> Result<Vec<[f64; 6]>, TableError> {
    let text = io::Cursor::new(text.as_ref().to_vec());
    let mut reader = RayReader::from_csv(text, "rays.csv")?;
    let mut chunk = RayChunk::default();
    let mut rays = Vec::new();
    while reader.read(&mut chunk, 3)? > 0 {
        assert_eq!(chunk.first, rays.len() as u64);
        for i in 0..chunk.len() {
            let [ox, oy, oz] = &chunk.origin;
            let [dx, dy, dz] = &chunk.direction;
            rays.push([ox[i], oy[i], oz[i], dx[i], dy[i], dz[i]]);
        }
    }
    Ok(rays)
}

fn problems(text: impl AsRef<[u8]>) -> String {
    rays(text).unwrap_err().to_string()
}

/// The problem of a file with a valid header and this one ray.
fn problem_of_ray(line: &str) -> String {
    problems(format!("ox,oy,oz,dx,dy,dz\n{line}\n"))
}

#[test]
fn numbers_whose_squares_overflow_or_underflow_are_rejected() {
    let huge = problem_of_ray("1e150,0,0,0,0,1");
    assert!(huge.contains("ox is 1e150: numbers beyond 1e100 overflow in computations."), "{huge}");
    let tiny = problem_of_ray("0,0,0,0,0,1e-300");
    assert!(tiny.contains("below 1e-100"), "{tiny}");
}

#[test]
fn random_bits_read_back_over_many_chunks() {
    let mut rng = ChaCha8Rng::seed_from_u64(2);
    let mut number = || loop {
        // within the supported range
        let x = f64::from_bits(rng.random());
        if (1e-100..=1e100).contains(&x.abs()) {
            return x;
        }
    };
    let expected: Vec<[f64; 6]> = (0..1000).map(|_| std::array::from_fn(|_| number())).collect();
    let mut text = String::from("ox,oy,oz,dx,dy,dz\n");
    for [a, b, c, d, e, f] in &expected {
        writeln!(text, "{a:?},{b},{c:e},{d:?},{e},{f:e}").unwrap();
    }
    let bits = |rays: &[[f64; 6]]| rays.iter().flatten().map(|x| x.to_bits()).collect::<Vec<_>>();
    assert_eq!(bits(&rays(text).unwrap()), bits(&expected));
}

#[test]
fn columns_in_any_order_and_dialects() {
    let expected = [[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]];
    for text in [
        "ox,oy,oz,dx,dy,dz\n1,2,3,4,5,6",
        "ox,oy,oz,dx,dy,dz\r\n1,2,3,4,5,6\r\n",
        "\u{feff}ox,oy,oz,dx,dy,dz\n\n 1, 2 ,3.0,4e0, +5,6.\n\n",
        "\n  \ndz,dy,dx,oz,oy,ox\n6,5,4,3,2,1\n \t \n",
        "\"ox\",\"oy\",oz,dx,dy,dz\n\"1\",2,3,4,5,\"6\"\n",
    ] {
        assert_eq!(rays(text).unwrap(), expected, "{text:?}");
    }
}

#[test]
fn no_rays_is_legal() {
    assert_eq!(rays("ox,oy,oz,dx,dy,dz").unwrap(), [[0.0; 6]; 0]);
}

#[test]
fn an_empty_file_is_an_error() {
    let expected = "rays.csv: the file is empty: the first line must be ox,oy,oz,dx,dy,dz.";
    assert_eq!(problems(""), expected);
    assert_eq!(problems("\n\n"), expected);
}

#[test]
fn all_problems_of_a_header_at_once() {
    assert_eq!(
        problems("ox,oy,0z,dx,dx,velocity\n1,2,3,4,5,6\n"),
        "rays.csv:1: unknown column \"0z\".\n\
         rays.csv:1: the column dx occurs twice: column names are unique.\n\
         rays.csv:1: unknown column \"velocity\".\n\
         rays.csv:1: missing columns oz, dy, dz: a ray file needs ox, oy, oz, dx, dy and dz, in any order."
    );
    assert_eq!(
        problems("ox,oy,oz,DX,dyy,d,w\n"),
        "rays.csv:1: unknown column \"DX\". Did you mean dx?\n\
         rays.csv:1: unknown column \"dyy\". Did you mean dy?\n\
         rays.csv:1: unknown column \"d\".\n\
         rays.csv:1: unknown column \"w\".\n\
         rays.csv:1: missing columns dx, dy, dz: a ray file needs ox, oy, oz, dx, dy and dz, in any order."
    );
    assert_eq!(problems("ox,oy,oz,dx,dy,dz,\n"), "rays.csv:1: unknown column without a name. Remove it.");
}

#[test]
fn files_of_another_kind_are_recognised() {
    for (text, message) in [
        (
            "1,2,3,4,5,6\n",
            "1: the first line has numbers: it must be the header. Insert the line ox,oy,oz,dx,dy,dz.",
        ),
        (
            "\n# ox,oy,oz,dx,dy,dz\n",
            "2: the header begins with #: CSV has no comments. \
             Remove it, or pass comments=\"\" to numpy.savetxt.",
        ),
        (
            "ox;oy;oz;dx;dy;dz\n",
            "1: fields are separated by semicolons: CSV is read with commas. Write it with commas.",
        ),
        ("ox\toy\toz\n", "1: fields are separated by tabs: CSV is read with commas. Write it with commas."),
        ("ox oy oz\n", "1: fields are separated by spaces: CSV is read with commas. Write it with commas."),
    ] {
        assert_eq!(problems(text), format!("rays.csv:{message}"));
    }
    assert_eq!(
        problems(b"\x93NUMPY\x01\0"),
        "rays.csv:1: this is an NPY file: the extension .csv is for text. Name it .npy."
    );
    assert_eq!(
        problems(b"\xff\xfeo\0x\0"),
        "rays.csv:1: the text is UTF-16: CSV is read as UTF-8. Save it as UTF-8."
    );
}

#[test]
fn an_invalid_number_has_line_and_column() {
    for (line, message) in [
        ("1,2,3,4,5,1.O", "dz is \"1.O\": it must be a number."),
        ("1,2,3,4,5,", "dz is empty: it must be a number."),
        ("1,2,3,4,0x5,6", "dy is \"0x5\": it must be a number."),
        ("1,2,nan,4,5,6", "oz is NaN: a ray is six finite numbers."),
        ("1,-inf,3,4,5,6", "oy is infinite: a ray is six finite numbers."),
        ("1e999,2,3,4,5,6", "ox is infinite: a ray is six finite numbers."),
        ("1,2,3,0,-0.0,0e5", "dx, dy and dz are all 0: a direction must be a nonzero vector."),
        ("1,2,3,4", "the line has 4 fields: a ray has six. Check that the file is complete."),
        ("1", "the line has 1 field: a ray has six. Check that the file is complete."),
        ("1,2,3,4,5,6,7", "the line has 7 fields: a ray has six."),
        (
            "1,0,2,0,3,0,4,0,5,0,6,0",
            "the line has 12 fields: a ray has six. Write decimals with a point, not a comma.",
        ),
        ("1,\"2,3,4,5,6", "a quote is not closed on its line: a field cannot extend over several lines."),
        ("1,2,3\r4,5,6", "the line has a carriage return inside: lines end with \\n or \\r\\n."),
        ("1,2,3,4,5,a\u{1b}[31mb", "dz is \"a\\u{1b}[31mb\": it must be a number."),
    ] {
        assert_eq!(problem_of_ray(line), format!("rays.csv:2: {message}"));
    }
    assert_eq!(
        problem_of_ray(&",".repeat(100)),
        "rays.csv:2: the line has more than 64 fields: a ray has six."
    );
    assert_eq!(
        problem_of_ray(&format!("1,2,3,4,5,{}", "é".repeat(1000))),
        format!("rays.csv:2: dz is \"{}\"...: it must be a number.", "é".repeat(30))
    );
}

#[test]
fn invalid_utf8_is_replaced_in_messages() {
    assert_eq!(
        problems(b"ox,oy,oz,dx,dy,dz\n1,2,3,4,5,\xff\xfe\n"),
        "rays.csv:2: dz is \"\u{fffd}\u{fffd}\": it must be a number."
    );
}

#[test]
fn line_numbers_agree_with_editors() {
    for end in ["\n", "\r\n"] {
        let text = ["ox,oy,oz,dx,dy,dz", "", "1,2,3,4,5,6", "", "x,2,3,4,5,6"].join(end);
        assert_eq!(problems(&text), "rays.csv:5: ox is \"x\": it must be a number.");
    }
}

#[test]
fn a_problem_has_line_row_and_column() {
    let TableError::Rays(problems) = rays("ox,oy,oz,dx,dy,dz\n1,2,3,4,5,6\n1,2,3,4,nan,6\n").unwrap_err()
    else {
        panic!();
    };
    let [problem] = &problems.problems[..] else { panic!() };
    assert_eq!((problem.line, problem.row, problem.column), (Some(3), Some(1), Some("dy")));
    assert!(!problems.stopped);
}

#[test]
fn a_stream_is_validated_to_the_end_of_the_chunk() {
    // chunks of three: the fourth ray is not validated
    let text = "ox,oy,oz,dx,dy,dz\n1,2,3,4,5,6\n,,3,4,5,6\n1,2,3,0,0,0\nx,2,3,4,5,6\n";
    assert_eq!(
        problems(text),
        "rays.csv:3: ox is empty: it must be a number.\n\
         rays.csv:3: oy is empty: it must be a number.\n\
         rays.csv:4: dx, dy and dz are all 0: a direction must be a nonzero vector."
    );
}

#[test]
fn a_file_is_validated_to_its_end() {
    let folder = Folder::new();
    let good = "1,2,3,4,5,6\n".repeat(100);
    let path = folder.write("rays.csv", format!("ox,oy,oz,dx,dy,dz\n{good}a,2,3,4,5,6\n{good}1,2,3,4,5\n"));
    let mut reader = RayReader::open(path).unwrap();
    let mut chunk = RayChunk::default();
    for _ in 0..10 {
        assert_eq!(reader.read(&mut chunk, 10).unwrap(), 10);
    }
    assert_eq!(
        folder.text_of(&reader.read(&mut chunk, 10).unwrap_err()),
        "rays.csv:102: ox is \"a\": it must be a number.\n\
         rays.csv:203: the line has 5 fields: a ray has six. Check that the file is complete."
    );
    assert!(chunk.is_empty());
    assert_eq!(reader.read(&mut chunk, 10).unwrap(), 0);
}

#[test]
fn reading_stops_after_twenty_problems() {
    let text_of = |bad: usize| {
        let text = format!("ox,oy,oz,dx,dy,dz\n{}", "1,2,3,4,5,z\n".repeat(bad));
        let folder = Folder::new();
        let mut reader = RayReader::open(folder.write("rays.csv", text)).unwrap();
        folder.text_of(&reader.read(&mut RayChunk::default(), 7).unwrap_err())
    };
    assert_eq!(text_of(RayProblems::LIMIT).lines().count(), 20);
    let text = text_of(10_000);
    assert_eq!(text.lines().count(), 21);
    assert_eq!(text.lines().last().unwrap(), "rays.csv: stopped after 20 problems");
}

#[test]
fn a_long_line_is_rejected_and_skipped() {
    let long = "9".repeat(200_000);
    let text = format!("ox,oy,oz,dx,dy,dz\n{long}\n1,2,3,4,5\n");
    assert_eq!(
        problems(text),
        "rays.csv:2: the line is longer than 65536 bytes: a ray takes 150 at most.\n\
         rays.csv:3: the line has 5 fields: a ray has six. Check that the file is complete."
    );
    assert_eq!(
        problems(" ".repeat(200_000)),
        "rays.csv:1: the line is longer than 65536 bytes: a ray takes 150 at most."
    );
}

#[test]
fn progress_is_in_bytes() {
    let folder = Folder::new();
    let text = "ox,oy,oz,dx,dy,dz\n1,2,3,4,5,6\n1,2,3,4,5,6\n";
    let mut reader = RayReader::open(folder.write("rays.csv", text)).unwrap();
    let total = Some(text.len() as u64);
    assert_eq!((reader.progress(), reader.rays()), (Progress { done: 18, total }, None));
    reader.read(&mut RayChunk::default(), 1).unwrap();
    assert_eq!(reader.progress(), Progress { done: 30, total });
    let stream = RayReader::from_csv(text.as_bytes(), "stdin").unwrap();
    assert_eq!(stream.progress(), Progress { done: 18, total: None });
}

#[test]
fn read_errors_have_a_reason() {
    let folder = Folder::new();
    let text_of = |name: &str| folder.text_of(&RayReader::open(folder.join(name)).unwrap_err());
    let missing = text_of("rays.csv");
    let expected = "cannot read rays.csv: there is no such file or folder. Check the path: `";
    assert!(missing.starts_with(expected), "{missing}");
    std::fs::write(folder.join("ray.csv"), "").unwrap();
    assert!(text_of("rays.csv").ends_with("ray.csv`?"), "{}", text_of("rays.csv"));
    std::fs::create_dir(folder.join("rays.csv")).unwrap();
    assert_eq!(text_of("rays.csv"), "cannot read rays.csv: it is a folder.");
    assert_eq!(
        text_of("rays.txt"),
        "rays.txt: the ray file format is unknown: the extension must be .csv or .npy."
    );
}

/// A source that provides a header, then fails.
struct Failing(bool);

impl Read for Failing {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if std::mem::replace(&mut self.0, true) {
            return Err(io::Error::other("the line is down"));
        }
        (&b"ox,oy,oz,dx,dy,dz\n1,2,3,4,5,6\n"[..]).read(buffer)
    }
}

#[test]
fn a_failing_source_is_reported() {
    let mut reader = RayReader::from_csv(Failing(false), "stdin").unwrap();
    let error = reader.read(&mut RayChunk::default(), 10).unwrap_err();
    assert_eq!(error.to_string(), "cannot read stdin: the line is down.");
    assert_eq!(error.io_kind(), Some(io::ErrorKind::Other));
}
