//! Pipelines of one pass with different specialization constants, created when first needed.
//!
//! A branch on such a constant costs nothing. No branch may depend on a uniform: lavapipe would run both sides, and
//! that of Mesa 22 clones and compiles the shader for every picture and keeps all copies. Therefore a value that
//! changes continuously, such as the position of a lamp or its intensity, is a uniform; the existence of a feature is a
//! constant. Constants should have few different values.

use crate::gpu::Result;

/// The pipelines for the combinations of `N` constants requested so far.
pub(super) struct Specialised<const N: usize, P> {
    made: Vec<([u32; N], P)>,
}

impl<const N: usize, P> Specialised<N, P> {
    pub fn new() -> Specialised<N, P> {
        Specialised { made: Vec::new() }
    }

    /// Returns the pipeline with `constants`, created by `make` if it does not exist.
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
