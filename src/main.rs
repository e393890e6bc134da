//! The program: arguments to one of its jobs. See `cli`.

fn main() -> std::process::ExitCode {
    virtual_sculpture::cli::main()
}
