//! Chooses among the options of a window system: format, present mode, size, composite alpha.
//!
//! Pure: takes the properties of surface and device, returns a choice.

use ash::vk;

/// Plain 8-bit formats first, since pictures are shaded and blended as sRGB values; then those with 10 bits, the only
/// ones of some screens; then those encoded by the device.
const FORMATS: [vk::Format; 8] = [
    vk::Format::B8G8R8A8_UNORM,
    vk::Format::R8G8B8A8_UNORM,
    vk::Format::A8B8G8R8_UNORM_PACK32,
    vk::Format::A2R10G10B10_UNORM_PACK32,
    vk::Format::A2B10G10R10_UNORM_PACK32,
    vk::Format::B8G8R8A8_SRGB,
    vk::Format::R8G8B8A8_SRGB,
    vk::Format::A8B8G8R8_SRGB_PACK32,
];

/// Returns the format to draw in. `usable`: whether the device draws and blends in a format.
pub fn format(
    offered: &[vk::SurfaceFormatKHR],
    usable: impl Fn(vk::Format) -> bool,
) -> Option<vk::SurfaceFormatKHR> {
    FORMATS.into_iter().filter(|&wanted| usable(wanted)).find_map(|wanted| {
        let fits = |f: &&vk::SurfaceFormatKHR| {
            f.format == wanted && f.color_space == vk::ColorSpaceKHR::SRGB_NONLINEAR
        };
        offered.iter().find(fits).copied()
    })
}

/// Returns the present mode: one that never waits for the window to be visible, since a covered window may stay hidden
/// for hours. FIFO waits on Wayland; it is used if the only alternative is tearing, and then pictures are drawn only
/// when the compositor asks for one.
pub fn present_mode(offered: &[vk::PresentModeKHR]) -> vk::PresentModeKHR {
    match offered.contains(&vk::PresentModeKHR::MAILBOX) {
        true => vk::PresentModeKHR::MAILBOX,
        false => vk::PresentModeKHR::FIFO,
    }
}

/// Returns the number of images: with a mailbox one is shown, one waits and one is drawn to.
pub fn image_count(of: &vk::SurfaceCapabilitiesKHR) -> u32 {
    let most = match of.max_image_count {
        0 => u32::MAX,
        most => most,
    };
    (of.min_image_count + 1).max(3).min(most)
}

/// Returns the window's size as the surface reports it, or `wanted` where it may be chosen; zero while nothing is
/// visible.
pub fn extent(of: &vk::SurfaceCapabilitiesKHR, wanted: [u32; 2]) -> [u32; 2] {
    let vk::Extent2D { width, height } = of.current_extent;
    let (min, max) = (of.min_image_extent, of.max_image_extent);
    if width != u32::MAX {
        return [width, height];
    }
    // A minimised window shows nothing, whatever its smallest size is.
    if wanted.contains(&0) || max.width == 0 || max.height == 0 {
        return [0, 0];
    }
    let between = |wanted: u32, min: u32, max: u32| wanted.max(min).min(max);
    [between(wanted[0], min.width, max.width), between(wanted[1], min.height, max.height)]
}

/// Returns the composite alpha: opaque, where it can be chosen.
pub fn composite_alpha(of: &vk::SurfaceCapabilitiesKHR) -> vk::CompositeAlphaFlagsKHR {
    let supported = of.supported_composite_alpha;
    [vk::CompositeAlphaFlagsKHR::OPAQUE, vk::CompositeAlphaFlagsKHR::INHERIT]
        .into_iter()
        .find(|&alpha| supported.contains(alpha))
        .unwrap_or(vk::CompositeAlphaFlagsKHR::PRE_MULTIPLIED)
}

/// The recovery from a failure of the window system.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Recovery {
    /// The window has changed: make another swapchain.
    NewSwapchain,
    /// The window is still in use, or between two states: try again later.
    Later,
    /// The surface is lost: create another one, with everything that depends on it.
    NewSurface,
}

/// Returns the recovery from a failure, if there is one.
pub fn recovery(failure: vk::Result) -> Option<Recovery> {
    match failure {
        vk::Result::ERROR_OUT_OF_DATE_KHR => Some(Recovery::NewSwapchain),
        vk::Result::ERROR_FULL_SCREEN_EXCLUSIVE_MODE_LOST_EXT => Some(Recovery::NewSwapchain),
        // Drivers return the second one if the size of the window has just changed.
        vk::Result::ERROR_NATIVE_WINDOW_IN_USE_KHR | vk::Result::ERROR_INITIALIZATION_FAILED => {
            Some(Recovery::Later)
        }
        vk::Result::ERROR_SURFACE_LOST_KHR => Some(Recovery::NewSurface),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn offered(formats: &[vk::Format]) -> Vec<vk::SurfaceFormatKHR> {
        let plain = vk::SurfaceFormatKHR::default().color_space(vk::ColorSpaceKHR::SRGB_NONLINEAR);
        formats.iter().map(|&format| plain.format(format)).collect()
    }

    #[test]
    fn a_window_of_10_bits_a_colour_will_do() {
        let ten = vk::Format::A2B10G10R10_UNORM_PACK32;
        let half = vk::Format::R16G16B16A16_SFLOAT;
        let chosen = |formats: &[vk::Format]| format(&offered(formats), |_| true).map(|f| f.format);
        assert_eq!(chosen(&[half, ten]), Some(ten));
        assert_eq!(chosen(&[vk::Format::A2R10G10B10_UNORM_PACK32]).map(|f| f.as_raw()), Some(58));
        // Formats without conversion are preferred.
        let eight = vk::Format::R8G8B8A8_UNORM;
        assert_eq!(chosen(&[ten, vk::Format::B8G8R8A8_SRGB, eight]), Some(eight));
        assert_eq!(chosen(&[vk::Format::B8G8R8A8_SRGB, ten]), Some(ten));
        assert_eq!(chosen(&[half]), None);
        assert_eq!(chosen(&[]), None);
    }

    #[test]
    fn a_format_that_the_device_cannot_draw_in_or_of_another_colour_space_is_passed_over() {
        let mut all = offered(&[vk::Format::B8G8R8A8_UNORM, vk::Format::R8G8B8A8_SRGB]);
        let cannot = |f| f != vk::Format::B8G8R8A8_UNORM;
        assert_eq!(format(&all, cannot).map(|f| f.format), Some(vk::Format::R8G8B8A8_SRGB));
        all[0].color_space = vk::ColorSpaceKHR::HDR10_ST2084_EXT;
        assert_eq!(format(&all, |_| true).map(|f| f.format), Some(vk::Format::R8G8B8A8_SRGB));
    }

    #[test]
    fn presenting_never_waits_where_that_can_be_chosen() {
        use vk::PresentModeKHR as Mode;
        let all = [Mode::IMMEDIATE, Mode::FIFO, Mode::MAILBOX, Mode::FIFO_RELAXED];
        assert_eq!(present_mode(&all), Mode::MAILBOX);
        assert_eq!(present_mode(&[Mode::FIFO, Mode::IMMEDIATE]), Mode::FIFO, "nothing tears");
        assert_eq!(present_mode(&[]), Mode::FIFO, "which is everywhere");
    }

    #[test]
    fn a_size_is_what_the_surface_says_or_within_what_it_allows() {
        let size = |width, height| vk::Extent2D { width, height };
        let mut of = vk::SurfaceCapabilitiesKHR::default()
            .min_image_extent(size(1, 1))
            .max_image_extent(size(4096, 2048))
            .current_extent(size(640, 480));
        assert_eq!(extent(&of, [800, 600]), [640, 480]);
        of = of.current_extent(size(u32::MAX, u32::MAX));
        assert_eq!(extent(&of, [800, 600]), [800, 600]);
        assert_eq!(extent(&of, [9000, 9000]), [4096, 2048]);
        assert_eq!(extent(&of, [0, 600]), [0, 0], "minimised");
        of = of.max_image_extent(size(0, 0));
        assert_eq!(extent(&of, [800, 600]), [0, 0], "and said so by the surface");
    }

    #[test]
    fn images_are_enough_for_a_mailbox_and_not_more_than_there_may_be() {
        let of = |min, max| {
            vk::SurfaceCapabilitiesKHR::default().min_image_count(min).max_image_count(max)
        };
        assert_eq!(image_count(&of(1, 0)), 3);
        assert_eq!(image_count(&of(3, 0)), 4);
        assert_eq!(image_count(&of(2, 2)), 2);
    }

    #[test]
    fn errors_of_the_window_system_in_a_resize_end_nothing() {
        use vk::Result as R;
        assert_eq!(recovery(R::ERROR_OUT_OF_DATE_KHR), Some(Recovery::NewSwapchain));
        assert_eq!(recovery(R::ERROR_NATIVE_WINDOW_IN_USE_KHR), Some(Recovery::Later));
        assert_eq!(recovery(R::ERROR_INITIALIZATION_FAILED), Some(Recovery::Later));
        assert_eq!(recovery(R::ERROR_SURFACE_LOST_KHR), Some(Recovery::NewSurface));
        assert_eq!(recovery(R::ERROR_DEVICE_LOST), None);
        assert_eq!(recovery(R::ERROR_OUT_OF_DEVICE_MEMORY), None);
    }
}
