//! Rays from NPY files, mostly written by an independent writer.

use npyz::{Order, WriterBuilder};
use rayweave_table::{Progress, RayChunk, RayReader, TableError};

use crate::folder::Folder;

/// An array of this shape by `npyz`, in this order and byte order.
fn array<T: npyz::Serialize>(
    shape: &[u64],
    descr: &str,
    order: Order,
    values: impl IntoIterator<Item = T>,
) -> Vec<u8> {
    let mut bytes = Vec::new();
    let dtype = npyz::DType::Plain(descr.parse().unwrap());
    let options = npyz::WriteOptions::new().dtype(dtype).shape(shape).order(order);
    let mut writer = options.writer(&mut bytes).begin_nd().unwrap();
    writer.extend(values).unwrap();
    writer.finish().unwrap();
    bytes
}

fn good(rows: u64) -> Vec<u8> {
    array(&[rows, 6], "<f8", Order::C, (1..=rows * 6).map(|i| i as f64))
}

/// A file with this header text and `data` zero bytes.
fn with_header(header: &str, data: usize) -> Vec<u8> {
    let mut bytes = b"\x93NUMPY\x01\0".to_vec();
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.as_bytes());
    bytes.resize(bytes.len() + data, 0);
    bytes
}

fn read_all(bytes: &[u8], rows_per_chunk: usize) -> Result<Vec<[f64; 6]>, String> {
    let folder = Folder::new();
    let path = folder.write("rays.npy", bytes);
    let mut rays = Vec::new();
    let mut read = || -> Result<(), TableError> {
        let mut reader = RayReader::open(&path)?;
        let mut chunk = RayChunk::default();
        while reader.read(&mut chunk, rows_per_chunk)? > 0 {
            assert_eq!(chunk.first, rays.len() as u64);
            let [[ox, oy, oz], [dx, dy, dz]] = [&chunk.origin, &chunk.direction];
            rays.extend((0..chunk.len()).map(|i| [ox[i], oy[i], oz[i], dx[i], dy[i], dz[i]]));
        }
        Ok(())
    };
    read().map_err(|error| folder.text_of(&error))?;
    Ok(rays)
}

fn problem(bytes: &[u8]) -> String {
    read_all(bytes, 1000).unwrap_err()
}

/// The value of row i, column c in every test array.
fn value(i: u64, c: u64) -> f64 {
    (6 * i + c + 1) as f64
}

#[test]
fn every_layout_reads_the_same() {
    const ROWS: u64 = 10_000;
    let expected: Vec<[f64; 6]> = (0..ROWS).map(|i| std::array::from_fn(|c| value(i, c as u64))).collect();
    let c = || (0..ROWS).flat_map(|i| (0..6).map(move |c| value(i, c)));
    let f = || (0..6).flat_map(|c| (0..ROWS).map(move |i| value(i, c)));
    let shape = [ROWS, 6];
    for bytes in [
        array(&shape, "<f8", Order::C, c()),
        array(&shape, ">f8", Order::C, c()),
        array(&shape, "<f4", Order::C, c().map(|x| x as f32)),
        array(&shape, ">f4", Order::Fortran, f().map(|x| x as f32)),
        array(&shape, "<f8", Order::Fortran, f()),
    ] {
        for rows_per_chunk in [999, 5000, usize::MAX] {
            assert!(read_all(&bytes, rows_per_chunk).unwrap() == expected);
        }
    }
}

#[test]
fn headers_of_all_writers_are_read() {
    let expected = vec![[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]];
    let data: Vec<u8> = (1..=6).flat_map(|i| f64::from(i).to_le_bytes()).collect();
    for header in [
        "{'descr': '<f8', 'fortran_order': False, 'shape': (1, 6), }\n",
        "{\"shape\":(1,6),\"fortran_order\":True,\"descr\":\"=f8\"}",
        "  { 'descr' : '<f8' , 'fortran_order' : False , 'shape' : ( 1L , 6L , ) }  \n",
    ] {
        let bytes = [with_header(header, 0), data.clone()].concat();
        assert_eq!(read_all(&bytes, 10).as_ref(), Ok(&expected), "{header}");
    }
    for version in [2, 3] {
        let mut bytes = b"\x93NUMPY".to_vec();
        let header = b"{'descr': '<f8', 'fortran_order': False, 'shape': (1, 6), }\n";
        bytes.extend([version, 0]);
        bytes.extend((header.len() as u32).to_le_bytes());
        bytes.extend(header);
        bytes.extend(&data);
        assert_eq!(read_all(&bytes, 10).as_ref(), Ok(&expected));
    }
}

#[test]
fn no_rays_is_legal() {
    assert_eq!(read_all(&good(0), 10), Ok(vec![]));
}

#[test]
fn the_error_about_a_shape_has_a_suggestion() {
    for (shape, message) in [
        (
            &[6, 4][..],
            "the shape is (6, 4): rays have shape (N, 6) with the columns ox, oy, oz, dx, dy, dz. Transpose it.",
        ),
        (
            &[6],
            "the shape is (6,): rays have shape (N, 6) with the columns ox, oy, oz, dx, dy, dz. Reshape it to (1, 6).",
        ),
        (
            &[4, 2, 3],
            "the shape is (4, 2, 3): rays have shape (N, 6) with the columns ox, oy, oz, dx, dy, dz. Reshape it to (-1, 6).",
        ),
        (&[4, 2], "the shape is (4, 2): rays have shape (N, 6) with the columns ox, oy, oz, dx, dy, dz."),
        (&[], "the shape is (): rays have shape (N, 6) with the columns ox, oy, oz, dx, dy, dz."),
    ] {
        let values = (0..shape.iter().product()).map(|i| i as f64);
        assert_eq!(problem(&array(shape, "<f8", Order::C, values)), format!("rays.npy: {message}"));
    }
}

#[test]
fn the_error_about_a_dtype_has_a_suggestion() {
    assert_eq!(
        problem(&array(&[2, 3], "<i8", Order::C, 0..6_i64)),
        "rays.npy: the dtype is <i8: rays are float64 or float32. Convert it with array.astype(float).\n\
         rays.npy: the shape is (2, 3): rays have shape (N, 6) with the columns ox, oy, oz, dx, dy, dz."
    );
    let fields =
        "{'descr': [('o]', '<f8', (3,)), ('d', '<f8', (3,))], 'fortran_order': False, 'shape': (4,), }";
    let text = problem(&with_header(fields, 4 * 48));
    assert!(
        text.starts_with(
            "rays.npy: the array has named fields: rays are plain float64 of shape (N, 6). \
             Convert it with numpy.lib.recfunctions.structured_to_unstructured.\n"
        ),
        "{text}"
    );
}

#[test]
fn an_invalid_number_has_row_and_column() {
    let mut values: Vec<f64> = (1..=60).map(f64::from).collect();
    values[6 * 3 + 4] = f64::NAN;
    values[6 * 5] = f64::NEG_INFINITY;
    values[6 * 9 + 3..].fill(-0.0);
    let expected = "rays.npy: row 3: dy is NaN: a ray is six finite numbers.\n\
                    rays.npy: row 5: ox is infinite: a ray is six finite numbers.\n\
                    rays.npy: row 9: dx, dy and dz are all 0: a direction must be a nonzero vector.";
    let bytes = array(&[10, 6], "<f8", Order::C, values);
    for rows_per_chunk in [1, 2, 10, 100] {
        assert_eq!(read_all(&bytes, rows_per_chunk).unwrap_err(), expected);
    }
}

#[test]
fn reading_stops_after_twenty_problems() {
    let bytes = array(&[100_000, 6], "<f8", Order::C, std::iter::repeat_n(0.0, 600_000));
    let text = problem(&bytes);
    assert_eq!(text.lines().count(), 21);
    assert!(text.ends_with(
        "rays.npy: row 19: dx, dy and dz are all 0: a direction must be a nonzero vector.\n\
         rays.npy: stopped after 20 problems"
    ));
}

#[test]
fn every_truncation_is_an_error() {
    let bytes = good(3);
    for length in 0..bytes.len() {
        let text = problem(&bytes[..length]);
        let expected = match length {
            0 => "the file is empty: an NPY header is required.".to_string(),
            1..6 => "this is not an NPY file: it does not begin with \\x93NUMPY. \
                     Write it with numpy.save, or name it .csv if it is text."
                .into(),
            6..128 => "the file ends within the NPY header: it is incomplete.".into(),
            _ => {
                let found = length - 128;
                format!(
                    "the file is incomplete: the header announces 3 rays, 144 bytes, and {found} bytes follow."
                )
            }
        };
        assert_eq!(text, format!("rays.npy: {expected}"), "{length}");
    }
}

#[test]
fn bytes_after_the_array_are_an_error() {
    let bytes = [good(3), good(2)].concat();
    assert_eq!(
        problem(&bytes),
        "rays.npy: 224 bytes follow the array: the header announces 3 rays. Save one array per file."
    );
}

#[test]
fn damaged_headers_are_errors() {
    for header in [
        "",
        "{",
        "{}",
        "{'descr': '<f8', 'fortran_order': False}",
        "{'descr': '<f8', 'fortran_order': 0, 'shape': (1, 6), }",
        "{'descr': '<f8', 'fortran_order': False, 'shape': (1, 6, }",
        "{'descr': '<f8', 'fortran_order': False, 'shape': (-1, 6), }",
        "{'descr': '<f8', 'fortran_order': False, 'shape': (1,, 6), }",
        "{'descr': '<f8' 'fortran_order': False, 'shape': (1, 6), }",
        "{'descr': '<f8', 'fortran_order': False, 'shape': (1, 6), } x",
        "{'descr': '<f8', 'fortran_order': False, 'shape': (1, 6), 'more': 1}",
        "{'descr': [('x', '<f8'), 'fortran_order': False, 'shape': (1, 6), }",
        "{'descr': '<f8', 'fortran_order': False, 'shape': (99999999999999999999, 6), }",
    ] {
        let text = problem(&with_header(header, 48));
        assert!(text.starts_with("rays.npy: the NPY header is damaged: it reads \""), "{header}: {text}");
    }
    let huge = "{'descr': '<f8', 'fortran_order': False, 'shape': (1000000000000000000, 6), }";
    assert_eq!(
        problem(&with_header(huge, 48)),
        "rays.npy: the NPY header is damaged: it announces 1000000000000000000 rays."
    );
    assert_eq!(
        problem(b"\x93NUMPY\x02\0\xff\xff\xff\xff{"),
        "rays.npy: the NPY header is damaged: its stated length is 4294967295 bytes."
    );
    assert_eq!(
        problem(b"\x93NUMPY\x09\0\0\0"),
        "rays.npy: the NPY version 9 is unknown: versions 1, 2 and 3 are supported."
    );
}

#[test]
fn progress_and_number_of_rays_are_reported() {
    let folder = Folder::new();
    let mut reader = RayReader::open(folder.write("rays.npy", good(10))).unwrap();
    let total = Some(128 + 480);
    assert_eq!((reader.progress(), reader.rays()), (Progress { done: 128, total }, Some(10)));
    let mut chunk = RayChunk::default();
    assert_eq!(reader.read(&mut chunk, 4).unwrap(), 4);
    assert_eq!(reader.progress(), Progress { done: 128 + 192, total });
    while reader.read(&mut chunk, 4).unwrap() > 0 {}
    assert_eq!(reader.progress(), Progress { done: 608, total });
}
