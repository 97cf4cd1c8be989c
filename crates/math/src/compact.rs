//! Affine maps in less memory.

use crate::{Affine, Vec3};

/// An affine map in less memory: 32 bytes for a translation instead of 96, for trees with a map in each node. Any other map is on
/// the heap.
#[derive(Clone, Debug)]
pub struct CompactAffine(Form);

#[derive(Clone, Debug)]
enum Form {
    Translation(Vec3),
    General(Box<Affine>),
}

impl CompactAffine {
    /// The map, with the bits of the original one.
    pub fn get(&self) -> Affine {
        match &self.0 {
            Form::Translation(by) => Affine::translate(*by),
            Form::General(map) => **map,
        }
    }
}

impl From<Affine> for CompactAffine {
    fn from(map: Affine) -> CompactAffine {
        CompactAffine(match map.has_identity_linear() {
            true => Form::Translation(map.translation),
            false => Form::General(Box::new(map)),
        })
    }
}

impl PartialEq for CompactAffine {
    fn eq(&self, other: &CompactAffine) -> bool {
        self.get() == other.get()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn maps_keep_their_bits() {
        let mut maps = vec![
            Affine::IDENTITY,
            Affine::translate(Vec3::new(1.0, -0.0, 1e-300)),
            Affine::rotation(Vec3::Z, 30.0),
            Affine::scale(Vec3::splat(2.0)),
        ];
        let mut negative = Affine::IDENTITY;
        negative.linear.x_axis.y = -0.0;
        maps.push(negative);
        let bits = |map: &Affine| map.to_rows().map(|row| row.map(f64::to_bits));
        for map in &maps {
            assert_eq!(bits(&CompactAffine::from(*map).get()), bits(map));
        }
        assert_eq!(CompactAffine::from(negative), CompactAffine::from(Affine::IDENTITY));
        assert_ne!(CompactAffine::from(maps[1]), CompactAffine::from(maps[2]));
        let is_in_place = |map: Affine| matches!(CompactAffine::from(map).0, Form::Translation(_));
        assert!(is_in_place(maps[1]) && !is_in_place(maps[3]) && !is_in_place(negative));
        assert!(size_of::<CompactAffine>() <= 32);
    }
}
