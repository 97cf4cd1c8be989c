//! Types of Rust as types of Python.

use syn::{
    Attribute, Expr, ExprLit, GenericArgument, Item, ItemEnum, ItemStruct, Lit, PathArguments, PathSegment,
    Type,
};

use super::attribute;
use super::binding::{Binding, tuple_fields};

/// The direction in which a value is converted: Python accepts more types than it returns.
#[derive(Clone, Copy, PartialEq)]
pub enum Direction {
    /// From Python.
    Argument,
    /// To Python.
    Result,
}

/// The place at which a type occurs.
#[derive(Clone, Copy)]
pub struct Scope<'a> {
    /// The binding, with the definitions of all types.
    pub binding: &'a Binding,
    /// The number of the file.
    pub file: usize,
    /// The Python type of `Self`, in the methods of a class.
    pub own: Option<&'a str>,
}

/// The maximum depth of definitions that refer to each other.
const DEEPEST: usize = 16;

/// The alternatives of the alias in the stub for a type, by the name of the type in Rust. The type
/// derives `FromPyObject`, has unnamed fields, and has a unique name among such types.
pub fn alias(binding: &Binding, name: &str) -> Option<Vec<String>> {
    let mut items = binding.items(name).filter(|(_, item)| match item {
        Item::Struct(ItemStruct { attrs, .. }) | Item::Enum(ItemEnum { attrs, .. }) => is_converted(attrs),
        _ => false,
    });
    let (file, item) = items.next().filter(|_| items.next().is_none())?;
    let scope = Scope { binding, file, own: None };
    Translation { scope, direction: Direction::Argument, depth: 0 }.alternatives(item)
}

fn is_converted(attributes: &[Attribute]) -> bool {
    attribute::derives(attributes, "FromPyObject")
}

impl Scope<'_> {
    /// The Python type; `None` if it cannot be derived, as for `PyAny`.
    pub fn python(&self, ty: &Type, direction: Direction) -> Option<String> {
        Translation { scope: *self, direction, depth: 0 }.of(ty)
    }
}

#[derive(Clone, Copy)]
struct Translation<'a> {
    scope: Scope<'a>,
    direction: Direction,
    depth: usize,
}

impl Translation<'_> {
    fn of(self, ty: &Type) -> Option<String> {
        match ty {
            Type::Reference(reference) => self.of(&reference.elem),
            Type::Paren(paren) => self.of(&paren.elem),
            Type::Group(group) => self.of(&group.elem),
            Type::Slice(slice) if is_byte(&slice.elem) => Some("bytes".to_owned()),
            Type::Slice(slice) => self.list(&slice.elem),
            Type::Tuple(tuple) if tuple.elems.is_empty() => Some("None".to_owned()),
            Type::Tuple(tuple) => self.tuple(tuple.elems.iter()),
            Type::Array(array) => match (self.direction, length(&array.len)) {
                (Direction::Argument, Some(length)) => self.tuple((0..length).map(|_| &*array.elem)),
                _ => self.list(&array.elem),
            },
            Type::Path(path) => self.named(path.path.segments.last()?),
            _ => None,
        }
    }

    fn tuple<'t>(self, types: impl Iterator<Item = &'t Type>) -> Option<String> {
        let types: Vec<String> = types.map(|ty| self.of(ty)).collect::<Option<_>>()?;
        Some(format!("tuple[{}]", types.join(", ")))
    }

    fn list(self, element: &Type) -> Option<String> {
        let list = if self.direction == Direction::Argument { "Sequence" } else { "list" };
        Some(format!("{list}[{}]", self.of(element)?))
    }

    fn named(self, segment: &PathSegment) -> Option<String> {
        let name = segment.ident.to_string();
        let python = match name.as_str() {
            "f32" | "f64" => "float",
            "u8" | "u16" | "u32" | "u64" | "usize" | "i8" | "i16" | "i32" | "i64" | "isize" => "int",
            "bool" => "bool",
            "str" | "String" | "PyString" => "str",
            "PyBytes" => "bytes",
            "PathBuf" => "str | PathLike[str]",
            "PyIterator" => "Iterator[Any]",
            "Self" => return self.scope.own.map(str::to_owned),
            "Option" => return Some(format!("{} | None", self.of(argument(segment)?)?)),
            "Vec" => return self.list(argument(segment)?),
            "PyResult" | "Py" | "Bound" | "Borrowed" | "PyRef" | "PyRefMut" | "PyClassInitializer" => {
                return self.of(argument(segment)?);
            }
            _ if name.starts_with("PyArray") || name.starts_with("PyReadonlyArray") => {
                return Some(format!("NDArray[{}]", scalar(argument(segment)?)?));
            }
            _ => return self.defined(&name),
        };
        Some(python.to_owned())
    }

    /// The type that the binding defines under a name.
    fn defined(self, name: &str) -> Option<String> {
        if let Some(class) = self.scope.binding.class(name) {
            return Some(class.to_owned());
        }
        if self.depth == DEEPEST {
            return None;
        }
        let (file, item) = self.scope.binding.definition(self.scope.file, name)?;
        let inner = Translation { scope: Scope { file, ..self.scope }, depth: self.depth + 1, ..self };
        match item {
            Item::Type(alias) => inner.of(&alias.ty),
            Item::Struct(item) if tuple_fields(&item.fields).is_none() => {
                is_converted(&item.attrs).then(|| "Mapping[str, Any]".to_owned())
            }
            Item::Struct(ItemStruct { attrs, .. }) | Item::Enum(ItemEnum { attrs, .. }) => {
                is_converted(attrs).then(|| format!("_{name}"))
            }
            _ => None,
        }
    }

    /// The alternatives of a type that PyO3 converts field by field.
    fn alternatives(self, item: &Item) -> Option<Vec<String>> {
        match item {
            Item::Struct(item) => Some(vec![self.fields(&tuple_fields(&item.fields)?)?]),
            Item::Enum(item) => {
                item.variants.iter().map(|variant| self.fields(&tuple_fields(&variant.fields)?)).collect()
            }
            _ => None,
        }
    }

    /// A tuple, or the only field by itself.
    fn fields(self, fields: &[&Type]) -> Option<String> {
        match fields {
            [field] => self.of(field),
            fields => self.tuple(fields.iter().copied()),
        }
    }
}

fn is_byte(ty: &Type) -> bool {
    matches!(ty, Type::Path(path) if path.path.is_ident("u8"))
}

fn length(length: &Expr) -> Option<usize> {
    match length {
        Expr::Lit(ExprLit { lit: Lit::Int(number), .. }) => number.base10_parse().ok(),
        _ => None,
    }
}

/// The first type between the angle brackets.
fn argument(segment: &PathSegment) -> Option<&Type> {
    let PathArguments::AngleBracketed(arguments) = &segment.arguments else { return None };
    arguments.args.iter().find_map(|argument| match argument {
        GenericArgument::Type(ty) => Some(ty),
        _ => None,
    })
}

/// The type of the elements of an array.
fn scalar(ty: &Type) -> Option<&'static str> {
    let Type::Path(path) = ty else { return None };
    Some(match path.path.segments.last()?.ident.to_string().as_str() {
        "f32" => "np.float32",
        "f64" => "np.float64",
        "bool" => "np.bool_",
        "u8" => "np.uint8",
        "u16" => "np.uint16",
        "u32" => "np.uint32",
        "u64" => "np.uint64",
        "i32" => "np.int32",
        "i64" => "np.int64",
        _ => return None,
    })
}

/// The type within an `Option`, or the type itself.
pub fn without_option(ty: &Type) -> &Type {
    let Type::Path(path) = ty else { return ty };
    match path.path.segments.last() {
        Some(last) if last.ident == "Option" => argument(last).unwrap_or(ty),
        Some(last) if last.ident == "PyResult" => argument(last).map_or(ty, without_option),
        _ => ty,
    }
}

#[cfg(test)]
mod tests {
    use super::super::binding::tests::binding;
    use super::*;

    #[test]
    fn types_of_rust_have_types_in_python() {
        let lib = "#[pymodule] mod _core { #[pymodule_export] use crate::a::PyGlass; }";
        let a = r#"#[pyclass(name = "Glass")] struct PyGlass;
            #[derive(FromPyObject)] struct Spec(String, Vec<f64>);
            #[derive(FromPyObject)] enum Medium<'py> { Glass(PyRef<'py, PyGlass>), Index(f64, f64) }
            type Pair<'py> = (Bound<'py, PyArray1<f64>>, &'static str);"#;
        let binding = binding(&[("", lib), ("a", a)]);
        let scope = Scope { binding: &binding, file: 1, own: Some("Glass") };
        let cases = [
            ("Option<&str>", "str | None"),
            ("Vec<(String, usize)>", "Sequence[tuple[str, int]]"),
            ("[f64; 2]", "tuple[float, float]"),
            ("&[u8]", "bytes"),
            ("PyRef<'_, Self>", "Glass"),
            ("Spec", "_Spec"),
            ("Option<Medium<'_>>", "_Medium | None"),
        ];
        for (rust, python) in cases {
            let found = scope.python(&syn::parse_str(rust).unwrap(), Direction::Argument);
            assert_eq!(found.as_deref(), Some(python), "{rust}");
        }
        assert_eq!(alias(&binding, "Spec").unwrap(), ["tuple[str, Sequence[float]]"]);
        assert_eq!(alias(&binding, "Medium").unwrap(), ["Glass", "tuple[float, float]"]);
        assert_eq!(alias(&binding, "Pair"), None);
        let results = [
            ("PyResult<Vec<[f64; 2]>>", "list[list[float]]"),
            ("PyResult<Pair<'py>>", "tuple[NDArray[np.float64], str]"),
            ("()", "None"),
        ];
        for (rust, python) in results {
            let found = scope.python(&syn::parse_str(rust).unwrap(), Direction::Result);
            assert_eq!(found.as_deref(), Some(python), "{rust}");
        }
        assert_eq!(scope.python(&syn::parse_str("Bound<'py, PyAny>").unwrap(), Direction::Result), None);
    }
}
