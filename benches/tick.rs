//! What a control tick costs: the view, the law and the shield, one after the other, for a P3-DX
//! with sixteen sonars among echoes at all ranges.
//!
//! `cargo bench --bench tick` prints times; `cargo bench --bench tick -- 20000` runs that many ticks
//! of the shield alone and nothing else, for `valgrind --tool=callgrind` and the like: instructions
//! per tick are the difference between two such runs, divided by the difference in ticks.

use nalgebra::Vector2;
use sidestep::avoid::Avoid;
use sidestep::config::Config;
use sidestep::law::{Advice, Law};
use sidestep::observation::{BaseStatus, Observation, OdometrySample, SonarSample};
use sidestep::preset;
use sidestep::quantity::Instant;
use sidestep::ring::{Placement, Ring};
use sidestep::shield::Shield;
use sidestep::view::{Memory, View};
use std::hint::black_box;

/// Faces and directions of sixteen sonars round a robot, in mm and degrees.
fn ring(config: &Config) -> Ring<16> {
    let mut placements = [Placement::from_mm_deg(0, 0, 0); 16];
    for (i, placement) in placements.iter_mut().enumerate() {
        let heading = 11.25 + 22.5 * i as f32;
        let heading = if heading > 180.0 {
            heading - 360.0
        } else {
            heading
        }
        .to_radians();
        *placement = Placement {
            x: 0.16 * heading.cos(),
            y: 0.16 * heading.sin(),
            heading,
        };
    }
    Ring::new(&placements, config).expect("the ring fits the preset")
}

/// A robot on its way, with a moving echo in every cone.
fn observation(tick: u64) -> Observation<16> {
    let now = Instant(1_000 + 100 * tick);
    let mut sonar = [None; 16];
    for (i, sample) in sonar.iter_mut().enumerate() {
        let phase = (tick * 7 + i as u64 * 131) % 400;
        *sample = Some(SonarSample {
            range: 0.7 + phase as f32 / 200.0,
            taken_at: now,
        });
    }
    Observation {
        now,
        sonar,
        odometry: Some(OdometrySample {
            x: 0.02 * (tick % 1000) as f32,
            y: 0.0,
            heading: 0.0,
            speed: 0.2,
            turn_rate: 0.0,
            taken_at: now,
        }),
        sighting: None,
        base: BaseStatus {
            motors_enabled: true,
            stalled: false,
            emergency_stop: false,
        },
    }
}

/// Mean time of a call in ns, the best of five rounds.
fn nanoseconds(views: usize, mut call: impl FnMut(usize)) -> f64 {
    const ROUNDS: usize = 200;
    let mut best = f64::INFINITY;
    for _ in 0..5 {
        let begun = std::time::Instant::now();
        for _ in 0..ROUNDS {
            (0..views).for_each(&mut call);
        }
        let each = begun.elapsed().as_secs_f64() * 1e9 / (ROUNDS * views) as f64;
        best = best.min(each);
    }
    best
}

fn main() {
    let config = Config::new(preset::PIONEER_3DX).expect("the preset is valid");
    let ring = ring(&config);
    let goal = Vector2::new(50.0, 0.0);
    let mut memory = Memory::default();
    let observations: Vec<_> = (0..500).map(observation).collect();
    let views: Vec<View<16>> = observations
        .iter()
        .map(|observation| {
            memory
                .update(observation, goal, &ring, &config)
                .expect("there is odometry")
        })
        .collect();
    let advice = Advice {
        speed: 0.3,
        turn_rate: 0.4,
    };
    let mut shield = Shield::new(&config);
    let mut judge = |i: usize| {
        let view = black_box(&views[i]);
        black_box(shield.assess(view, &ring));
        black_box(shield.admit(advice, view, &ring));
    };
    // Cargo passes --bench along.
    if let Some(ticks) = std::env::args().find_map(|word| word.parse::<usize>().ok()) {
        (0..ticks).for_each(|tick| judge(tick % views.len()));
        return;
    }
    let of_shield = nanoseconds(views.len(), &mut judge);
    let mut memory = Memory::default();
    let of_view = nanoseconds(observations.len(), |i| {
        let _ = black_box(memory.update(black_box(&observations[i]), goal, &ring, &config));
    });
    let mut law = Avoid::new(config);
    let of_law = nanoseconds(views.len(), |i| {
        black_box(law.advise(black_box(&views[i])));
    });
    println!("view   {of_view:8.0} ns per tick\nlaw    {of_law:8.0} ns\nshield {of_shield:8.0} ns");
}
