//! The functions of one variable in `sidestep::math`, each with its contract, its reference in f64,
//! and how far it may be from that.
//!
//! A budget is in units in the last place (ULP) of the `f32` next to the exact value. The law book
//! has the reasons for each in `spec/math.md`.

use sidestep::math;
use sidestep_spec::math as contract;

/// A function of one variable.
#[derive(Clone, Copy)]
pub struct Function {
    /// As in `src/math.rs`.
    pub name: &'static str,
    /// The invariant that is its contract.
    pub invariant: &'static str,
    /// The function.
    pub run: fn(f32) -> f32,
    /// The contract, of the input and the result.
    pub kept: fn(f32, f32) -> bool,
    /// How near the result comes to breaking the contract; greatest is worst. `None` where the
    /// contract asks nothing that could be near.
    pub nearness: fn(f32, f32) -> Option<f64>,
    /// What that number is.
    pub nearness_is: &'static str,
    /// The value in f64; `None` outside of the function's domain.
    pub exact: fn(f64) -> Option<f64>,
    /// The greatest distance allowed between result and exact value, in ULP.
    pub budget: f64,
}

/// All of them.
pub const FUNCTIONS: [Function; 4] = [
    //= math.INV-1 (every input)
    Function {
        name: "sin",
        invariant: "math.INV-1",
        run: math::sin,
        kept: |_, result| contract::sin(result),
        nearness: |_, result| Some(f64::from(result).abs()),
        nearness_is: "greatest |result| (at most 1)",
        exact: |angle| angle.is_finite().then(|| angle.sin()),
        budget: 0.51,
    },
    //= math.INV-2 (every input)
    Function {
        name: "cos",
        invariant: "math.INV-2",
        run: math::cos,
        kept: contract::cos,
        // Beyond 60° only the range counts; up to there the least cosine does.
        nearness: |angle, result| {
            let within = angle.abs() <= std::f32::consts::FRAC_PI_3;
            within.then_some(0.5 - f64::from(result))
        },
        nearness_is: "greatest ½ − result within 60° (at most 1e-6)",
        exact: |angle| angle.is_finite().then(|| angle.cos()),
        budget: 0.51,
    },
    //= math.INV-3 (every input)
    Function {
        name: "sqrt",
        invariant: "math.INV-3",
        run: math::sqrt,
        kept: contract::sqrt,
        nearness: |x, result| {
            let positive = x > 0.0 && x.is_finite();
            positive.then(|| f64::from(result) - f64::from(x.max(1.0)))
        },
        nearness_is: "greatest result − max(1, x) (at most 0)",
        exact: |x| (x >= 0.0 && x.is_finite()).then(|| x.sqrt()),
        budget: 0.5,
    },
    //= math.INV-5 (every input)
    Function {
        name: "ln",
        invariant: "math.INV-5",
        run: math::ln,
        kept: contract::ln,
        nearness: |x, result| {
            let within = x >= 1.0 && x.is_finite();
            within.then(|| f64::from(result) - f64::from(x - 1.0))
        },
        nearness_is: "greatest result − (x − 1) (at most 0)",
        exact: |x| (x >= 1.0 && x.is_finite()).then(|| x.ln()),
        budget: 1.0,
    },
];

impl Function {
    /// The distance of a result from the exact value in ULP; `None` outside of the domain.
    pub fn error(&self, x: f32, result: f32) -> Option<f64> {
        let exact = (self.exact)(f64::from(x))?;
        let near = (exact as f32).abs();
        let unit = f64::from(near.next_up()) - f64::from(near);
        Some((f64::from(result) - exact).abs() / unit)
    }
}
