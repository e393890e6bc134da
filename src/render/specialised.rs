//! Owns pipelines of one pass that differ in their specialization constants, made when first needed.
//!
//! A branch that such a constant decides costs nothing. A uniform must not decide any: lavapipe would
//! run both sides, and that of Mesa 22 clones and compiles the shader for every picture and keeps all
//! of the copies. So what a person moves while looking, as the place of a lamp or its strength, is a
//! uniform; what is there or not is a constant. Takes constants of few different values.

use crate::gpu::Result;

/// What has been made for each combination of `N` constants that was asked for.
pub(super) struct Specialised<const N: usize, P> {
    made: Vec<([u32; N], P)>,
}

impl<const N: usize, P> Specialised<N, P> {
    pub fn new() -> Specialised<N, P> {
        Specialised { made: Vec::new() }
    }

    /// What `make` makes with `constants`, unless that is there already.
    pub fn get(
        &mut self,
        constants: [u32; N],
        make: impl FnOnce(&[u32]) -> Result<P>,
    ) -> Result<&P> {
        let place = match self.made.iter().position(|(made, _)| *made == constants) {
            Some(place) => place,
            None => {
                self.made.push((constants, make(&constants)?));
                self.made.len() - 1
            }
        };
        Ok(&self.made[place].1)
    }
}
