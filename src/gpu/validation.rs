//! The messages of the validation layers: every warning and error is kept and counted, so that a
//! test can assert that there was none.

use std::ffi::{CStr, c_void};
use std::sync::{Mutex, PoisonError};

use ash::vk;

/// The name of the validation layer.
pub const LAYER: &CStr = c"VK_LAYER_KHRONOS_validation";

/// Number of messages kept; further ones are only counted.
const KEPT: usize = 64;

/// Warnings and errors since the instance was made.
#[derive(Debug, Default)]
pub struct ValidationLog {
    inner: Mutex<Messages>,
}

#[derive(Debug, Default)]
struct Messages {
    kept: Vec<String>,
    count: usize,
}

impl ValidationLog {
    /// Returns the number of warnings and errors.
    pub fn count(&self) -> usize {
        self.inner.lock().unwrap_or_else(PoisonError::into_inner).count
    }

    /// Returns the messages kept, oldest first.
    pub fn messages(&self) -> Vec<String> {
        self.inner.lock().unwrap_or_else(PoisonError::into_inner).kept.clone()
    }

    fn push(&self, message: String) {
        let mut inner = self.inner.lock().unwrap_or_else(PoisonError::into_inner);
        inner.count += 1;
        if inner.kept.len() < KEPT {
            inner.kept.push(message);
        }
    }
}

/// Returns the messenger that writes to `log`, which must live as long as the messenger.
pub(super) fn messenger_info(log: &ValidationLog) -> vk::DebugUtilsMessengerCreateInfoEXT<'_> {
    vk::DebugUtilsMessengerCreateInfoEXT::default()
        .message_severity(
            vk::DebugUtilsMessageSeverityFlagsEXT::WARNING
                | vk::DebugUtilsMessageSeverityFlagsEXT::ERROR,
        )
        .message_type(
            vk::DebugUtilsMessageTypeFlagsEXT::VALIDATION
                | vk::DebugUtilsMessageTypeFlagsEXT::PERFORMANCE
                | vk::DebugUtilsMessageTypeFlagsEXT::GENERAL,
        )
        .pfn_user_callback(Some(on_message))
        .user_data(std::ptr::from_ref(log).cast_mut().cast())
}

unsafe extern "system" fn on_message(
    severity: vk::DebugUtilsMessageSeverityFlagsEXT,
    kind: vk::DebugUtilsMessageTypeFlagsEXT,
    data: *const vk::DebugUtilsMessengerCallbackDataEXT<'_>,
    user: *mut c_void,
) -> vk::Bool32 {
    // SAFETY: Vulkan hands a valid structure whose message is a NUL-terminated string, or null.
    let text = unsafe {
        match data.as_ref().filter(|d| !d.p_message.is_null()) {
            Some(data) => CStr::from_ptr(data.p_message).to_string_lossy().into_owned(),
            None => String::new(),
        }
    };
    // Messages of the loader about other layers and drivers are not about our calls.
    if kind == vk::DebugUtilsMessageTypeFlagsEXT::GENERAL {
        tracing::debug!("Vulkan: {text}");
        return vk::FALSE;
    }
    if severity.contains(vk::DebugUtilsMessageSeverityFlagsEXT::ERROR) {
        tracing::error!("validation: {text}");
    } else {
        tracing::warn!("validation: {text}");
    }
    // SAFETY: `user` is the log given to `messenger_info`, which outlives the messenger.
    if let Some(log) = unsafe { user.cast::<ValidationLog>().as_ref() } {
        log.push(text);
    }
    vk::FALSE
}
