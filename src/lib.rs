#![no_std]
//! sidestep
pub mod arcos;
