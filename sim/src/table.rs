//! What the readers of tables of numbers have in common.

use std::path::Path;

use crate::error::Error;

/// The text of the file at `path`.
pub(crate) fn load(path: &Path) -> Result<String, Error> {
    std::fs::read_to_string(path).map_err(|error| Error::Unreadable {
        path: path.to_owned(),
        reason: error.to_string(),
    })
}

/// Lines with their numbers, counted from 1, without the blank ones.
pub(crate) fn rows(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let numbered = text.lines().enumerate();
    numbered
        .map(|(i, line)| (i + 1, line.trim()))
        .filter(|(_, line)| !line.is_empty())
}

/// Exactly `N` finite numbers.
pub(crate) fn numbers<const N: usize>(
    fields: &[&str],
    path: &Path,
    line: usize,
) -> Result<[f64; N], Error> {
    if fields.len() != N {
        let reason = format!("expected {N} numbers, found {}", fields.len());
        return Err(malformed(path, line, reason));
    }
    let mut numbers = [0.0; N];
    for (number, field) in numbers.iter_mut().zip(fields) {
        *number = match field.trim().parse::<f64>() {
            Ok(parsed) if parsed.is_finite() => parsed,
            _ => {
                let reason = format!("expected a finite number, found {field:?}");
                return Err(malformed(path, line, reason));
            }
        };
    }
    Ok(numbers)
}

/// `value` as the whole number that `name` must be.
pub(crate) fn whole(name: &str, value: f64, path: &Path, line: usize) -> Result<u32, Error> {
    if value.fract() == 0.0 && (0.0..=f64::from(u32::MAX)).contains(&value) {
        Ok(value as u32)
    } else {
        let reason = format!("expected a whole number for {name}, found {value}");
        Err(malformed(path, line, reason))
    }
}

pub(crate) fn malformed(path: &Path, line: usize, reason: String) -> Error {
    Error::Malformed {
        path: path.to_owned(),
        line,
        reason,
    }
}
