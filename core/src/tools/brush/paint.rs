//! Brush: paints the visible surface under it.

use super::change::{BrushChange, Paint, Site};
use super::dab::{Dab, DabPlace};
use super::footprint::{Footprint, Outline};
use super::kernel::rays;
use super::kernel::stamp::Stamp;
use super::keys::{COLOUR, COVER, OUTLINE, RADIUS, REACH, STRENGTH};
use super::mix::Mix;
use super::spec::{BrushSpec, ContactKind, Inverse, Keeps, Script};
use super::stencil::Stencil;
use super::{BrushDirection, BrushId, BrushUse};
use crate::refusal::InvalidValue;

/// See [`BrushSpec`].
pub const SPEC: BrushSpec = BrushSpec {
    name: "paintbrush",
    action: "paintbrush",
    label: "Brush",
    help: "Brush: paints the visible surface under it",
    effect: "Paints the visible surface. With a PNG or JPEG image it is a stencil, whose longer side is as long as the brush is wide: it prints the image, or the current colour through the bright parts of the image. Inverted, or with the eraser of a pen, it restores the bare colour.",
    keeps: Keeps::of("kept", "changed", "kept"),
    synonyms: "paint airbrush colour",
    options: &[
        RADIUS.param,
        OUTLINE.param,
        STRENGTH.range(0.01, 1.0).help("Opacity of the colour in each pass").param,
    ],
    inverse: Inverse::Sense,
    pressure: Some(STRENGTH),
    gives_colour: true,
    idle: "Nothing was painted: it has this colour already",
    // Side by side, since overlapping prints would blur the image.
    image_spacing: Some(2.0),
    dab: |dab| Some(used(dab)),
    script: Some(Script {
        contact: ContactKind::Footprint,
        params: &[REACH.param, COLOUR.param, COVER.param],
        replaces_stroke: false,
        needs_colours: true,
        apply,
    }),
    ..BrushSpec::SURFACE
};

/// Makes a use of the brush. An image has its own outline and, unless the colour shows through it, its own colours.
fn used(dab: &Dab) -> BrushUse {
    let cover = dab.options.get(STRENGTH);
    let DabPlace::Picture { footprint, colour, image: Some(image), .. } = dab.place else {
        return dab.used(BrushDirection::None).with(COVER, cover);
    };
    let footprint = Footprint { outline: Outline::Square, ..footprint };
    let mut used = BrushUse::under(BrushId::Paint, footprint).with(COVER, cover);
    used.picture = Some(image.path.to_path_buf());
    if image.lets_colour_through { used.with(COLOUR, colour) } else { used }
}

/// Paints. Each mirror image of the brush has its own copy of an image; a colour is dithered as under the brush itself.
fn apply(used: &BrushUse, site: &Site) -> Result<BrushChange, InvalidValue> {
    let Some(footprint) = used.footprint() else { return Ok(BrushChange::default()) };
    let cover = used.get(COVER);
    let Some(texture) = site.picture else {
        let mix = Mix::new(used.get(COLOUR), cover, footprint, site.depth());
        let seen = rays::under(used, site, |footprint| Stamp {
            paint: rays::seen(footprint, site),
            ..Stamp::default()
        });
        return Ok(BrushChange::painted(seen.paint, Paint::Mix(mix)));
    };
    let paint = site.images.iter().map(|image| {
        let footprint = footprint.image(image);
        let stencil = Stencil::new(texture, &footprint, used.find(COLOUR), cover);
        (rays::seen(&footprint, site), Paint::Stencil(stencil))
    });
    Ok(BrushChange { paint: paint.collect(), ..BrushChange::default() })
}
