//! The root of the tests in a window. They are of Linux alone; elsewhere there are none.

#[cfg(target_os = "linux")]
#[path = "main.rs"]
mod tests;

fn main() {
    #[cfg(target_os = "linux")]
    tests::main();
}
