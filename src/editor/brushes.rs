//! The options of all brushes.

use crate::tools::brush::BrushId;
use crate::tools::brush::keys::RADIUS;
use crate::tools::brush::options::BrushOptions;

/// The options of all brushes, each its own.
#[derive(Clone, PartialEq, Debug)]
pub struct Brushes([BrushOptions; BrushId::ALL.len()]);

impl Default for Brushes {
    fn default() -> Self {
        Brushes(std::array::from_fn(|i| BrushOptions::first(BrushId::ALL[i])))
    }
}

impl Brushes {
    pub fn of(&self, brush: BrushId) -> &BrushOptions {
        &self.0[brush as usize]
    }

    pub fn of_mut(&mut self, brush: BrushId) -> &mut BrushOptions {
        &mut self.0[brush as usize]
    }

    pub fn radius(&self, brush: BrushId) -> f32 {
        self.of(brush).get(RADIUS)
    }

    /// Changes the radii of all brushes.
    pub fn change_radii(&mut self, change: impl Fn(f32) -> f32) {
        self.0.iter_mut().for_each(|options| options.set(RADIUS, change(options.get(RADIUS))));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_brush_has_options_of_its_own() {
        let mut brushes = Brushes::default();
        assert!(BrushId::ALL.iter().all(|brush| brushes.of(*brush).brush() == *brush));
        brushes.of_mut(BrushId::Clay).set(RADIUS, 33.0);
        assert_eq!((brushes.radius(BrushId::Clay), brushes.radius(BrushId::Smooth)), (33.0, 20.0));
        brushes.change_radii(|radius| 2.0 * radius);
        assert_eq!((brushes.radius(BrushId::Clay), brushes.radius(BrushId::Grab)), (66.0, 120.0));
    }
}
