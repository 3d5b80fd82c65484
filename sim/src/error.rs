//! What is wrong with a world, a robot or a data file that was asked for.

use std::fmt;
use std::path::PathBuf;

/// Why a simulation could not be built.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Error {
    /// A parameter lies outside its domain.
    OutOfRange {
        /// Name of the parameter.
        field: &'static str,
        /// The value given.
        value: f64,
        /// The values allowed, with their unit.
        allowed: &'static str,
    },
    /// No scenario has this name.
    UnknownScenario {
        /// The name given.
        name: String,
        /// The names there are.
        known: &'static [&'static str],
    },
    /// A data file could not be read.
    Unreadable {
        /// The file.
        path: PathBuf,
        /// The operating system's reason.
        reason: String,
    },
    /// A line of a data file is not what the format promises.
    Malformed {
        /// The file.
        path: PathBuf,
        /// Line number, counted from 1.
        line: usize,
        /// What was expected and what was found.
        reason: String,
    },
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::OutOfRange {
                field,
                value,
                allowed,
            } => write!(f, "{field} = {value} is out of range: allowed {allowed}"),
            Self::UnknownScenario { name, known } => {
                write!(
                    f,
                    "no scenario is called {name:?}: known are {}",
                    known.join(", ")
                )
            }
            Self::Unreadable { path, reason } => write!(f, "{}: {reason}", path.display()),
            Self::Malformed { path, line, reason } => {
                write!(f, "{}:{line}: {reason}", path.display())
            }
        }
    }
}

impl std::error::Error for Error {}

/// `value` if `valid` holds for it and it is finite, else the error that names it.
pub(crate) fn require(
    field: &'static str,
    value: f64,
    allowed: &'static str,
    valid: impl Fn(f64) -> bool,
) -> Result<f64, Error> {
    if value.is_finite() && valid(value) {
        Ok(value)
    } else {
        Err(Error::OutOfRange {
            field,
            value,
            allowed,
        })
    }
}
