//! Bytes as a robot's whole life: a configuration, a ring of sonars, a law, and then observation
//! after observation, of which anything may be anything.
//!
//! By itself the world of such a life is in order: ticks come every 100 ms with fresh samples of
//! free space. Each byte says what goes differently in the next tick, so that bytes of zero drive
//! and a mutation of one byte changes one thing.

use super::bytes::Bytes;
use super::settings::{self, Shares};
use super::watch::{Told, Watched};
use sidestep::avoid::Avoid;
use sidestep::config::{Config, FIELDS, Parameters};
use sidestep::escape::Escape;
use sidestep::failsafe::StopReason;
use sidestep::law::{Advice, Law};
use sidestep::observation::{BaseStatus, Observation, OdometrySample, Sighting, SonarSample};
use sidestep::preset;
use sidestep::quantity::Instant;
use sidestep::ring::Ring;
use sidestep_spec::avoid as avoidance;
use std::f32::consts::{PI, TAU};

/// Longer lives teach nothing new and cost time.
const TICKS: usize = 256;

/// One life. See the module.
///
/// # Panics
/// If a predicate of the law book is broken.
pub fn run(data: &[u8]) {
    let mut bytes = Bytes::new(data);
    let kind = bytes.u8();
    match kind & 3 {
        0 => with_law::<3>(kind, &mut bytes),
        1 => with_law::<8>(kind, &mut bytes),
        2 => with_law::<16>(kind, &mut bytes),
        _ => with_law::<1>(kind, &mut bytes),
    }
}

fn with_law<const N: usize>(kind: u8, bytes: &mut Bytes) {
    let config = any_config((kind >> 3) & 3, bytes);
    let (config, ring) = settings::fitted::<N>(&config);
    let told = kind & 4 == 0;
    let escapes = kind & 0x40 != 0;
    let follows = kind & 0x20 == 0;
    if told {
        let law = Told::new(Advice {
            speed: 0.3,
            turn_rate: 0.0,
        });
        let tell = |law: &Told, bytes: &mut Bytes| {
            law.advice.set(Advice {
                speed: bytes.number(),
                turn_rate: bytes.number(),
            });
        };
        live::<_, N>(config, ring, law, tell, |_| {}, follows, bytes);
    } else if escapes {
        let law = Escape::new(Avoid::new(config), config, ring);
        live::<_, N>(config, ring, law, |_, _| {}, |_| {}, follows, bytes);
    } else {
        let within = |advice: Advice| {
            assert!(avoidance::advice_in_range(
                advice.speed,
                advice.turn_rate,
                config.speed_max,
                config.turn_rate_max
            ));
        };
        live::<_, N>(
            config,
            ring,
            Avoid::new(config),
            |_, _| {},
            within,
            follows,
            bytes,
        );
    }
}

/// A preset, or a configuration from shares, or any bit pattern in one field of a preset: refused
/// by name, or good.
fn any_config(choice: u8, bytes: &mut Bytes) -> Config {
    let preset = Config::new(preset::PIONEER_3DX).expect("the preset is good");
    match choice {
        0 => preset,
        1 => Config::new(preset::SRIKANDI_II_2011).expect("the preset is good"),
        2 => {
            let shares: Shares = std::array::from_fn(|_| bytes.share());
            settings::config(&shares)
        }
        _ => {
            let mut values = preset::PIONEER_3DX.values();
            values[usize::from(bytes.u8()) % FIELDS.len()] = bytes.number();
            match Config::new(Parameters::from_values(values)) {
                Ok(config) => config,
                Err(refused) => {
                    assert!(FIELDS.iter().any(|field| field.name == refused.field));
                    assert!(refused.to_string().contains(refused.field));
                    preset
                }
            }
        }
    }
}

fn live<L: Law<N> + Clone, const N: usize>(
    config: Config,
    ring: Ring<N>,
    law: L,
    tell: impl Fn(&L, &mut Bytes),
    judge: impl Fn(Advice),
    follows: bool,
    bytes: &mut Bytes,
) {
    let mut watched = Watched::new(config, ring, law, [6.0, 0.0]);
    let mut world = in_order::<N>();
    for _ in 0..TICKS {
        if bytes.is_empty() {
            break;
        }
        let what = bytes.u8();
        let now = next_time(world.now, what, bytes);
        let elapsed = now.since(world.now).unwrap_or(0);
        world.now = now;
        if what & 0x80 == 0 {
            refresh(&mut world);
        }
        if what & 0x04 != 0 {
            let sample = &mut world.sonar[usize::from(bytes.u8()) % N];
            *sample = Some(SonarSample {
                range: bytes.number(),
                taken_at: sample.map_or(now, |sample| sample.taken_at),
            });
        }
        if what & 0x08 != 0 {
            change_odometry(&mut world, bytes);
        }
        if what & 0x10 != 0 {
            tell(watched.controller.law(), bytes);
        }
        if what & 0x20 != 0 {
            lose_something(&mut world, bytes);
        }
        if what & 0x40 != 0 {
            match bytes.u8() % 4 {
                0 => watched.halt(StopReason::LinkLost, now),
                1 => world.sighting = Some(any_sighting(now, bytes)),
                2 => watched.reset(),
                _ => watched.halt(StopReason::Operator, now),
            }
        }
        let (_, advice) = watched.tick(&world);
        if let Some(advice) = advice {
            judge(advice);
        }
        if follows {
            obey(
                &mut world,
                watched.last().speed(),
                watched.last().turn_rate(),
                elapsed,
            );
        }
        restore(&mut world);
    }
}

/// Free space, a robot at rest at the origin, nothing wrong.
fn in_order<const N: usize>() -> Observation<N> {
    let now = Instant(10_000);
    Observation {
        now,
        sonar: [Some(SonarSample {
            range: 5.0,
            taken_at: now,
        }); N],
        odometry: Some(OdometrySample {
            x: 0.0,
            y: 0.0,
            heading: 0.0,
            speed: 0.0,
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

fn next_time(now: Instant, what: u8, bytes: &mut Bytes) -> Instant {
    Instant(match what & 3 {
        0 | 1 => now.0.saturating_add(100),
        2 => now.0.saturating_add(u64::from(bytes.u8()) * 8),
        _ => match bytes.u8() {
            // Back, far on, or anywhere.
            0..=0x7F => now.0.saturating_sub(u64::from(bytes.u16())),
            0x80..=0xBF => now.0.saturating_add(u64::from(bytes.u32())),
            0xC0..=0xFF => bytes.u64(),
        },
    })
}

/// Everything that is there was measured just now.
fn refresh<const N: usize>(world: &mut Observation<N>) {
    let now = world.now;
    for sample in world.sonar.iter_mut().flatten() {
        sample.taken_at = now;
    }
    if let Some(odometry) = &mut world.odometry {
        odometry.taken_at = now;
    }
}

fn change_odometry<const N: usize>(world: &mut Observation<N>, bytes: &mut Bytes) {
    let field = bytes.u8() % 6;
    let value = bytes.number();
    if let Some(odometry) = &mut world.odometry {
        match field {
            0 => odometry.x = value,
            1 => odometry.y = value,
            2 => odometry.heading = value,
            3 => odometry.speed = value,
            4 => odometry.turn_rate = value,
            _ => odometry.taken_at = Instant(bytes.u64()),
        }
    }
}

/// Takes something away for this tick, or leaves something on.
fn lose_something<const N: usize>(world: &mut Observation<N>, bytes: &mut Bytes) {
    let sonar = usize::from(bytes.u8()) % N;
    match bytes.u8() % 8 {
        0 => world.sonar[sonar] = None,
        1 => world.odometry = None,
        2 => world.sighting = None,
        3 => world.base.motors_enabled = !world.base.motors_enabled,
        4 => world.base.stalled = !world.base.stalled,
        5 => world.base.emergency_stop = !world.base.emergency_stop,
        _ => {
            // An old sample, or one from the future, but not by much.
            let taken_at = world.now.0.saturating_add(200);
            let taken_at = Instant(taken_at.saturating_sub(u64::from(bytes.u8()) * 4));
            if let Some(sample) = &mut world.sonar[sonar] {
                sample.taken_at = taken_at;
            }
        }
    }
}

/// What was taken away is there again, and what was no number is one: else one mutation would end
/// every life.
fn restore<const N: usize>(world: &mut Observation<N>) {
    let fresh = in_order::<N>();
    for (sample, good) in world.sonar.iter_mut().zip(fresh.sonar) {
        *sample = sample.filter(|sample| sample.range > 0.0).or(good);
    }
    world.odometry = world
        .odometry
        .filter(|odometry| (odometry.x + odometry.y + odometry.heading).is_finite())
        .or(fresh.odometry);
}

fn any_sighting(now: Instant, bytes: &mut Bytes) -> Sighting {
    Sighting {
        displacement: bytes.number(),
        scale: bytes.number(),
        interval: bytes.number(),
        direction: bytes.number(),
        taken_at: Instant(now.0.saturating_sub(u64::from(bytes.u8()) * 16)),
    }
}

/// A base that does at once what it is told.
fn obey<const N: usize>(world: &mut Observation<N>, speed: i32, turn_rate: i32, elapsed: u64) {
    let Some(odometry) = &mut world.odometry else {
        return;
    };
    let seconds = elapsed.min(1_000) as f32 / 1000.0;
    odometry.speed = speed as f32 / 1000.0;
    odometry.turn_rate = turn_rate as f32 / 1000.0;
    odometry.heading += odometry.turn_rate * seconds;
    if odometry.heading > PI {
        odometry.heading -= TAU;
    } else if odometry.heading < -PI {
        odometry.heading += TAU;
    }
    odometry.x += odometry.speed * seconds * odometry.heading.cos();
    odometry.y += odometry.speed * seconds * odometry.heading.sin();
    // What stands still comes nearer to who drives.
    for sample in world.sonar.iter_mut().flatten() {
        if sample.range < 5.0 {
            sample.range -= odometry.speed * seconds;
        }
    }
}
