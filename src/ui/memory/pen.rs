//! Remembers the options of pens: the pressure curve, and the effect on each brush.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::editor::pen_use::{PenTool, PenUse, PenUses};
use crate::input::pen::{EXPONENTS, FULL, PenCurve};
use crate::ui::memory::values::{neat, within};
use crate::ui::pens::PenState;

/// The choices. A curve counts only while the settings are the same as then.
#[derive(Default, Serialize, Deserialize)]
#[serde(default)]
pub struct KeptPens {
    curve: Option<[f64; 2]>,
    usual_curve: Option<[f64; 2]>,
    leads: BTreeMap<String, Vec<String>>,
}

const STRENGTH: &str = "strength";
const SIZE: &str = "size";
const TILT: &str = "tilt";

impl KeptPens {
    pub fn of(pens: &PenState, uses: &PenUses) -> KeptPens {
        let numbers = |curve: &PenCurve| Some([neat(curve.exponent), neat(curve.full_at)]);
        let words = |by: PenUse| {
            let words = [(by.strength, STRENGTH), (by.size, SIZE), (by.tilt, TILT)];
            words.into_iter().filter(|(on, _)| *on).map(|(_, word)| word.to_string()).collect()
        };
        let leads = PenTool::all().map(|brush| (brush.name().to_string(), words(uses.of(brush))));
        KeptPens {
            curve: numbers(&pens.curve),
            usual_curve: numbers(&pens.usual),
            leads: leads.collect(),
        }
    }

    /// Restores the choices.
    pub fn recall(&self, pens: &mut PenState, uses: &mut PenUses) {
        let usual = [neat(pens.usual.exponent), neat(pens.usual.full_at)];
        if let (Some([exponent, full_at]), Some(then)) = (self.curve, self.usual_curve)
            && then == usual
        {
            pens.curve = PenCurve {
                exponent: within(Some(exponent), EXPONENTS, pens.usual.exponent),
                full_at: within(Some(full_at), FULL, pens.usual.full_at),
            };
        }
        for brush in PenTool::all() {
            if let Some(words) = self.leads.get(brush.name()) {
                let has = |word: &str| words.iter().any(|known| known == word);
                let (strength, size, tilt) = (has(STRENGTH), has(SIZE), has(TILT));
                uses.set(brush, PenUse { strength, size, tilt });
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tools::brush::BrushId;

    fn again(text: &str, usual: PenCurve) -> (PenState, PenUses) {
        let (mut pens, mut uses) = (PenState::new(usual), PenUses::default());
        toml::from_str::<KeptPens>(text).unwrap().recall(&mut pens, &mut uses);
        (pens, uses)
    }

    #[test]
    fn choices_are_found_again_unless_the_settings_have_changed() {
        let usual = PenCurve::default();
        let chosen = PenCurve { exponent: 0.7, full_at: 0.85 };
        let pens = PenState { curve: chosen, ..PenState::new(usual) };
        let brush = PenTool::Brush(BrushId::Paint);
        let mut uses = PenUses::default();
        uses.set(brush, PenUse { strength: false, size: true, tilt: true });
        uses.set(PenTool::Solid, PenUse { size: true, ..PenUse::default() });
        let text = toml::to_string(&KeptPens::of(&pens, &uses)).unwrap();
        let (found, found_uses) = again(&text, usual);
        assert_eq!(found.curve, chosen);
        for brush in PenTool::all() {
            assert_eq!(found_uses.of(brush), uses.of(brush), "{brush:?}");
        }
        let other = PenCurve { exponent: 2.0, ..usual };
        assert_eq!(again(&text, other).0.curve, other);
        for odd in ["", "curve = [99.0, -1.0]\nusual_curve = [1.0, 1.0]"] {
            assert_eq!(again(odd, usual).0.curve, usual, "{odd}");
        }
    }
}
