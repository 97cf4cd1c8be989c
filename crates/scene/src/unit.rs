//! Units of length.

use std::fmt;

/// The unit of all lengths of a document.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Unit {
    /// 1e-9 m.
    Nanometre,
    /// 1e-6 m.
    Micrometre,
    /// 1e-3 m, the default.
    #[default]
    Millimetre,
    /// 1e-2 m.
    Centimetre,
    /// The metre.
    Metre,
    /// 1e3 m.
    Kilometre,
    /// 25.4 mm (exact since the international yard and pound agreement of 1959).
    Inch,
    /// 304.8 mm (also exact).
    Foot,
}

impl Unit {
    /// All units, with their symbols and lengths in metres.
    pub const ALL: [(Unit, &'static str, f64); 8] = [
        (Unit::Nanometre, "nm", 1e-9),
        (Unit::Micrometre, "um", 1e-6),
        (Unit::Millimetre, "mm", 1e-3),
        (Unit::Centimetre, "cm", 1e-2),
        (Unit::Metre, "m", 1.0),
        (Unit::Kilometre, "km", 1e3),
        (Unit::Inch, "in", 0.0254),
        (Unit::Foot, "ft", 0.3048),
    ];

    /// The unit with this symbol.
    pub fn parse(symbol: &str) -> Option<Unit> {
        Unit::ALL.iter().find(|(_, own, _)| *own == symbol).map(|(unit, _, _)| *unit)
    }

    /// The unit with this length, up to rounding.
    pub fn of_metres(metres: f64) -> Option<Unit> {
        let found = Unit::ALL.iter().find(|(_, _, own)| (own / metres - 1.0).abs() < 1e-9);
        found.map(|(unit, _, _)| *unit)
    }

    /// Its symbol.
    pub fn symbol(self) -> &'static str {
        self.row().1
    }

    /// Its length in metres.
    pub fn metres(self) -> f64 {
        self.row().2
    }

    fn row(self) -> (Unit, &'static str, f64) {
        Unit::ALL[self as usize]
    }
}

impl fmt::Display for Unit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.symbol())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_list_is_in_the_order_of_the_enum() {
        for (unit, symbol, metres) in Unit::ALL {
            assert_eq!(Unit::parse(symbol), Some(unit));
            assert_eq!((unit.symbol(), unit.metres()), (symbol, metres));
            assert_eq!(Unit::of_metres(1e-9 * (metres * 1e9)), Some(unit));
        }
        assert_eq!(Unit::parse("furlong"), None);
        assert_eq!(Unit::default().metres(), 0.001);
        assert_eq!(Unit::of_metres(0.9), None);
    }
}
