//! The program: arguments to one of its jobs. See `cli`.

// Windows opens no console beside the window: see `screen::console`.
#![cfg_attr(windows, windows_subsystem = "windows")]

fn main() -> std::process::ExitCode {
    virtual_sculpture::cli::main()
}
