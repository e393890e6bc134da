//! The connection to an OpenXR runtime with a headset, before there is a session: its properties.

use glam::UVec2;
use openxr as xr;

use super::error::{Doing, HeadsetError, Result};
use super::head_locator::enable_time_conversion;

pub(super) const VIEWS: xr::ViewConfigurationType = xr::ViewConfigurationType::PRIMARY_STEREO;
/// The Vulkan version that the renderer is written for.
const VULKAN: xr::Version = xr::Version::new(1, 3, 0);

/// The blending of pictures with the surroundings.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum BlendMode {
    /// Blended with the surroundings if the headset can, otherwise opaque.
    #[default]
    Auto,
    /// Opaque pictures instead of the surroundings.
    Opaque,
    /// Added to the light of the surroundings: black is transparent.
    Additive,
    /// Blended by alpha.
    Alpha,
}

impl BlendMode {
    /// Returns the text in the interface.
    pub const fn label(self) -> &'static str {
        match self {
            BlendMode::Auto => "automatic",
            BlendMode::Opaque => "hidden",
            BlendMode::Additive => "additive",
            BlendMode::Alpha => "visible",
        }
    }

    /// Returns the option for a blend mode of the runtime, if there is one.
    pub(super) fn of(mode: xr::EnvironmentBlendMode) -> Option<BlendMode> {
        match mode {
            xr::EnvironmentBlendMode::OPAQUE => Some(BlendMode::Opaque),
            xr::EnvironmentBlendMode::ADDITIVE => Some(BlendMode::Additive),
            xr::EnvironmentBlendMode::ALPHA_BLEND => Some(BlendMode::Alpha),
            _ => None,
        }
    }

    /// Returns the available mode closest to this option.
    pub fn nearest(self, offered: &[BlendMode]) -> Option<BlendMode> {
        use BlendMode::{Additive, Alpha, Opaque};
        let order = match self {
            BlendMode::Auto | Alpha => [Alpha, Additive, Opaque],
            Opaque => [Opaque, Additive, Alpha],
            Additive => [Additive, Alpha, Opaque],
        };
        order.into_iter().find(|blend| offered.contains(blend))
    }

    /// Returns the mode to request, out of the runtime's modes.
    pub(super) fn choose(
        self,
        offered: &[xr::EnvironmentBlendMode],
    ) -> Option<xr::EnvironmentBlendMode> {
        let blends: Vec<BlendMode> =
            offered.iter().filter_map(|mode| BlendMode::of(*mode)).collect();
        let nearest = self.nearest(&blends);
        offered.iter().copied().find(|mode| nearest.is_some() && BlendMode::of(*mode) == nearest)
    }
}

fn no_runtime(error: xr::sys::Result) -> HeadsetError {
    HeadsetError::NoRuntime(error.to_string())
}

/// Loads the OpenXR loader. Returns it with the extensions of its runtime.
pub(super) fn load_entry() -> Result<(xr::Entry, xr::ExtensionSet)> {
    // SAFETY: loading runs the loader's initialisers; a system's OpenXR loader is trusted as the
    // Vulkan loader is.
    let entry = unsafe { xr::Entry::load(&()) }
        .map_err(|error| HeadsetError::NoLoader(error.to_string()))?;
    let offered = entry.enumerate_extensions().map_err(no_runtime)?;
    Ok((entry, offered))
}

/// Connects to the runtime. Returns the instance, its headset, and the names of both.
pub(super) fn create_instance(
    entry: &xr::Entry,
    extensions: &xr::ExtensionSet,
) -> Result<(xr::Instance, xr::SystemId, String)> {
    let instance =
        entry.create_instance(&application(), extensions, &[], &()).map_err(no_runtime)?;
    let system = instance
        .system(xr::FormFactor::HEAD_MOUNTED_DISPLAY)
        .map_err(|error| HeadsetError::NoHeadset(error.to_string()))?;
    let name = name_of(&instance, system)?;
    Ok((instance, system, name))
}

/// Returns the description of the program for the runtime.
fn application() -> xr::ApplicationInfo<'static> {
    xr::ApplicationInfo {
        application_name: "Virtual Sculpture",
        application_version: 1,
        engine_name: "",
        engine_version: 0,
        api_version: xr::Version::new(1, 0, 0),
    }
}

/// Returns the names of runtime and headset.
fn name_of(instance: &xr::Instance, system: xr::SystemId) -> Result<String> {
    let properties = instance.properties().doing("report the name of the runtime")?;
    let headset =
        instance.system_properties(system).doing("report the name of the headset")?.system_name;
    Ok(format!("{} ({headset})", properties.runtime_name))
}

/// Connects to the installed runtime, and keeps the connection while it has no headset.
#[derive(Default)]
pub struct Connector {
    kept: Option<RuntimeConnection>,
}

/// A connection to a runtime.
struct RuntimeConnection {
    instance: xr::Instance,
    offered: xr::ExtensionSet,
    converts_time: bool,
}

impl Connector {
    /// Connects to a headset. Without one, keeps the connection to the runtime for the next attempt.
    pub(super) fn connect(&mut self, blend: BlendMode) -> Result<HeadsetRuntime> {
        let connection = match self.kept.take() {
            Some(connection) => connection,
            None => RuntimeConnection::new()?,
        };
        match connection.instance.system(xr::FormFactor::HEAD_MOUNTED_DISPLAY) {
            Ok(system) => HeadsetRuntime::new(connection, system, blend),
            Err(error) => {
                use xr::sys::Result as R;
                let transient =
                    [R::ERROR_FORM_FACTOR_UNAVAILABLE, R::ERROR_FORM_FACTOR_UNSUPPORTED];
                if transient.contains(&error) {
                    self.kept = Some(connection);
                }
                Err(HeadsetError::NoHeadset(error.to_string()))
            }
        }
    }
}

impl RuntimeConnection {
    fn new() -> Result<RuntimeConnection> {
        let (entry, offered) = load_entry()?;
        if !offered.khr_vulkan_enable2 {
            return Err(HeadsetError::Unsuitable {
                runtime: "of this machine".to_string(),
                problem: "cannot share Vulkan images (XR_KHR_vulkan_enable2); update it"
                    .to_string(),
            });
        }
        let mut extensions = xr::ExtensionSet::default();
        extensions.khr_vulkan_enable2 = true;
        extensions.khr_composition_layer_depth = offered.khr_composition_layer_depth;
        extensions.ext_hand_interaction = offered.ext_hand_interaction;
        let converts_time = enable_time_conversion(&mut extensions, &offered);
        let instance =
            entry.create_instance(&application(), &extensions, &[], &()).map_err(no_runtime)?;
        Ok(RuntimeConnection { instance, offered, converts_time })
    }
}

/// A runtime with a headset.
pub(super) struct HeadsetRuntime {
    pub instance: xr::Instance,
    pub system: xr::SystemId,
    /// The names of runtime and headset, for messages.
    pub name: String,
    /// Recommended size per eye, in pixels.
    pub eye_size: UVec2,
    /// Largest size per eye, in pixels.
    pub eye_limit: UVec2,
    /// The available blend modes.
    pub modes: Vec<xr::EnvironmentBlendMode>,
    /// The chosen blend mode.
    pub blend: xr::EnvironmentBlendMode,
    /// Whether it accepts depth with the pictures (XR_KHR_composition_layer_depth).
    pub has_depth_layers: bool,
    /// Whether it offers bare hands as controllers (XR_EXT_hand_interaction).
    pub has_hand_interaction: bool,
    /// Whether its clock can be converted to the program's.
    pub converts_time: bool,
}

impl HeadsetRuntime {
    /// Returns the properties of the runtime and its headset.
    fn new(
        connection: RuntimeConnection,
        system: xr::SystemId,
        blend: BlendMode,
    ) -> Result<HeadsetRuntime> {
        let RuntimeConnection { instance, offered, converts_time } = connection;
        let name = name_of(&instance, system)?;
        let unsuitable =
            |problem: String| HeadsetError::Unsuitable { runtime: name.clone(), problem };

        let needs = instance
            .graphics_requirements::<xr::Vulkan>(system)
            .doing("report the Vulkan version it needs")?;
        if needs.min_api_version_supported > VULKAN
            || needs.max_api_version_supported.major() < VULKAN.major()
        {
            return Err(unsuitable(format!(
                "works with Vulkan {} to {}, this program with {VULKAN}",
                needs.min_api_version_supported, needs.max_api_version_supported
            )));
        }
        let views =
            instance.enumerate_view_configuration_views(system, VIEWS).doing("report its views")?;
        if views.len() != 2 {
            return Err(unsuitable(format!("shows {} views, not two", views.len())));
        }
        let largest = |size: &dyn Fn(&xr::ViewConfigurationView) -> [u32; 2]| {
            views.iter().map(|view| UVec2::from(size(view))).fold(UVec2::ONE, UVec2::max)
        };
        let eye_size = largest(&|view| {
            [view.recommended_image_rect_width, view.recommended_image_rect_height]
        });
        let eye_limit =
            largest(&|view| [view.max_image_rect_width, view.max_image_rect_height]).max(eye_size);
        let modes = instance
            .enumerate_environment_blend_modes(system, VIEWS)
            .doing("report its blend modes")?;
        let blend =
            blend.choose(&modes).ok_or_else(|| unsuitable("offers no blend mode".to_string()))?;
        Ok(HeadsetRuntime {
            has_depth_layers: offered.khr_composition_layer_depth,
            has_hand_interaction: offered.ext_hand_interaction,
            converts_time,
            instance,
            system,
            name,
            eye_size,
            eye_limit,
            modes,
            blend,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use xr::EnvironmentBlendMode as Mode;

    #[test]
    fn auto_prefers_modes_that_show_the_surroundings() {
        let all = [Mode::OPAQUE, Mode::ADDITIVE, Mode::ALPHA_BLEND];
        assert_eq!(BlendMode::Auto.choose(&all), Some(Mode::ALPHA_BLEND));
        assert_eq!(BlendMode::Auto.choose(&all[..2]), Some(Mode::ADDITIVE));
        assert_eq!(BlendMode::Auto.choose(&all[..1]), Some(Mode::OPAQUE));
        assert_eq!(BlendMode::Opaque.choose(&all), Some(Mode::OPAQUE));
        assert_eq!(BlendMode::Additive.choose(&all), Some(Mode::ADDITIVE));
        assert_eq!(
            BlendMode::Opaque.choose(&[Mode::ADDITIVE]),
            Some(Mode::ADDITIVE),
            "the closest one"
        );
        assert_eq!(BlendMode::Auto.choose(&[]), None);
        for mode in all {
            assert_eq!(BlendMode::of(mode).and_then(|blend| blend.choose(&all)), Some(mode));
        }
        assert_eq!(BlendMode::of(Mode::from_raw(77)), None, "a mode of a later version");
    }
}
