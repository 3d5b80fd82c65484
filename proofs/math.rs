//! What stands in for `sidestep::math` in proofs: any value that the contract allows.
//!
//! `libm` is beyond a bit-precise solver. The contracts are the predicates of
//! `sidestep_spec::math`, which `examples/math_exhaustive` checks for every input.

#[cfg(not(kani))]
use super::kani;
use sidestep_spec::math as contract;

/// Any sine: math.INV-1.
pub fn any_sin(_angle: f32) -> f32 {
    let result = kani::any();
    kani::assume(contract::sin(result));
    result
}

/// Any cosine: math.INV-2.
pub fn any_cos(angle: f32) -> f32 {
    let result = kani::any();
    kani::assume(contract::cos(angle, result));
    result
}

/// Any square root: math.INV-3.
pub fn any_sqrt(x: f32) -> f32 {
    let result = kani::any();
    kani::assume(contract::sqrt(x, result));
    result
}

/// Any direction: math.INV-4.
pub fn any_atan2(_y: f32, _x: f32) -> f32 {
    let result = kani::any();
    kani::assume(contract::atan2(result));
    result
}

/// Any natural logarithm: math.INV-5.
pub fn any_ln(x: f32) -> f32 {
    let result = kani::any();
    kani::assume(contract::ln(x, result));
    result
}
