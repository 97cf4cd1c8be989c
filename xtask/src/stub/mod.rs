//! The stub of the compiled half of the Python package, `_core.pyi`, from the sources of the binding.
//!
//! Names, parameters, default values and documentation are those of PyO3's attributes. Rust types are
//! mapped to Python types (`python_type`). Where that is impossible, as for `PyAny`, the signature
//! states the type in PyO3's syntax: `signature = (points: "ArrayLike") -> "NDArray[np.bool_]"`. Types
//! that PyO3's signatures cannot state, those of properties and overloads, are in attributes that the
//! compiler drops: `#[cfg_attr(false, stub("() -> dict[str, Solid]"))]`.
//!
//! The generator of PyO3 0.30 (`experimental-inspect`) does not suffice: it leaves out exceptions and
//! overloads, does not import the names in signatures, and does not support NumPy arrays.

mod attribute;
mod binding;
mod function;
mod imports;
mod page;
mod python_type;

use std::collections::{BTreeMap, BTreeSet};
use std::fs;

use syn::{ImplItem, Item, ItemImpl, ItemStruct, Type};

use crate::outcome::Outcome;
use crate::python::BINDING;
use crate::repository::Repository;
use attribute::Options;
use binding::{Binding, Export};
use function::{Function, Rust};
use imports::Package;
use page::{Class, function_text};
use python_type::{Scope, alias};

/// The command that writes the stub.
const COMMAND: &str = "cargo xtask stub --accept";

/// Compares the stub with the sources; the error is the first line that differs.
pub fn compare(repository: &Repository) -> Outcome {
    let (path, text) = (path(), text(repository)?);
    let found = fs::read_to_string(repository.root.join(&path)).unwrap_or_default();
    if found == text {
        return Ok(());
    }
    let equal = found.lines().zip(text.lines()).take_while(|(found, expected)| found == expected).count();
    Err(format!("{path}:{}: the file differs from the sources of the binding. Run {COMMAND}.", equal + 1))
}

/// Writes the stub if it differs from the sources.
pub fn accept(repository: &Repository) -> Outcome {
    if compare(repository).is_ok() {
        return Ok(());
    }
    let (path, text) = (path(), text(repository)?);
    fs::write(repository.root.join(&path), text)
        .map_err(|error| format!("{path}: cannot be written: {error}."))?;
    println!("{path}: written");
    Ok(())
}

fn path() -> String {
    format!("{BINDING}/python/rayweave/_core.pyi")
}

/// An item of the stub.
enum Part {
    Class(Class),
    Function(Function),
}

impl Part {
    fn name(&self) -> &str {
        match self {
            Part::Class(class) => &class.name,
            Part::Function(function) => &function.name,
        }
    }

    fn text(&self) -> String {
        match self {
            Part::Class(class) => class.text(),
            Part::Function(function) => function_text(function, ""),
        }
    }

    /// The names that it uses.
    fn names(&self) -> Vec<&str> {
        let (functions, mut names) = match self {
            Part::Class(class) => (&class.functions[..], class.decorator.iter().copied().collect::<Vec<_>>()),
            Part::Function(function) => (std::slice::from_ref(function), Vec::new()),
        };
        names.extend(functions.iter().flat_map(Function::annotations).flat_map(imports::names));
        names.extend(functions.iter().any(|function| function.signatures.len() > 1).then_some("overload"));
        names
    }
}

/// The text of the stub.
fn text(repository: &Repository) -> Result<String, String> {
    let binding = Binding::read(&repository.root, &format!("{BINDING}/src"))?;
    let package = Package::read(&repository.root.join(BINDING).join("python/rayweave"), "rayweave")?;
    let (mut parts, mut problems) = (Vec::new(), Vec::new());
    for export in &binding.exports {
        match part(&binding, export) {
            Ok(part) => parts.push(part),
            Err(own) => problems.extend(own),
        }
    }
    if !problems.is_empty() {
        return Err(problems.join("\n"));
    }
    let exported: BTreeSet<&str> = parts.iter().map(Part::name).collect();
    let mut used: BTreeSet<&str> = parts.iter().flat_map(Part::names).collect();
    let aliases = aliases(&binding, &used);
    used.extend(aliases.values().flatten().flat_map(|alternative| imports::names(alternative)));
    let own = exported.iter().copied().chain(aliases.keys().map(String::as_str)).collect();
    let imports = imports::statements(&used, &own, &package).map_err(|problems| problems.join("\n"))?;
    let names: String = exported.iter().map(|name| format!("    \"{name}\",\n")).collect();
    let aliases: String =
        aliases.iter().map(|(name, alternatives)| page::alias_text(name, alternatives)).collect();
    let texts: Vec<String> = parts.iter().map(Part::text).collect();
    Ok(format!(
        "# Generated from the sources of the binding: run `{COMMAND}` instead of editing.\n\n\
         {imports}\n__all__ = [\n{names}]\n\n{aliases}\n{}",
        texts.join("\n")
    ))
}

/// The names of the stub for types of arguments, such as `_Spec`, and the alternatives of each.
fn aliases(binding: &Binding, used: &BTreeSet<&str>) -> BTreeMap<String, Vec<String>> {
    let mut aliases = BTreeMap::new();
    let mut waiting: Vec<String> = used.iter().map(|name| (*name).to_owned()).collect();
    while let Some(name) = waiting.pop() {
        let Some(alternatives) = name.strip_prefix('_').and_then(|rust| alias(binding, rust)) else {
            continue;
        };
        if aliases.contains_key(&name) {
            continue;
        }
        waiting.extend(alternatives.iter().flat_map(|text| imports::names(text)).map(str::to_owned));
        aliases.insert(name, alternatives);
    }
    aliases
}

/// The item of the stub that an export becomes.
fn part(binding: &Binding, export: &Export) -> Result<Part, Vec<String>> {
    let scope = Scope { binding, file: export.file, own: None };
    match binding.item(export) {
        Some(Item::Fn(item)) => {
            let rust = Rust { attributes: &item.attrs, signature: &item.sig, is_free: true };
            let function = rust.functions(scope)?.into_iter().next();
            function.map(Part::Function).ok_or_else(|| vec![format!("{}: no function", export.rust)])
        }
        Some(Item::Struct(item)) => class(scope, export, item).map(Part::Class),
        Some(item) if let Some(exception) = binding::exception(item) => Ok(Part::Class(Class {
            name: export.python.clone(),
            base: Some(exception.base().to_owned()),
            decorator: None,
            documentation: exception.documentation.lines().map(str::to_owned).collect(),
            functions: Vec::new(),
        })),
        _ => Err(vec![format!("{}: it is exported to Python, and neither class nor function.", export.rust)]),
    }
}

fn class(scope: Scope<'_>, export: &Export, item: &ItemStruct) -> Result<Class, Vec<String>> {
    let file = scope.binding.file(scope.file);
    let options = Options::read(&item.attrs, &["pyclass", "pyo3"])
        .map_err(|error| vec![binding::located(&file.path, &error)])?;
    // a method of a base class returns the derived one
    let own = if options.is_subclassable { "Self" } else { &export.python };
    let scope = Scope { own: Some(own), ..scope };
    let (mut functions, mut problems) = (Vec::new(), Vec::new());
    for method in methods(&file.items, &export.rust) {
        let rust = Rust { attributes: &method.attrs, signature: &method.sig, is_free: false };
        match rust.functions(scope) {
            Ok(found) => functions.extend(found),
            Err(own) => problems.extend(own),
        }
    }
    if options.has_eq {
        functions.extend(["__eq__", "__ne__"].map(Function::comparison));
    }
    let base = options.extends.map(|base| scope.binding.class(&base).map(str::to_owned).unwrap_or(base));
    match problems.is_empty() {
        true => Ok(Class {
            name: export.python.clone(),
            base,
            decorator: Some(if options.is_subclassable { "disjoint_base" } else { "final" }),
            documentation: attribute::documentation(&item.attrs),
            functions,
        }),
        false => Err(problems),
    }
}

/// The methods that PyO3 exports of a class.
fn methods<'a>(items: &'a [Item], class: &str) -> impl Iterator<Item = &'a syn::ImplItemFn> {
    let is_own = move |item: &&ItemImpl| {
        let ty = match &*item.self_ty {
            Type::Path(path) => path.path.segments.last(),
            _ => None,
        };
        attribute::has(&item.attrs, "pymethods") && ty.is_some_and(|last| last.ident == class)
    };
    let blocks = items.iter().filter_map(|item| if let Item::Impl(item) = item { Some(item) } else { None });
    blocks.filter(is_own).flat_map(|block| &block.items).filter_map(|item| match item {
        ImplItem::Fn(method) => Some(method),
        _ => None,
    })
}
