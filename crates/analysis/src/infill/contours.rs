//! Reader for regions of the plane, given as contours in a CSV file.

use super::ContourProblems;
use crate::AnalysisError;
use rayweave_polygon::{PolygonError, Polygons, from_polygons};
use rayweave_rootray::Side;
use rayweave_table::TableError;
use std::collections::HashSet;
use std::path::Path;

/// The columns of a file of contours.
const COLUMNS: [&str; 3] = ["contour", "x", "y"];

/// Reading stops after this number of problems.
const MAX_PROBLEMS: usize = 20;

/// Reads the region bounded by the contours of a CSV file.
///
/// The first line names the columns `contour`, `x` and `y`, in any order; each further line is a vertex, and
/// blank lines are ignored. The rows of a contour are consecutive and have the same text, its name, in the
/// column `contour`. Islands are counter-clockwise, holes clockwise ([`from_polygons`]). Messages about the
/// geometry number the contours from 0 in the order of the file.
///
/// # Errors
///
/// A file that cannot be read; invalid rows, with their lines (reading stops after 20 problems); or the first
/// error of [`from_polygons`], such as contours that touch or have the wrong orientation.
pub fn read_region(path: impl AsRef<Path>, outside: Side) -> Result<Polygons, AnalysisError> {
    let path = path.as_ref();
    let bytes = rayweave_scene::read_bytes(path).map_err(|reason| TableError::Io {
        action: "read",
        path: path.display().to_string(),
        error: match path.try_exists() {
            Ok(false) => std::io::ErrorKind::NotFound.into(),
            _ => std::io::Error::other(reason),
        },
    })?;
    let invalid = |problems| ContourProblems { file: path.display().to_string(), problems };
    let contours = parse(&bytes).map_err(invalid)?;
    let region = from_polygons(&contours.points, outside);
    Ok(region.map_err(|error| invalid(vec![(contours.line_of(&error), error.to_string())]))?)
}

/// Problems of a file, with line numbers from 1; `None` for a problem of the whole file.
type Problems = Vec<(Option<usize>, String)>;

fn parse(bytes: &[u8]) -> Result<Contours, Problems> {
    let text = str::from_utf8(bytes).map_err(|error| {
        let line = 1 + bytes[..error.valid_up_to()].iter().filter(|&&b| b == b'\n').count();
        vec![(Some(line), "the text is not UTF-8. Is this a CSV file?".to_owned())]
    })?;
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut lines =
        text.lines().enumerate().map(|(k, line)| (k + 1, line)).filter(|(_, line)| !line.trim().is_empty());
    let Some((number, header)) = lines.next() else {
        return Err(vec![(
            None,
            "the file is empty: the first line must name the columns contour,x,y.".to_owned(),
        )]);
    };
    let positions = column_positions(header).map_err(|problem| vec![(Some(number), problem)])?;
    let mut contours = Contours::default();
    let mut problems = Problems::new();
    for (number, line) in lines {
        if let Err(problem) = contours.add(number, line, positions) {
            problems.push((Some(number), problem));
        }
        if problems.len() == MAX_PROBLEMS {
            problems.push((None, format!("stopped after {MAX_PROBLEMS} problems")));
            break;
        }
    }
    if problems.is_empty() { Ok(contours) } else { Err(problems) }
}

/// The fields of a line, separated by commas (also within quotes), without surrounding spaces and quotes.
fn fields(line: &str) -> Vec<&str> {
    line.split(',').map(|field| unquoted(field.trim())).collect()
}

fn unquoted(field: &str) -> &str {
    field.strip_prefix('"').and_then(|inner| inner.strip_suffix('"')).unwrap_or(field)
}

/// The positions of [`COLUMNS`] in the header.
fn column_positions(header: &str) -> Result<[usize; 3], String> {
    let names = fields(header);
    let position = |column: &str| names.iter().position(|name| name.eq_ignore_ascii_case(column));
    match COLUMNS.map(position) {
        [Some(contour), Some(x), Some(y)] if names.len() == 3 => Ok([contour, x, y]),
        _ => Err(format!("the header is `{}`: the columns must be contour,x,y.", header.trim())),
    }
}

/// The contours read so far.
#[derive(Default)]
struct Contours {
    /// The name of the last contour.
    last: String,
    names: HashSet<String>,
    points: Vec<Vec<[f64; 2]>>,
    /// The line number of each vertex.
    lines: Vec<Vec<usize>>,
}

impl Contours {
    /// The line number of the first vertex that the error names, or of the first vertex of the contour.
    fn line_of(&self, error: &PolygonError) -> Option<usize> {
        let (contour, vertex) = match *error {
            PolygonError::NotFinite { contour, vertex, .. }
            | PolygonError::Extreme { contour, vertex, .. } => (contour, vertex),
            PolygonError::Touching { first, .. } => (first.contour, first.from),
            PolygonError::Orientation { contour, .. } => (contour, 0),
            _ => return None,
        };
        self.lines.get(contour)?.get(vertex).copied()
    }

    /// Adds the vertex in a line of the file.
    fn add(&mut self, number: usize, line: &str, [contour, x, y]: [usize; 3]) -> Result<(), String> {
        let fields = fields(line);
        if fields.len() != 3 {
            return Err(format!(
                "the row has {} fields: there must be one for each of the 3 columns.",
                fields.len()
            ));
        }
        let point = [coordinate("x", fields[x])?, coordinate("y", fields[y])?];
        let name = fields[contour];
        if self.points.is_empty() || self.last != name {
            if !self.names.insert(name.to_owned()) {
                return Err(format!(
                    "contour `{name}` continues after another one: the rows of a contour must be consecutive."
                ));
            }
            self.last = name.to_owned();
            self.points.push(Vec::new());
            self.lines.push(Vec::new());
        }
        if let (Some(points), Some(lines)) = (self.points.last_mut(), self.lines.last_mut()) {
            points.push(point);
            lines.push(number);
        }
        Ok(())
    }
}

fn coordinate(column: &str, field: &str) -> Result<f64, String> {
    match field.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        Ok(value) => Err(format!("{column} is {value}: coordinates must be finite.")),
        Err(_) => Err(format!("{column} is `{field}`: it must be a number.")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn problems(text: &str) -> Vec<String> {
        let found = parse(text.as_bytes()).err().unwrap();
        let file = "f.csv".to_owned();
        ContourProblems { file, problems: found }.to_string().lines().map(str::to_owned).collect()
    }

    #[test]
    fn the_rows_of_a_contour_are_consecutive() {
        let text = "\u{feff}\"contour\", x ,y\r\n0,0,0\r\n0, 1e0 ,0\n\n0,0,1\nhole,5,5\n";
        let contours = parse(text.as_bytes()).unwrap().points;
        assert_eq!(contours, [vec![[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]], vec![[5.0, 5.0]]]);
        let swapped = parse(b"y,contour,x\n1,a,2\n").unwrap().points;
        assert_eq!(swapped, [[[2.0, 1.0]]]);
        assert_eq!(parse(b"contour,x,y\n").unwrap().points, [[[0.0; 2]; 0]; 0]);
    }

    #[test]
    fn all_problems_with_their_lines() {
        let text = "contour,x,y\n0,a,0\n0,1\n0,1,inf\n0,0,0\n1,0,0\n0,5,5\n";
        let expected = [
            "f.csv:2: x is `a`: it must be a number.",
            "f.csv:3: the row has 2 fields: there must be one for each of the 3 columns.",
            "f.csv:4: y is inf: coordinates must be finite.",
            "f.csv:7: contour `0` continues after another one: the rows of a contour must be consecutive.",
        ];
        assert_eq!(problems(text), expected);
        assert_eq!(
            problems("\n \n"),
            ["f.csv: the file is empty: the first line must name the columns contour,x,y."]
        );
        assert_eq!(
            problems("x,y\n0,0\n"),
            ["f.csv:1: the header is `x,y`: the columns must be contour,x,y."]
        );
        let many = "contour,x,y\n".to_owned() + &"0,,\n".repeat(50);
        assert_eq!(problems(&many).len(), MAX_PROBLEMS + 1);
        assert!(parse(b"contour,x,y\n0,0,0\n0,\xff,1\n").err().unwrap()[0].0 == Some(3));
    }
}
