//! Checks the contracts of `sidestep::math` for every `f32` there is: 2³² inputs per function.
//!
//! Proofs replace each of these functions by its contract, so the proofs are as good as this run:
//!
//! ```sh
//! cargo run --release --example math_exhaustive
//! ```
//!
//! It takes some minutes and uses every core. The exit code is 1 if a contract is broken; the
//! inputs are then named. `atan2` has 2⁶⁴ inputs: `tests/math.rs` samples those.

use sidestep::math;
use sidestep_spec::math as contract;
use std::process::ExitCode;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// Inputs per piece of work: small enough that progress moves, large enough to cost nothing.
const PIECE: u64 = 1 << 22;
const ALL: u64 = 1 << 32;
/// So many broken inputs are named; the rest are only counted.
const NAMED: usize = 20;

/// A function of one variable with its contract.
struct Function {
    name: &'static str,
    invariant: &'static str,
    run: fn(f32) -> f32,
    /// The contract, of the input and the result.
    kept: fn(f32, f32) -> bool,
    /// How near the result comes to breaking the contract; greatest is worst. `None` where the
    /// contract asks nothing that could be near.
    nearness: fn(f32, f32) -> Option<f64>,
    nearness_is: &'static str,
}

const FUNCTIONS: [Function; 4] = [
    Function {
        name: "sin",
        invariant: "math.INV-1",
        run: math::sin,
        kept: |_, result| contract::sin(result),
        nearness: |_, result| Some(f64::from(result).abs()),
        nearness_is: "greatest |result| (at most 1)",
    },
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
    },
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
    },
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
    },
];

/// What a run over some inputs found.
#[derive(Default)]
struct Findings {
    inputs: u64,
    broken: u64,
    named: Vec<(f32, f32)>,
    /// The worst value and its input.
    worst: Option<(f64, f32)>,
}

impl Findings {
    fn over(function: &Function, bits: std::ops::Range<u64>) -> Self {
        let mut findings = Self::default();
        for bits in bits {
            let x = f32::from_bits(bits as u32);
            let result = (function.run)(x);
            findings.inputs += 1;
            if !(function.kept)(x, result) {
                findings.broken += 1;
                if findings.named.len() < NAMED {
                    findings.named.push((x, result));
                }
            }
            if let Some(value) = (function.nearness)(x, result)
                && findings.worst.is_none_or(|(worst, _)| value > worst)
            {
                findings.worst = Some((value, x));
            }
        }
        findings
    }

    fn join(mut self, other: Self) -> Self {
        self.inputs += other.inputs;
        self.broken += other.broken;
        self.named.extend(other.named);
        self.named.truncate(NAMED);
        self.worst = match (self.worst, other.worst) {
            (Some(mine), Some(theirs)) if theirs.0 > mine.0 => Some(theirs),
            (None, theirs) => theirs,
            (mine, _) => mine,
        };
        self
    }
}

/// Every input, on every core.
fn check(function: &Function) -> Findings {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let (next, done) = (AtomicU64::new(0), AtomicU64::new(0));
    let worker = || {
        let mut findings = Findings::default();
        loop {
            let from = next.fetch_add(PIECE, Ordering::Relaxed);
            if from >= ALL {
                return findings;
            }
            findings = findings.join(Findings::over(function, from..from + PIECE));
            done.fetch_add(PIECE, Ordering::Relaxed);
        }
    };
    std::thread::scope(|scope| {
        let workers: Vec<_> = (0..cores).map(|_| scope.spawn(worker)).collect();
        while workers.iter().any(|worker| !worker.is_finished()) {
            let percent = done.load(Ordering::Relaxed) * 100 / ALL;
            eprint!("\r{}: {percent:3} % ", function.name);
            std::thread::sleep(Duration::from_millis(200));
        }
        eprint!("\r");
        workers
            .into_iter()
            .map(|worker| worker.join().expect("a worker does not panic"))
            .fold(Findings::default(), Findings::join)
    })
}

fn main() -> ExitCode {
    let mut kept = true;
    for function in &FUNCTIONS {
        let begin = Instant::now();
        let found = check(function);
        let seconds = begin.elapsed().as_secs_f64();
        println!(
            "{} {}: {} inputs, {} break the contract, {seconds:.0} s",
            function.invariant, function.name, found.inputs, found.broken
        );
        if let Some((value, x)) = found.worst {
            println!(
                "    {}: {value:e} at {x:e} (bits {:#010x})",
                function.nearness_is,
                x.to_bits()
            );
        }
        for (x, result) in &found.named {
            println!(
                "    broken: {}({x:e}) = {result:e} (bits {:#010x})",
                function.name,
                x.to_bits()
            );
        }
        kept &= found.broken == 0 && found.inputs == ALL;
    }
    if kept {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    }
}
