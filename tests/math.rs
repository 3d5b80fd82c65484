//! Chapter `math`: contracts and budgets on a grid of bit patterns over all of `f32`.
//!
//! Every 4097th bit pattern meets every exponent and both signs, and ends the runs of equal low
//! bits that a power of two would give. `examples/math_exhaustive` leaves none out.

mod common;
#[path = "../examples/math_exhaustive/functions.rs"]
#[allow(dead_code, reason = "the example says more of each")]
mod functions;

use proptest::prelude::*;
use sidestep::math;
use sidestep_spec::math as contract;

/// Values where something changes, with their neighbours.
fn corners() -> impl Iterator<Item = f32> {
    use std::f32::consts::{FRAC_PI_2, FRAC_PI_3, PI, TAU};
    let special = [
        0.0,
        f32::MIN_POSITIVE,
        1.0,
        FRAC_PI_3,
        FRAC_PI_2,
        PI,
        TAU,
        3.0 * PI,
        f32::MAX,
        f32::INFINITY,
        f32::NAN,
    ];
    special.into_iter().flat_map(|value| {
        let bits = value.to_bits();
        [bits.wrapping_sub(1), bits, bits + 1]
            .into_iter()
            .flat_map(|bits| [f32::from_bits(bits), -f32::from_bits(bits)])
    })
}

/// The grid and the corners.
fn inputs() -> impl Iterator<Item = f32> {
    (0..=u32::MAX)
        .step_by(4097)
        .map(f32::from_bits)
        .chain(corners())
}

/// The sample of what `examples/math_exhaustive` does.
#[test]
fn functions_keep_contract_and_budget() {
    for function in &functions::FUNCTIONS {
        for x in inputs() {
            let result = (function.run)(x);
            let name = function.name;
            assert!((function.kept)(x, result), "{name}({x:e}) = {result:e}");
            if let Some(error) = function.error(x, result) {
                assert!(
                    error <= function.budget,
                    "{name}({x:e}) = {result:e} is off by {error} ULP"
                );
            }
        }
    }
}

/// None is left out of the exhaustive check.
#[test]
fn functions_are_all_there() {
    let source = include_str!("../src/math.rs");
    let unary: Vec<&str> = source
        .lines()
        .filter(|line| line.ends_with(": f32) -> f32 {") && line.matches(": f32").count() == 1)
        .filter_map(|line| line.strip_prefix("pub fn ")?.split('(').next())
        .collect();
    let checked: Vec<&str> = functions::FUNCTIONS
        .iter()
        .map(|function| function.name)
        .collect();
    assert_eq!(unary, checked);
}

//= math.INV-5
#[test]
fn logarithm_keeps_its_contract() {
    for x in inputs() {
        let result = math::ln(x);
        assert!(contract::ln(x, result), "ln({x:e}) = {result:e}");
    }
}

/// A coarser grid in each coordinate, a prime apart, and every pair of corners.
//= math.INV-4
#[test]
fn direction_keeps_its_contract() {
    let grid = || (0..=u32::MAX).step_by(4_194_301).map(f32::from_bits);
    let pairs = grid()
        .flat_map(|y| grid().map(move |x| (y, x)))
        .chain(corners().flat_map(|y| corners().map(move |x| (y, x))));
    for (y, x) in pairs {
        let result = math::atan2(y, x);
        assert!(contract::atan2(result), "atan2({y:e}, {x:e}) = {result:e}");
    }
}

proptest! {
    #![proptest_config(common::cases(4_096))]

    //= math.INV-1
    //= math.INV-2
    //= math.INV-3
    //= math.INV-4
    #[test]
    fn contracts_hold_for_any_bits(a in any::<u32>(), b in any::<u32>()) {
        let (x, y) = (f32::from_bits(a), f32::from_bits(b));
        prop_assert!(contract::sin(math::sin(x)));
        prop_assert!(contract::cos(x, math::cos(x)));
        prop_assert!(contract::sqrt(x, math::sqrt(x)));
        prop_assert!(contract::atan2(math::atan2(y, x)));
    }

    /// Inside the contracts the functions are also right: within two units in the last place of
    /// what f64 gives. The laws' own tests lean on that, nothing of the shield does.
    #[test]
    fn results_are_accurate(angle in -10.0_f32..10.0, x in -1e4_f32..1e4, y in -1e4_f32..1e4) {
        let near = |found: f32, exact: f64| {
            let unit = (f64::from(exact as f32).abs() * f64::from(f32::EPSILON)).max(1e-12);
            (f64::from(found) - exact).abs() <= 2.0 * unit
        };
        prop_assert!(near(math::sin(angle), f64::from(angle).sin()));
        prop_assert!(near(math::cos(angle), f64::from(angle).cos()));
        prop_assert!(near(math::sqrt(x.abs()), f64::from(x.abs()).sqrt()));
        prop_assert!(near(math::atan2(y, x), f64::from(y).atan2(f64::from(x))));
        let length = math::norm(nalgebra::Vector2::new(x, y));
        prop_assert!(near(length, f64::from(x).hypot(f64::from(y))));
    }
}
