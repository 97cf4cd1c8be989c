//! The check of layers: compares the dependencies of the crates with the table in ARCHITECTURE.md,
//! and looks for import cycles between files.

use std::process::Command;

use serde_json::Value;

use crate::cycles;
use crate::outcome::Outcome;
use crate::process;
use crate::repository::Repository;

/// The file with the table, between [`OPEN`] and [`CLOSE`].
const FILE: &str = "ARCHITECTURE.md";
const OPEN: &str = "<!-- layers -->";
const CLOSE: &str = "<!-- /layers -->";

/// One row of the table.
#[derive(Debug, PartialEq, Eq)]
struct Layer {
    storey: u32,
    name: String,
    may_depend_on: Vec<String>,
    /// The row's line in the file.
    line: usize,
}

/// A workspace member and its normal and build dependencies within the workspace.
#[derive(Debug, PartialEq, Eq)]
struct Member {
    name: String,
    depends_on: Vec<String>,
}

/// Compares the table with the workspace and prints every difference.
pub fn run(repository: &Repository) -> Outcome {
    let text = repository.source(FILE)?.ok_or_else(|| format!("{FILE}: no text"))?.text;
    let layers = read_table(&text)?;
    let members = read_members(&metadata(repository)?)?;
    let mut problems = table_problems(&layers);
    problems.extend(member_problems(&layers, &members));
    problems.extend(cycles::problems(repository, FILE, &text)?);
    for problem in &problems {
        println!("{problem}");
    }
    match problems.len() {
        0 => {
            println!("layers: {} crates checked", members.len());
            Ok(())
        }
        count => Err(format!("layers: {count} problems")),
    }
}

/// Output of `cargo metadata` for the workspace.
pub fn metadata(repository: &Repository) -> Result<Value, String> {
    let mut cargo = Command::new("cargo");
    cargo.current_dir(&repository.root).args(["metadata", "--format-version", "1", "--no-deps"]);
    let text = process::output(&mut cargo)?;
    serde_json::from_str(&text).map_err(|error| format!("cargo metadata: {error}"))
}

/// Reads the table of layers.
fn read_table(text: &str) -> Result<Vec<Layer>, String> {
    let lines: Vec<&str> = text.lines().collect();
    let marker = |wanted: &str| {
        let found = lines.iter().position(|line| line.trim() == wanted);
        found.ok_or_else(|| {
            format!("{FILE}: no line '{wanted}': the table of layers must be between two markers.")
        })
    };
    let (open, close) = (marker(OPEN)?, marker(CLOSE)?);
    let rows = (open + 1..close).filter(|&index| !lines[index].trim().is_empty());
    // the first two rows are the heading and the separator
    rows.skip(2).map(|index| read_row(lines[index], index + 1)).collect()
}

/// Reads a row `| storey | crate | may depend on |`.
fn read_row(row: &str, line: usize) -> Result<Layer, String> {
    let cells: Vec<&str> = row.trim().trim_matches('|').split('|').map(str::trim).collect();
    let [storey, name, may_depend_on] = cells[..] else {
        return Err(format!(
            "{FILE}:{line}: a row has {} cells, but needs 3: storey, crate, may depend on.",
            cells.len()
        ));
    };
    let storey = storey.parse().map_err(|_| format!("{FILE}:{line}: storey '{storey}' is not a number"))?;
    let may_depend_on = match may_depend_on {
        "none" => Vec::new(),
        names => names.split(',').map(bare).collect(),
    };
    Ok(Layer { storey, name: bare(name), may_depend_on, line })
}

/// A name without its backticks.
fn bare(name: &str) -> String {
    name.trim().trim_matches('`').to_owned()
}

/// Members and their dependencies on each other.
fn read_members(metadata: &Value) -> Result<Vec<Member>, String> {
    let packages = metadata["packages"].as_array().ok_or("cargo metadata: no packages")?;
    let name_of = |value: &Value| value["name"].as_str().unwrap_or_default().to_owned();
    let names: Vec<String> = packages.iter().map(name_of).collect();
    let depends_on = |package: &Value| {
        let dependencies = package["dependencies"].as_array().into_iter().flatten();
        dependencies
            .filter(|found| found["kind"] != "dev")
            .map(name_of)
            .filter(|name| names.contains(name))
            .collect()
    };
    Ok(packages
        .iter()
        .map(|package| Member { name: name_of(package), depends_on: depends_on(package) })
        .collect())
}

/// Problems of the table itself: a row may name only crates of earlier rows.
fn table_problems(layers: &[Layer]) -> Vec<String> {
    let mut problems = Vec::new();
    for (index, layer) in layers.iter().enumerate() {
        let Layer { storey, name, line, .. } = layer;
        let above = &layers[..index];
        if above.iter().any(|other| other.name == *name) {
            problems.push(format!("{FILE}:{line}: second row for {name}: each crate has one."));
        }
        if above.last().is_some_and(|last| last.storey > *storey) {
            problems.push(format!(
                "{FILE}:{line}: storey {storey} follows a higher one: storeys must not decrease."
            ));
        }
        for wanted in
            layer.may_depend_on.iter().filter(|wanted| !above.iter().any(|other| other.name == **wanted))
        {
            problems.push(format!("{FILE}:{line}: {name} may depend on {wanted}, which no row above names"));
        }
    }
    problems
}

/// Differences between the workspace and the table.
fn member_problems(layers: &[Layer], members: &[Member]) -> Vec<String> {
    let mut problems = Vec::new();
    for Member { name, depends_on } in members {
        let Some(layer) = layers.iter().find(|layer| layer.name == *name) else {
            problems.push(format!(
                "{FILE}: no row for {name}: every crate has a storey. Add it between the markers."
            ));
            continue;
        };
        for other in depends_on.iter().filter(|other| !layer.may_depend_on.contains(other)) {
            let line = layer.line;
            problems.push(format!(
                "{name} depends on {other}: {FILE}:{line} does not permit it. Move the code, or change the table."
            ));
        }
    }
    let gone = layers.iter().filter(|layer| !members.iter().any(|member| member.name == layer.name));
    problems.extend(gone.map(|layer| format!("{FILE}:{}: no crate {}", layer.line, layer.name)));
    problems
}

#[cfg(test)]
mod tests {
    use super::*;

    const TABLE: &str = "# A\n<!-- layers -->\n| storey | crate | may depend on |\n| --- | --- | --- |\n\
                         | 0 | `math` | none |\n| 0 | `shape` | `math` |\n| 1 | `top` | `math`, `shape` |\n<!-- /layers -->\n";

    fn member(name: &str, depends_on: &[&str]) -> Member {
        Member { name: name.to_owned(), depends_on: depends_on.iter().map(|&name| name.to_owned()).collect() }
    }

    #[test]
    fn the_table_is_read() {
        let layers = read_table(TABLE).unwrap();
        assert_eq!(layers.len(), 3);
        let top = Layer {
            storey: 1,
            name: "top".into(),
            may_depend_on: vec!["math".into(), "shape".into()],
            line: 7,
        };
        assert_eq!(layers[2], top);
        assert!(layers[0].may_depend_on.is_empty());
        assert_eq!(table_problems(&layers), Vec::<String>::new());
    }

    #[test]
    fn bad_tables_are_refused() {
        assert!(read_table("# A\n").unwrap_err().contains("no line '<!-- layers -->'"));
        assert!(read_table(&TABLE.replace("| 1 | `top` |", "| 1 |")).unwrap_err().contains(":7: 2 cells"));
        assert!(
            read_table(&TABLE.replace("| 1 |", "| x |"))
                .unwrap_err()
                .contains(":7: storey 'x' is not a number")
        );
    }

    #[test]
    fn arrows_point_up_the_table() {
        let problems = |table: String| table_problems(&read_table(&table).unwrap()).join("\n");
        assert!(problems(TABLE.replace("`math` | none", "`math` | `top`")).contains("no row above names"));
        assert!(problems(TABLE.replace("`math` | none", "`math` | `math`")).contains("no row above names"));
        assert!(problems(TABLE.replace("`top` |", "`math` |")).contains("second row for math"));
        assert!(problems(TABLE.replace("| 0 | `math`", "| 3 | `math`")).contains("must not decrease"));
    }

    #[test]
    fn the_workspace_keeps_to_the_table() {
        let layers = read_table(TABLE).unwrap();
        let problems = |members: &[Member]| member_problems(&layers, members);
        let good = [member("math", &[]), member("shape", &["math"]), member("top", &["shape"])];
        assert_eq!(problems(&good), Vec::<String>::new());
        let bad = [member("math", &[]), member("shape", &["math", "top"]), member("new", &[])];
        let found = problems(&bad).join("\n");
        assert!(found.contains("shape depends on top: ARCHITECTURE.md:6 does not permit it."), "{found}");
        assert!(found.contains("no row for new"), "{found}");
        assert!(found.contains("ARCHITECTURE.md:7: no crate top"), "{found}");
    }

    #[test]
    fn dev_dependencies_are_free() {
        let text = r#"{"packages": [
            {"name": "math", "dependencies": [{"name": "shape", "kind": "dev"}, {"name": "libm", "kind": null}]},
            {"name": "shape", "dependencies": [{"name": "math", "kind": null}, {"name": "math", "kind": "build"}]}]}"#;
        let members = read_members(&serde_json::from_str(text).unwrap()).unwrap();
        assert_eq!(members, [member("math", &[]), member("shape", &["math", "math"])]);
    }
}
