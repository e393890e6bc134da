//! How pictures show the mask: protected voxels are darker and bluish, and hatched along the diagonals of the grid.
//!
//! The only place with this rule: [`ShownColours`] applies it to voxels, for shaders on the CPU, and to pages of
//! bricks, for copies on a device. Knows no lights and no pictures.

use glam::{IVec3, UVec3};

use crate::sculpture::brick::{BRICK_EDGE_VX, Brick, BrickKind, local_coords, local_index};
use crate::sculpture::material::PageView;
use crate::sculpture::{ColourDepth, Grid, Material, Rgb};

/// Width of a line of the hatching, along any axis of the grid.
const LINE_VX: u32 = 3;

/// The colours mixed into a protected voxel's colour in dark and in light lines, and how many parts in 256 its own
/// colour keeps: few enough for the hatching to be visible on black and on white, enough to tell painted colours apart.
const DARK: (Rgb, u32) = (Rgb::new(12, 22, 60), 80);
const LIGHT: (Rgb, u32) = (Rgb::new(64, 96, 160), 96);

/// Returns the colour of the protected voxel at these coordinates in pictures, from its unprotected one.
#[inline]
pub fn mask_tint(Rgb(own): Rgb, voxel: UVec3) -> Rgb {
    let line = voxel.element_sum() / LINE_VX;
    let (Rgb(ink), share) = if line.is_multiple_of(2) { DARK } else { LIGHT };
    let mix = |own: u8, ink: u8| (u32::from(own) * share + u32::from(ink) * (256 - share)) >> 8;
    Rgb(std::array::from_fn(|i| mix(own[i], ink[i]) as u8))
}

/// The colours of a sculpture's voxels as a picture shows them.
#[derive(Clone, Copy, Debug)]
pub struct ShownColours<'a> {
    /// The voxels.
    pub grid: &'a Grid,
    /// Their colours.
    pub material: &'a Material,
    /// The colour that replaces those of all voxels.
    pub instead: Option<Rgb>,
    /// The protected voxels, if the mask is shown: a grid of the same size.
    pub mask: Option<&'a Grid>,
}

impl ShownColours<'_> {
    /// Returns the colour of all voxels of bricks without a page.
    pub fn base(&self) -> Rgb {
        self.instead.unwrap_or(self.material.base())
    }

    /// Returns the bits of a colour in pages: as many as the voxels' own have, if any.
    pub fn depth(&self) -> ColourDepth {
        match (self.instead, self.material.depth()) {
            (Some(_), _) | (None, ColourDepth::None) if self.mask.is_some() => ColourDepth::Bits24,
            (Some(_), _) => ColourDepth::None,
            (None, own) => own,
        }
    }

    /// Returns the colour of the voxel at `v`.
    #[inline]
    pub fn rgb(&self, v: UVec3) -> Rgb {
        let (brick, local) = (v / BRICK_EDGE_VX, v % BRICK_EDGE_VX);
        let own = || self.material.rgb(brick, local_index(local.x, local.y, local.z));
        let colour = self.instead.unwrap_or_else(own);
        match self.mask {
            Some(mask) if mask.brick(brick).get(local.x, local.y, local.z) => {
                self.depth().quantise(mask_tint(colour, v))
            }
            _ => colour,
        }
    }

    /// Returns the number of bricks with a page.
    pub fn page_count(&self) -> usize {
        match self.mask {
            None if self.instead.is_none() => self.material.page_count(),
            _ => (0..self.grid.brick_count()).filter(|&brick| self.has_page(brick)).count(),
        }
    }

    /// Calls `f` with the other bricks whose page a change of the voxels of `brick` may create or remove: its
    /// neighbours that may become, or cease to be, buried.
    pub fn for_each_dependent(&self, brick: usize, mut f: impl FnMut(usize)) {
        if let Some(mask) = self.mask {
            for_each_beside(self.grid, brick, |beside| {
                let is_full = self.grid.brick_kind(beside) == BrickKind::Full;
                if is_full && mask.brick_kind(beside) != BrickKind::Empty {
                    f(beside);
                }
            });
        }
    }

    /// Returns whether a brick has voxels of other colours than [`ShownColours::base`]. A buried brick whose only such
    /// voxels are protected has no page: they are invisible, and a mask may cover the whole inside of a sculpture.
    pub fn has_page(&self, brick: usize) -> bool {
        self.own_page(brick).is_some() || !self.tinted(brick).is_empty()
    }

    /// Writes the page of a brick that has one, packed by [`ShownColours::depth`] in the order of [`local_index`].
    pub fn write_page(&self, brick: usize, out: &mut [u8]) {
        let depth = self.depth();
        match self.own_page(brick) {
            Some(page) => _ = page.write_to(out),
            None => {
                let base = self.base();
                out.chunks_exact_mut(depth.bytes().max(1)).for_each(|out| depth.write(base, out));
            }
        }
        let corner = self.grid.brick_coords(brick) * BRICK_EDGE_VX;
        self.tinted(brick).for_each(|local| {
            let out = &mut out[local as usize * depth.bytes()..];
            let tint = mask_tint(depth.read(out), corner + UVec3::from(local_coords(local)));
            depth.write(tint, out);
        });
    }

    fn own_page(&self, brick: usize) -> Option<PageView<'_>> {
        self.material.page(self.grid.brick_coords(brick)).filter(|_| self.instead.is_none())
    }

    /// Returns the protected voxels of a brick that may be visible.
    fn tinted(&self, brick: usize) -> Brick {
        match self.mask {
            Some(mask) if mask.brick_kind(brick) != BrickKind::Empty => {
                let voxels = mask.brick_at(brick).and(self.grid.brick_at(brick));
                if voxels.is_empty() || self.is_buried(brick) { Brick::EMPTY } else { voxels }
            }
            _ => Brick::EMPTY,
        }
    }

    /// Returns whether a brick and its six neighbours are full.
    fn is_buried(&self, brick: usize) -> bool {
        let is_full = |brick| self.grid.brick_kind(brick) == BrickKind::Full;
        let mut beside = 0;
        is_full(brick) && {
            for_each_beside(self.grid, brick, |brick| beside += u32::from(is_full(brick)));
            beside == 6
        }
    }
}

/// Calls `f` with the bricks of `grid` that share a face with `brick`.
fn for_each_beside(grid: &Grid, brick: usize, mut f: impl FnMut(usize)) {
    let (at, dims) = (grid.brick_coords(brick).as_ivec3(), grid.brick_dims().as_ivec3());
    for step in [IVec3::X, IVec3::Y, IVec3::Z] {
        for beside in [at - step, at + step] {
            if beside.cmpge(IVec3::ZERO).all() && beside.cmplt(dims).all() {
                f(grid.brick_index(beside.as_uvec3()));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::scenes;

    #[test]
    fn protected_voxels_differ_from_any_colour_and_lines_from_each_other() {
        let lines = |own: Rgb| [0, LINE_VX].map(|x| mask_tint(own, UVec3::new(x, 0, 0)).0);
        let brightness = |Rgb(c): Rgb| c.into_iter().map(u32::from).sum::<u32>();
        for own in [Rgb::STONE, Rgb::new(255, 255, 255), Rgb::new(40, 30, 20), Rgb::default()] {
            let [dark, light] = lines(own);
            assert!(brightness(Rgb(dark)) + 90 < brightness(Rgb(light)), "{own}");
            for [r, g, b] in [dark, light] {
                assert!(b > r && b > g, "{own} is shown bluish");
            }
        }
        let [_, light] = lines(Rgb::STONE);
        assert!(brightness(Rgb(light)) + 90 < brightness(Rgb::STONE), "and clearly darker");
    }

    #[test]
    fn pages_hold_the_colours_that_voxels_are_shown_in() {
        let mut grid = Grid::new(UVec3::new(61, 47, 90), Vec3::ONE, 1 << 30).unwrap();
        let cheese = scenes::cheese(96, 60, 8).unwrap();
        grid.fill_bricks(|b| *cheese.brick(b));
        let mut mask = grid.emptied();
        mask.fill_bricks(|b| if b.x.is_multiple_of(2) { Brick::FULL } else { Brick::EMPTY });
        for depth in ColourDepth::ALL {
            let mut material = Material::for_grid(&grid, depth, Rgb::new(180, 170, 150));
            for brick in (0..grid.brick_count()).step_by(3) {
                material.paint(grid.brick_coords(brick), &Brick::FULL, Rgb([brick as u8, 90, 200]));
            }
            for instead in [None, Some(Rgb::new(178, 112, 84))] {
                for mask in [None, Some(&mask)] {
                    let shown = ShownColours { grid: &grid, material: &material, instead, mask };
                    check_pages(&shown);
                }
            }
        }
    }

    fn check_pages(shown: &ShownColours) {
        let depth = shown.depth();
        let mut page = vec![0; 512 * depth.bytes()];
        for (at, brick) in shown.grid.nonempty_bricks() {
            let index = shown.grid.brick_index(at);
            let has_page = shown.has_page(index);
            assert!(!has_page || depth != ColourDepth::None);
            if has_page {
                shown.write_page(index, &mut page);
            }
            brick.for_each(|local| {
                let expected = shown.rgb(at * BRICK_EDGE_VX + UVec3::from(local_coords(local)));
                if has_page {
                    assert_eq!(depth.read(&page[local as usize * depth.bytes()..]), expected);
                } else if !shown.is_buried(index) {
                    assert_eq!(shown.base(), expected);
                }
            });
        }
    }

    #[test]
    fn hidden_bricks_take_no_pages() {
        let mut grid = Grid::new(UVec3::splat(64), Vec3::ONE, 1 << 20).unwrap();
        grid.fill_bricks(|_| Brick::FULL);
        let mask = grid.clone();
        let material = Material::for_grid(&grid, ColourDepth::Bits24, Rgb::STONE);
        let shown =
            ShownColours { grid: &grid, material: &material, instead: None, mask: Some(&mask) };
        let pages = (0..grid.brick_count()).filter(|&brick| shown.has_page(brick)).count();
        assert_eq!(pages, 8 * 8 * 8 - 6 * 6 * 6);
    }
}
