//! Exit statuses.

use std::process::ExitCode;

/// How a command ended. Misuse of the command line ends with 2 before any command starts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum Exit {
    /// All checks hold; what was asked is done.
    Done = 0,
    /// A check fails, or what the command judges does not hold.
    CheckFailed = 1,
    /// Bad arguments or bad input.
    BadInput = 2,
    /// A run broke down: not a number, growth without a source, a solver that does not converge.
    BrokeDown = 3,
    /// Nothing was selected.
    NothingSelected = 4,
    /// A run was interrupted, stored, and can be taken up: what shells say of a program that Ctrl-C ended.
    Interrupted = 130,
}

impl From<Exit> for ExitCode {
    fn from(exit: Exit) -> Self {
        Self::from(exit as u8)
    }
}
