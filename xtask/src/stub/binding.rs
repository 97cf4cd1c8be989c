//! The sources of the binding: the exports of its module, and the definitions of their types.

use std::fs;
use std::path::Path;

use syn::ext::IdentExt;
use syn::parse::{Parse, ParseStream};
use syn::{Expr, ExprMethodCall, Fields, Ident, Item, ItemMod, ItemUse, Stmt, Token, Type, UseTree};

use super::attribute::{self, Options};

/// All files of the binding.
pub struct Binding {
    files: Vec<File>,
    /// The exported items in the order of the files, then of the source.
    pub exports: Vec<Export>,
}

/// One file.
pub struct File {
    /// Path relative to the root of the repository.
    pub path: String,
    /// Path of its module, as `optics::glass`.
    module: String,
    /// Its items.
    pub items: Vec<Item>,
}

/// An item of the Python module.
pub struct Export {
    /// The number of its file.
    pub file: usize,
    /// Its name in Rust.
    pub rust: String,
    /// Its name in Python.
    pub python: String,
}

/// The exception that `create_exception!` defines.
pub struct Exception {
    /// Name.
    pub name: String,
    /// Base class, as PyO3 calls it.
    base: String,
    /// Documentation.
    pub documentation: String,
}

impl Exception {
    /// The base class in Python.
    pub fn base(&self) -> &str {
        self.base.strip_prefix("Py").unwrap_or(&self.base)
    }
}

impl Parse for Exception {
    fn parse(input: ParseStream<'_>) -> syn::Result<Self> {
        input.call(Ident::parse_any)?;
        input.parse::<Token![,]>()?;
        let name = input.parse::<Ident>()?.to_string();
        input.parse::<Token![,]>()?;
        let base: syn::Path = input.parse()?;
        let base = base.segments.last().map(|segment| segment.ident.to_string()).unwrap_or_default();
        let mut documentation = String::new();
        if input.parse::<Option<Token![,]>>()?.is_some() && !input.is_empty() {
            documentation = attribute::text(&input.parse()?).unwrap_or_default();
        }
        input.parse::<Option<Token![,]>>()?;
        Ok(Exception { name, base, documentation })
    }
}

/// The exception that an item defines, if any.
pub fn exception(item: &Item) -> Option<Exception> {
    let Item::Macro(item) = item else { return None };
    let is_one = item.mac.path.segments.last().is_some_and(|last| last.ident == "create_exception");
    is_one.then(|| item.mac.parse_body().ok()).flatten()
}

impl Binding {
    /// Reads the sources; `folder` is relative to the root, with `/` as separator.
    pub fn read(root: &Path, folder: &str) -> Result<Binding, String> {
        let mut paths = Vec::new();
        rust_files(&root.join(folder), String::new(), &mut paths)?;
        paths.sort_unstable();
        let files: Result<Vec<File>, String> =
            paths.iter().map(|path| File::read(root, folder, path)).collect();
        Binding::new(files?)
    }

    fn new(files: Vec<File>) -> Result<Binding, String> {
        let mut binding = Binding { files, exports: Vec::new() };
        let module = binding.module()?;
        let mut exports = Vec::new();
        for item in module {
            match item {
                Item::Use(item) if attribute::has(&item.attrs, "pymodule_export") => {
                    for path in paths(item) {
                        exports.push(binding.export(&path, None)?);
                    }
                }
                Item::Fn(item) if attribute::has(&item.attrs, "pymodule_init") => {
                    for (python, rust) in item.block.stmts.iter().filter_map(added_class) {
                        let path = used_path(module, &rust).unwrap_or(rust);
                        exports.push(binding.export(&path, Some(python))?);
                    }
                }
                _ => {}
            }
        }
        let place = |export: &Export| (export.file, binding.position(export));
        exports.sort_by_key(place);
        binding.exports = exports;
        Ok(binding)
    }

    /// A file by its number.
    pub fn file(&self, number: usize) -> &File {
        &self.files[number]
    }

    /// The item that an export names.
    pub fn item(&self, export: &Export) -> Option<&Item> {
        self.files[export.file].items.get(self.position(export)?)
    }

    fn position(&self, export: &Export) -> Option<usize> {
        self.files[export.file].items.iter().position(|item| defines(item, &export.rust))
    }

    /// The definition of a type that a file names, in the file itself or where it imports the type from.
    pub fn definition(&self, file: usize, name: &str) -> Option<(usize, &Item)> {
        let find = |number: usize, name: &str| {
            let mut items = self.files[number].items.iter();
            items.find(|item| is_type(item) && defines(item, name)).map(|item| (number, item))
        };
        find(file, name).or_else(|| {
            let own = &self.files[file];
            let path = used_path(&own.items, name)?;
            let (module, name) = path.rsplit_once("::")?;
            let below = format!("{}::{module}", own.module);
            find(self.files.iter().position(|file| file.module == module || file.module == below)?, name)
        })
    }

    /// All types of a name, with the numbers of their files.
    pub fn items(&self, name: &str) -> impl Iterator<Item = (usize, &Item)> {
        let all = self
            .files
            .iter()
            .enumerate()
            .flat_map(|(number, file)| file.items.iter().map(move |i| (number, i)));
        all.filter(move |(_, item)| is_type(item) && defines(item, name))
    }

    /// The Python name of an exported class.
    pub fn class(&self, rust: &str) -> Option<&str> {
        self.exports.iter().find(|export| export.rust == rust).map(|export| export.python.as_str())
    }

    /// The items of the Python module.
    fn module(&self) -> Result<&[Item], String> {
        let items = self.files.iter().filter(|file| file.module.is_empty()).flat_map(|file| &file.items);
        let mut modules = items.filter_map(|item| match item {
            Item::Mod(ItemMod { attrs, content: Some((_, items)), .. })
                if attribute::has(attrs, "pymodule") =>
            {
                Some(items.as_slice())
            }
            _ => None,
        });
        modules.next().ok_or_else(|| "the binding has no #[pymodule]".to_owned())
    }

    fn export(&self, path: &str, python: Option<String>) -> Result<Export, String> {
        let (module, rust) = path.rsplit_once("::").unwrap_or(("", path));
        let missing = || format!("{path}: it is exported to Python, and no file of the binding defines it.");
        let file = self.files.iter().position(|file| file.module == module).ok_or_else(missing)?;
        let mut items = self.files[file].items.iter();
        let item = items.find(|item| defines(item, rust)).ok_or_else(missing)?;
        let python = match python {
            Some(python) => python,
            None => python_name(item).map_err(|error| format!("{path}: {error}"))?.unwrap_or(rust.to_owned()),
        };
        Ok(Export { file, rust: rust.to_owned(), python })
    }
}

impl File {
    fn read(root: &Path, folder: &str, path: &str) -> Result<File, String> {
        let path_in_root = format!("{folder}/{path}");
        let text = fs::read_to_string(root.join(&path_in_root))
            .map_err(|error| format!("{path_in_root}: cannot be read: {error}."))?;
        let module = path.trim_end_matches(".rs").trim_end_matches("/mod").replace('/', "::");
        let module = if module == "lib" { String::new() } else { module };
        File::parse(path_in_root, module, &text)
    }

    fn parse(path: String, module: String, text: &str) -> Result<File, String> {
        let parsed = syn::parse_file(text).map_err(|error| located(&path, &error))?;
        Ok(File { path, module, items: parsed.items })
    }
}

/// An error with the place in the file.
pub fn located(path: &str, error: &syn::Error) -> String {
    let start = error.span().start();
    format!("{path}:{}:{}: {error}", start.line, start.column + 1)
}

/// The paths of all Rust files below a folder, relative to it.
fn rust_files(folder: &Path, prefix: String, paths: &mut Vec<String>) -> Result<(), String> {
    let failed = |error: std::io::Error| format!("{}: cannot be read: {error}.", folder.display());
    for entry in fs::read_dir(folder).map_err(failed)? {
        let entry = entry.map_err(failed)?;
        let name = entry.file_name().to_string_lossy().into_owned();
        if entry.path().is_dir() {
            rust_files(&entry.path(), format!("{prefix}{name}/"), paths)?;
        } else if name.ends_with(".rs") {
            paths.push(format!("{prefix}{name}"));
        }
    }
    Ok(())
}

/// The paths that a `use` names, without `crate::`.
fn paths(item: &ItemUse) -> Vec<String> {
    let mut found = Vec::new();
    let mut waiting = vec![(String::new(), &item.tree)];
    while let Some((prefix, tree)) = waiting.pop() {
        match tree {
            UseTree::Path(path) if path.ident == "crate" => waiting.push((prefix, &path.tree)),
            UseTree::Path(path) => waiting.push((format!("{prefix}{}::", path.ident), &path.tree)),
            UseTree::Name(name) => found.push(format!("{prefix}{}", name.ident)),
            UseTree::Group(group) => {
                waiting.extend(group.items.iter().map(|tree| (prefix.clone(), tree)));
            }
            _ => {}
        }
    }
    found
}

/// The path that the `use` items of a module give to a name.
fn used_path(items: &[Item], name: &str) -> Option<String> {
    let uses = items.iter().filter_map(|item| if let Item::Use(item) = item { Some(item) } else { None });
    let mut all = uses.flat_map(paths);
    all.find(|path| path.rsplit("::").next() == Some(name))
}

/// The names in Python and in Rust of a class that a statement `module.add("Name", py.get_type::<Class>())` adds.
fn added_class(statement: &Stmt) -> Option<(String, String)> {
    let Stmt::Expr(Expr::MethodCall(call), _) = statement else { return None };
    let call: &ExprMethodCall = call;
    let name = call.args.first().filter(|_| call.method == "add").and_then(attribute::text)?;
    let Some(Expr::MethodCall(class)) = call.args.get(1) else { return None };
    let Some(syn::GenericArgument::Type(Type::Path(class))) = class.turbofish.as_ref()?.args.first() else {
        return None;
    };
    Some((name, class.path.segments.last()?.ident.to_string()))
}

fn is_type(item: &Item) -> bool {
    matches!(item, Item::Struct(_) | Item::Enum(_) | Item::Type(_))
}

/// True if an item defines a name.
fn defines(item: &Item, name: &str) -> bool {
    match item {
        Item::Fn(item) => item.sig.ident == name,
        Item::Struct(item) => item.ident == name,
        Item::Enum(item) => item.ident == name,
        Item::Type(item) => item.ident == name,
        item => exception(item).is_some_and(|exception| exception.name == name),
    }
}

/// The name that PyO3's attributes give to an item.
fn python_name(item: &Item) -> syn::Result<Option<String>> {
    Ok(match item {
        Item::Fn(item) => Options::read(&item.attrs, &["pyo3", "pyfunction"])?.name,
        Item::Struct(item) => Options::read(&item.attrs, &["pyo3", "pyclass"])?.name,
        _ => None,
    })
}

/// The types of fields without names.
pub fn tuple_fields(fields: &Fields) -> Option<Vec<&Type>> {
    match fields {
        Fields::Unnamed(fields) => Some(fields.unnamed.iter().map(|field| &field.ty).collect()),
        _ => None,
    }
}

#[cfg(test)]
pub mod tests {
    use super::*;

    /// A binding of files given by module and text.
    pub fn binding(files: &[(&str, &str)]) -> Binding {
        let file = |&(module, text): &(&str, &str)| {
            File::parse(format!("{module}.rs"), module.to_owned(), text).unwrap()
        };
        Binding::new(files.iter().map(file).collect()).unwrap()
    }

    #[test]
    fn exports_have_the_names_of_python() {
        let lib = r#"#[pymodule] mod _core {
            use crate::a::Other;
            #[pymodule_export] use crate::a::{f, Class};
            #[pymodule_init] fn init(module: &M) -> R { module.add("Renamed", py.get_type::<Other>()) }
        }"#;
        let a = r#"#[pyclass(name = "Solid")] struct Class; #[pyclass(name = "Solid")] struct Other;
            #[pyfunction] #[pyo3(name = "g")] fn f() {}"#;
        let binding = binding(&[("", lib), ("a", a)]);
        let names: Vec<&str> = binding.exports.iter().map(|export| export.python.as_str()).collect();
        assert_eq!(names, ["Solid", "Renamed", "g"]);
        assert_eq!(binding.class("Other"), Some("Renamed"));
    }
}
