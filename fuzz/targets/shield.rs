//! Bytes as what the guard is asked: any hazards, any motion, any advice, one question after the
//! other, for a preset or any configuration.

use super::bytes::Bytes;
use super::reference::{has_room, left_for_turn};
use super::settings::{self, Shares};
use sidestep::config::Config;
use sidestep::preset;
use sidestep::ring::Ring;
use sidestep::shield::{Admission, Guard, Limit, Motion, Surroundings, Twist};
use sidestep::view::{Class, Hazard};
use sidestep_spec::shield as promise;

/// Questions that the guard is asked at most.
const QUESTIONS: usize = 32;

/// Asks. See the module.
///
/// # Panics
/// If a predicate of the law book is broken.
pub fn run(data: &[u8]) {
    let mut bytes = Bytes::new(data);
    let kind = bytes.u8();
    let config = match (kind >> 2) & 3 {
        0 => Config::new(preset::PIONEER_3DX).expect("the preset is good"),
        1 => Config::new(preset::SRIKANDI_II_2012).expect("the preset is good"),
        _ => {
            let shares: Shares = std::array::from_fn(|_| bytes.share());
            settings::config(&shares)
        }
    };
    match kind & 3 {
        0 => ask::<16>(&config, &mut bytes),
        1 => ask::<3>(&config, &mut bytes),
        _ => ask::<1>(&config, &mut bytes),
    }
}

/// A number from 0 on: mostly one that is met with, now and then any.
fn size(bytes: &mut Bytes, usual: i32) -> i32 {
    match bytes.u8() {
        0..=0x7F => i32::from(bytes.u16()) % usual.max(1),
        0x80..=0xBF => i32::from(bytes.u8()),
        0xC0..=0xEF => i32::from(bytes.u16()),
        0xF0..=0xFF => (bytes.u32() >> 1) as i32,
    }
}

/// A size with a sign.
fn signed(bytes: &mut Bytes, usual: i32) -> i32 {
    let size = size(bytes, usual);
    if bytes.truth() { -size } else { size }
}

fn any_hazard(bytes: &mut Bytes) -> Hazard {
    Hazard {
        range: size(bytes, 5_000),
        clearance: signed(bytes, 5_000),
        age: size(bytes, 500),
        way: [size(bytes, 200), size(bytes, 200)],
        turned: size(bytes, 500),
        class: if bytes.truth() {
            Class::Still
        } else {
            Class::Unknown
        },
        too_fast: bytes.truth(),
        stuck: bytes.truth(),
    }
}

/// A hazard that is as bad in every respect, and worse in some.
fn worse(hazard: &Hazard, bytes: &mut Bytes) -> Hazard {
    let mut worse = *hazard;
    let what = bytes.u8();
    let mut more = |bit: u8| {
        if what & bit == 0 { 0 } else { size(bytes, 100) }
    };
    worse.clearance = worse.clearance.saturating_sub(more(1));
    worse.age = worse.age.saturating_add(more(2));
    worse.way[0] = worse.way[0].saturating_add(more(4));
    worse.way[1] = worse.way[1].saturating_add(more(8));
    worse.turned = worse.turned.saturating_add(more(16));
    if what & 32 != 0 {
        worse.class = Class::Unknown;
    }
    worse
}

fn ask<const N: usize>(config: &Config, bytes: &mut Bytes) {
    let (config, ring) = settings::fitted::<N>(config);
    let guard = Guard::new(&config);
    for _ in 0..QUESTIONS {
        if bytes.is_empty() {
            break;
        }
        question(&guard, &ring, bytes);
    }
}

fn question<const N: usize>(guard: &Guard, ring: &Ring<N>, bytes: &mut Bytes) {
    let limits = guard.limits();
    // As many hazards as there are bytes for; the others are far away.
    let far = Hazard {
        range: 20_000,
        clearance: 20_000,
        age: 0,
        way: [0; 2],
        turned: 0,
        class: Class::Unknown,
        too_fast: false,
        stuck: false,
    };
    let mut hazard = [far; N];
    for _ in 0..bytes.u8() % 4 {
        hazard[usize::from(bytes.u8()) % N] = any_hazard(bytes);
    }
    let motion = Motion {
        speed: size(bytes, limits.speed_max() + limits.speed_gain()),
        backward: bytes.truth(),
        turn_rate: size(bytes, limits.turn_rate_max()),
    };
    let advised = Twist {
        speed: signed(bytes, 2_000).clamp(-10_000, 10_000),
        turn_rate: signed(bytes, 4_000).clamp(-20_000, 20_000),
    };
    let last = Twist {
        speed: signed(bytes, limits.speed_max())
            .clamp(-limits.reverse_speed_max(), limits.speed_max()),
        turn_rate: signed(bytes, limits.turn_rate_max())
            .clamp(-limits.turn_rate_max(), limits.turn_rate_max()),
    };
    let elapsed = size(bytes, 100).min(limits.reaction_time());
    let gaining = if bytes.truth() { 0 } else { elapsed };
    let ahead = bytes
        .truth()
        .then(|| (size(bytes, 3_000), size(bytes, 1_000)));
    let surroundings = Surroundings {
        hazard: &hazard,
        ring,
        motion,
        ahead,
    };
    let Admission { twist, limit } =
        guard.admissible(advised, last, [gaining, elapsed], &surroundings);
    let Twist { speed, turn_rate } = twist;
    assert!(promise::within_limits(
        speed,
        turn_rate,
        limits.speed_max(),
        limits.reverse_speed_max(),
        limits.turn_rate_max()
    ));
    assert!(promise::slew_kept(
        last.speed,
        speed,
        limits.acceleration(),
        gaining
    ));
    assert!(promise::slew_kept(
        last.turn_rate,
        turn_rate,
        limits.turn_acceleration(),
        elapsed
    ));
    assert!(promise::no_tighter(
        speed,
        turn_rate,
        advised.speed,
        advised.turn_rate
    ));
    assert!(promise::sees_where_it_goes(speed, ring.looks_back()));
    if let Some((distance, obstacle)) = ahead {
        assert!(promise::sound(
            distance,
            speed.saturating_add(obstacle),
            limits.stop_time(),
            speed <= 0
        ));
    }
    assert!(promise::slower_has_a_reason(
        speed,
        advised.speed,
        limit.is_some()
    ));
    if let Some(Limit::Clearance { sonar }) = limit {
        assert!(sonar < N);
    }
    for (hazard, sonar) in hazard.iter().zip(ring.sonars()) {
        let closing = &sonar.closing;
        let room = has_room(limits, hazard, closing, &motion, twist);
        assert!(promise::admitted(speed, turn_rate, room));
        if twist != Twist::REST {
            let (bound, left) = left_for_turn(limits, hazard, closing, &motion, twist);
            assert!(promise::turn_ends_before_contact(
                turn_rate,
                limits.turn_acceleration(),
                limits.reaction_time(),
                bound,
                left,
            ));
        }
        let worse = worse(hazard, bytes);
        if let Some(plan) = guard.plan(speed, turn_rate, &motion) {
            assert!(promise::worse_is_no_easier(
                limits.fits(hazard, closing, &plan),
                limits.fits(&worse, closing, &plan)
            ));
        }
    }
}
