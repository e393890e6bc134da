//! The console of the program on Windows. Windows starts it without one, so no black window opens beside the program's
//! own, and output still reaches the console that started it. Does nothing elsewhere.

/// Attaches to the console of the parent process, if it has one. Redirected streams stay as they
/// are.
#[cfg(windows)]
pub fn attach() {
    use windows_sys::Win32::System::Console::{ATTACH_PARENT_PROCESS, AttachConsole};
    // SAFETY: the call takes no memory of ours. It is made first of all, before anyone asks for a
    // stream; where there is no console it fails and changes nothing.
    unsafe { AttachConsole(ATTACH_PARENT_PROCESS) };
}

/// Shows an error in a message box if standard error is connected to nothing, as after a start from the Explorer.
#[cfg(windows)]
pub fn show(text: &str) {
    use std::os::windows::io::AsRawHandle;

    use windows_sys::Win32::UI::WindowsAndMessaging::{MB_ICONERROR, MB_OK, MessageBoxW};
    if !std::io::stderr().as_raw_handle().is_null() {
        return;
    }
    let wide = |text: &str| text.encode_utf16().chain([0]).collect::<Vec<u16>>();
    let (text, title) = (wide(text), wide("Virtual Sculpture"));
    let style = MB_OK | MB_ICONERROR;
    // SAFETY: both texts end in a zero and live until the call returns; no window owns the box.
    unsafe { MessageBoxW(std::ptr::null_mut(), text.as_ptr(), title.as_ptr(), style) };
}

#[cfg(not(windows))]
pub fn attach() {}

#[cfg(not(windows))]
pub fn show(_text: &str) {}
