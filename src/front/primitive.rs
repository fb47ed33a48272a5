//! What a renderer draws: anything that has a footprint.

use crate::footprint::Footprint;
use crate::footprint::surface::SurfaceFootprint;
use crate::format::Design;
use crate::rules::Rules;
use crate::setup::{Cull, setup, setup_surface};
use crate::splat::VolumeSplat;
use crate::splat::surface::SurfaceSplat;
use crate::view::{Pose, View};

/// Why a primitive is left out of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Rejected {
    /// Setup found nothing to draw.
    Culled(Cull),
    /// A number is NaN or infinite, or a quaternion has length 0.
    Invalid,
}

/// A splat that setup can bring to the screen. Scenes kept in a form of one's own (packed in flash, say) implement it.
pub trait Primitive<P: Pose> {
    /// What setup makes of it: a [`Footprint`] for [`Renderer`](super::Renderer), a [`SurfaceFootprint`] for
    /// [`SurfaceRenderer`](super::SurfaceRenderer).
    type Footprint;

    /// The footprint, or why there is none. Must be defined for all values, and not panic.
    fn set_up<D: Design>(
        &self,
        design: D,
        view: &View<P>,
        rules: &Rules,
    ) -> Result<Self::Footprint, Rejected>;
}

impl<P: Pose, S: Primitive<P>> Primitive<P> for &S {
    type Footprint = S::Footprint;

    #[inline(always)]
    fn set_up<D: Design>(
        &self,
        design: D,
        view: &View<P>,
        rules: &Rules,
    ) -> Result<S::Footprint, Rejected> {
        (**self).set_up(design, view, rules)
    }
}

impl<P: Pose> Primitive<P> for VolumeSplat<P::Centre> {
    type Footprint = Footprint;

    /// [`setup`]: every bit pattern is a splat, so that none is invalid.
    #[inline(always)]
    fn set_up<D: Design>(
        &self,
        design: D,
        view: &View<P>,
        rules: &Rules,
    ) -> Result<Footprint, Rejected> {
        setup(design, view, rules, self).map_err(Rejected::Culled)
    }
}

impl<P: Pose> Primitive<P> for SurfaceSplat<P::Centre> {
    type Footprint = SurfaceFootprint;

    /// [`setup_surface`], as above.
    #[inline(always)]
    fn set_up<D: Design>(
        &self,
        design: D,
        view: &View<P>,
        rules: &Rules,
    ) -> Result<SurfaceFootprint, Rejected> {
        setup_surface(design, view, rules, self).map_err(Rejected::Culled)
    }
}
