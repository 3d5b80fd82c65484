//! Checks the functions of `sidestep::math` for every `f32` there is: 2³² inputs per function, each
//! against its contract and against f64.
//!
//! Proofs replace each of these functions by its contract, so the proofs are as good as this run:
//!
//! ```sh
//! cargo run --release --example math_exhaustive          # all
//! cargo run --release --example math_exhaustive -- sqrt  # those named
//! ```
//!
//! It takes some minutes and uses every core. The exit code is 1 if a contract is broken or an error
//! is beyond its budget; the inputs are then named. `atan2` has 2⁶⁴ inputs: `tests/math.rs` samples those.

mod functions;

use functions::{FUNCTIONS, Function};
use std::process::ExitCode;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// Inputs per piece of work: small enough that progress moves, large enough to cost nothing.
const PIECE: u64 = 1 << 22;
const ALL: u64 = 1 << 32;
/// So many broken inputs are named; the rest are only counted.
const NAMED: usize = 20;

/// The greatest of some values, with its input.
type Worst = Option<(f64, f32)>;

/// The greater of two.
fn worse(one: Worst, other: Worst) -> Worst {
    match (one, other) {
        (Some(one), Some(other)) if other.0 > one.0 => Some(other),
        (one, other) => one.or(other),
    }
}

/// What a run over some inputs found.
#[derive(Default)]
struct Findings {
    inputs: u64,
    broken: u64,
    named: Vec<(f32, f32)>,
    /// What came nearest to breaking the contract, and its input.
    nearest: Worst,
    /// The greatest error in ULP, and its input.
    error: Worst,
}

impl Findings {
    fn over(function: &Function, bits: std::ops::Range<u64>) -> Self {
        let mut findings = Self::default();
        for bits in bits {
            let x = f32::from_bits(bits as u32);
            let result = (function.run)(x);
            findings.inputs += 1;
            let error = function.error(x, result);
            // An error that is no number is not within the budget either.
            let within = error.is_none_or(|error| error <= function.budget);
            if !((function.kept)(x, result) && within) {
                findings.broken += 1;
                if findings.named.len() < NAMED {
                    findings.named.push((x, result));
                }
            }
            let nearness = (function.nearness)(x, result).map(|value| (value, x));
            findings.nearest = worse(findings.nearest, nearness);
            findings.error = worse(findings.error, error.map(|error| (error, x)));
        }
        findings
    }

    fn join(mut self, other: Self) -> Self {
        self.inputs += other.inputs;
        self.broken += other.broken;
        self.named.extend(other.named);
        self.named.truncate(NAMED);
        self.nearest = worse(self.nearest, other.nearest);
        self.error = worse(self.error, other.error);
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
    let named: Vec<String> = std::env::args().skip(1).collect();
    let mut kept = true;
    for function in &FUNCTIONS {
        if !(named.is_empty() || named.iter().any(|name| name == function.name)) {
            continue;
        }
        let begin = Instant::now();
        let found = check(function);
        let seconds = begin.elapsed().as_secs_f64();
        println!(
            "{} {}: {} inputs, {} break the contract or the budget, {seconds:.0} s",
            function.invariant, function.name, found.inputs, found.broken
        );
        let budget = format!("greatest error in ULP (at most {})", function.budget);
        for (what, worst) in [
            (function.nearness_is, found.nearest),
            (budget.as_str(), found.error),
        ] {
            if let Some((value, x)) = worst {
                println!(
                    "    {what}: {value:e} at {x:e} (bits {:#010x})",
                    x.to_bits()
                );
            }
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
