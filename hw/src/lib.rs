//! Hardware binding.
